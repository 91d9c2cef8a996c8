// Every measurement of the view, its faults, its reference, and the command that renders it again; and what is wrong, on top.
"use strict";

(() => {
  const { make, number, state } = report;
  const GOOD_RATIO = 10;
  const faultKinds = report.data.figures.filter((kind) => kind.group === "fault" && kind.unit === "pixels");

  const faultsOf = (point) => faultKinds.filter((kind) => point.figures[kind.key]?.value > 0);
  const hasPoorReference = (point) => point.reference.ratio < GOOD_RATIO;

  function faults(point) {
    const found = faultsOf(point);
    return found.length ? make("span", { class: "bad" }, found.map((kind) => `${number(point.figures[kind.key].value)} ${kind.name}`).join(", ")) : "none";
  }

  const reference = ({ reference: { ratio, samples_per_pixel: spp } }) =>
    make("span", { class: ratio < GOOD_RATIO ? "bad" : "", title: `${number(spp)} samples per pixel` }, `${number(ratio)}×`);

  async function copy(text, button) {
    try {
      await navigator.clipboard.writeText(text);
    } catch {
      // Pages from disk may not be trusted with the clipboard: the older way.
      const field = make("textarea", {}, text);
      document.body.append(field);
      field.select();
      document.execCommand("copy");
      field.remove();
    }
    button.textContent = "copied";
    setTimeout(() => (button.textContent = "copy"), 1500);
  }

  function command(point) {
    const button = make("button", { type: "button", class: "small", onclick: () => copy(point.command, button), "aria-label": `copy the command of ${point.label}` }, "copy");
    return [button, " ", make("code", {}, point.command)];
  }

  function pictures(point) {
    const button = (side) =>
      make("button", { type: "button", class: "small", onclick: () => report.viewer.show(side, point.index), "aria-label": `show ${point.label} as ${side.toUpperCase()}` }, side.toUpperCase());
    return point.pictures.picture == null ? null : make("span", { class: "group" }, button("a"), button("b"));
  }

  function table(view, metric) {
    const kind = report.figureKind(metric);
    const front = new Set(view.tables[metric]?.front);
    const points = d3.sort(state.pointsOf(view), (point) => report.millisecondsOf(point) ?? Infinity);
    return report.table(null, [
      { title: "setting", of: (point) => (front.has(point.index) ? "● " : "") + point.label },
      { title: "frame, ms", number: true, of: (point) => report.interval(point.figures.frame_ms) },
      { title: kind.name + (kind.unit && `, ${kind.unit}`), number: true, of: (point) => report.interval(point.figures[metric]) },
      { title: "faults", help: "pixels that hold NaN, infinite or negative values", of: faults },
      { title: "reference", help: report.figureKind("reference_ratio").help, number: true, of: reference },
      { title: "show as", of: pictures },
      { title: "command", of: command },
    ], points);
  }

  function warnings(view) {
    const points = state.pointsOf(view);
    const faulty = points.filter((point) => faultsOf(point).length);
    const poor = points.filter(hasPoorReference);
    const name = (list) => list.map((point) => point.label).slice(0, 3).join("; ") + (list.length > 3 ? "; …" : "");
    return [
      faulty.length ? make("p", {}, `${faulty.length} of ${points.length} settings put out faulty pixels (NaN, infinite or negative): ${name(faulty)}.`) : null,
      poor.length ? make("p", {}, `The reference is less than ${GOOD_RATIO} times better than ${poor.length} of ${points.length} settings, whose errors are therefore uncertain: ${name(poor)}.`) : null,
    ];
  }

  state.onChange((view, metric) => {
    report.fill("point-table", table(view, metric));
    report.fill("warnings", warnings(view));
  });
})();
