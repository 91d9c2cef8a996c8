// What is chosen: run, scene, size, metric. Kept in the address, so that a view can be bookmarked and sent.
"use strict";

(() => {
  const { data, make } = report;
  const listeners = [];
  const metricGroups = { error: "Error", split: "Bias and variance", temporal: "Temporal" };
  const moved = { nothing: "", camera: ", camera moves", light: ", light moves", object: ", object moves" };

  const runName = ({ provenance }) => `${provenance.device}, ${provenance.machine}, ${provenance.commit.slice(0, 10)}`;
  const runNames = data.runs.map((run, index) => {
    const twins = data.runs.filter((other) => runName(other) === runName(run)).length > 1;
    return twins ? `${runName(run)}, ${run.provenance.driver}` : runName(run) || String(index);
  });
  const sourcesOf = (scene) => new Set(data.views.filter((view) => view.scene === scene).map((view) => view.source));
  const sceneName = (view) => view.scene + (sourcesOf(view.scene).size > 1 ? ` (${view.source})` : "") + moved[view.moves];
  const sizeName = (view) => view.size.join("×");

  const chosen = { run: 0, scene: null, size: null, metric: "flip" };
  const has = (view, wanted) => Object.entries(wanted).every(([key, value]) => properties[key](view) === value);
  const properties = { run: (view) => view.run, scene: sceneName, size: sizeName };

  /** The view that keeps most of what was chosen, the last choice before all. */
  function settle(first) {
    const order = [...new Set([first, "run", "scene", "size"])].filter((key) => key in properties && chosen[key] != null);
    for (let kept = order.length; kept >= 0; kept--) {
      const wanted = Object.fromEntries(order.slice(0, kept).map((key) => [key, chosen[key]]));
      const view = data.views.find((candidate) => has(candidate, wanted));
      if (view) return adopt(view);
    }
    return undefined;
  }

  function adopt(view) {
    for (const key in properties) chosen[key] = properties[key](view);
    if (!report.figureKind(chosen.metric) || !data.views.some((other) => other.tables[chosen.metric])) chosen.metric = "flip";
    return view;
  }

  function choose(changes) {
    Object.assign(chosen, changes);
    const view = settle(Object.keys(changes)[0]);
    const { run, ...rest } = chosen;
    history.replaceState(null, "", `#${new URLSearchParams({ ...rest, run })}`);
    report.state.view = view;
    showSelection();
    listeners.forEach((listener) => listener(view, chosen.metric));
  }

  function select(key, title, options) {
    const listed = options.map(([value, text]) => make("option", { value, selected: String(value) === String(chosen[key]) }, text));
    const onchange = (event) => {
      choose({ [key]: key === "run" ? Number(event.target.value) : event.target.value });
      document.getElementById(`choose-${key}`).focus();
    };
    return make("label", {}, title, make("select", { id: `choose-${key}`, onchange }, listed));
  }

  function metricSelect() {
    const field = select("metric", "Metric", []);
    for (const [group, title] of Object.entries(metricGroups)) {
      const kinds = data.figures.filter((kind) => kind.group === group && data.views.some((view) => view.tables[kind.key]));
      const option = (kind) => make("option", { value: kind.key, selected: kind.key === chosen.metric }, kind.name);
      if (kinds.length) field.lastChild.append(make("optgroup", { label: title }, kinds.map(option)));
    }
    return field;
  }

  function showSelection() {
    const distinct = (key, views) => [...new Set(views.map(properties[key]))].map((value) => [value, value]);
    const ofRun = data.views.filter((view) => view.run === chosen.run);
    const ofScene = ofRun.filter((view) => sceneName(view) === chosen.scene);
    report.fill("selection",
      select("scene", "Scene", distinct("scene", ofRun)),
      select("size", "Size", distinct("size", ofScene)),
      metricSelect(),
      select("run", "Device, machine, commit", runNames.map((name, index) => [index, name])));
  }

  function fromAddress() {
    const wanted = Object.fromEntries(new URLSearchParams(location.hash.slice(1)));
    return Object.fromEntries(Object.entries({ ...wanted, run: Number(wanted.run ?? 0) }).filter(([key]) => key in chosen));
  }

  report.state = {
    choose, chosen, sceneName, sizeName,
    onChange: (listener) => listeners.push(listener),
    start: () => choose({ scene: null, ...fromAddress() }),
    /** Views of the chosen run and size, one per scene. */
    siblings: () => data.views.filter((view) => view.run === chosen.run && sizeName(view) === chosen.size),
    pointsOf: (view) => view.points.map((index) => ({ index, ...data.points[index] })),
  };
})();
