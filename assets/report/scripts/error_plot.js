// Error against time, both logarithmic where the metric allows it, with the Pareto front.
"use strict";

(() => {
  const { data, make, number, state } = report;

  /** Values up to 1 that count from above, decibels and ratios are read linearly. */
  const isLogarithmic = (kind) => kind.better === "less";

  const toDot = (metric) => (point) => ({
    ...point, technique: point.point.technique, isSwitch: point.point.switch != null, ms: point.figures.frame_ms, error: point.figures[metric],
  });

  /** What a logarithmic axis cannot show (an estimate of 0 or less) lies on its lower edge. */
  function edgeOf(dots) {
    const positive = dots.flatMap(({ error }) => [error.value, error.low]).filter((value) => value > 0);
    const values = dots.map(({ error }) => error.value).filter((value) => value > 0);
    return Math.max(d3.min(positive) ?? 1e-6, (d3.min(values) ?? 1e-6) / 10);
  }

  function describe(dot, kind) {
    const { point } = dot;
    const settings = Object.entries(point.settings).map(([key, value]) => `${key}=${value}`).join(", ");
    const span = (name, { value, low, high }, unit) => `${name} ${number(value)}${unit && ` ${unit}`} (${number(low)} to ${number(high)})`;
    return [
      dot.isSwitch ? `${point.technique}: ${point.switch.key} ${point.switch.base_value} → ${point.switch.value}` : point.technique,
      `${point.spp} spp, ${point.frames} frame${point.frames > 1 ? "s" : ""}, ${point.trace}`,
      settings || "default settings", ...(point.all_effects ? ["all effects"] : []),
      span("frame", dot.ms, "ms"), span(kind.name, dot.error, kind.unit),
    ].join("\n");
  }

  function dotsOf(view, metric, withSwitches) {
    const dots = state.pointsOf(view).map(toDot(metric)).filter((dot) => dot.ms && dot.error);
    return dots.filter((dot) => withSwitches || !dot.isSwitch);
  }

  function frontOf(view, metric) {
    return (view.tables[metric]?.front ?? []).map((index) => toDot(metric)({ index, ...data.points[index] }));
  }

  function marks(view, metric, dots, small) {
    const kind = report.figureKind(metric);
    const edge = isLogarithmic(kind) ? edgeOf(dots) : -Infinity;
    const y = (pick) => (dot) => Math.max(edge, dot.error[pick]);
    const [x, color] = [(dot) => dot.ms.value, (dot) => report.techniqueColor(dot.technique)];
    const bars = { stroke: color, strokeOpacity: 0.45 };
    const dot = { x, y: y("value"), r: small ? 2.5 : 4.5, stroke: color, symbol: (d) => (d.error.value > edge || edge === -Infinity ? "circle" : "triangle") };
    return [
      Plot.line(frontOf(view, metric), { x, y: y("value"), curve: "step-after", stroke: "currentColor", strokeWidth: 1.25, strokeOpacity: 0.6 }),
      ...(small ? [] : [
        Plot.ruleX(dots, { x, y1: y("low"), y2: y("high"), ...bars }),
        Plot.ruleY(dots, { y: y("value"), x1: (d) => d.ms.low, x2: (d) => d.ms.high, ...bars }),
      ]),
      Plot.dot(dots, { ...dot, className: "dots", fill: (d) => (d.isSwitch ? "none" : report.techniqueColor(d.technique)), ariaLabel: (d) => describe(d, kind) }),
      ...(small ? [] : [Plot.tip(dots, Plot.pointer({ x, y: y("value"), title: (d) => describe(d, kind) }))]),
    ];
  }

  function scales(kind, small) {
    const unit = kind.unit ? ` (${kind.unit})` : "";
    const arrow = { less: "↓ less is better", more: "↑ more is better", one: "1 is best" }[kind.better];
    return {
      x: { type: "log", label: "ms per frame →", tickFormat: "~g", inset: small ? 6 : 14 },
      y: { type: isLogarithmic(kind) ? "log" : "linear", label: `${kind.name}${unit}, ${arrow}`, tickFormat: "~g", inset: small ? 6 : 14 },
      symbol: { type: "identity" },
      color: { type: "identity" },
    };
  }

  /** Dots take part in the order of the keyboard, and open their picture. */
  function makeDotsButtons(svg, dots) {
    const ordered = [...svg.querySelectorAll(".dots path, .dots circle")];
    ordered.forEach((element) => {
      const dot = dots[element.__data__];
      if (!dot) return;
      element.setAttribute("tabindex", "0");
      element.setAttribute("role", "button");
      const open = (event) => report.viewer.show(event.shiftKey ? "b" : "a", dot.index);
      element.addEventListener("click", open);
      element.addEventListener("keydown", (event) => event.key === "Enter" && open(event));
    });
  }

  function legend(dots) {
    const used = report.techniques.filter((technique) => dots.some((dot) => dot.technique === technique));
    return Plot.legend({ color: { domain: used, range: used.map(report.techniqueColor) } });
  }

  function draw(view, metric) {
    const kind = report.figureKind(metric);
    const dots = dotsOf(view, metric, document.getElementById("show-switches").checked);
    const unseen = isLogarithmic(kind) && dots.some((dot) => dot.error.value <= 0);
    document.getElementById("metric-help").textContent = `${kind.name}: ${kind.help}.${unseen ? " Triangles: estimated at 0 or less, which the axis cannot show." : ""}`;
    if (!dots.length) return report.fill("error-plot", make("p", { class: "faint" }, `${kind.name} was not measured here.`));
    const svg = Plot.plot({
      width: 1140, height: 480, marginLeft: 60, marginRight: 30, marginBottom: 40, grid: true, ...scales(kind, false), marks: marks(view, metric, dots, false),
      ariaLabel: `${kind.name} against milliseconds per frame, ${state.sceneName(view)}`,
    });
    makeDotsButtons(svg, dots);
    report.fill("error-plot", legend(dots), svg);
  }

  function smallPlot(view, metric) {
    const kind = report.figureKind(metric);
    const dots = dotsOf(view, metric, false);
    const name = state.sceneName(view);
    const shared = scales(kind, true);
    const svg = dots.length && Plot.plot({
      width: 250, height: 170, marginLeft: 45, ...shared, x: { ...shared.x, label: null, ticks: 3 }, y: { ...shared.y, label: null, ticks: 4 },
      marks: marks(view, metric, dots, true), ariaLabel: `${kind.name} against milliseconds, ${name}`,
    });
    const button = make("button", { type: "button", "aria-pressed": String(name === state.chosen.scene), onclick: () => state.choose({ scene: name }) }, name);
    return make("div", { class: "small-plot" }, button, svg || make("p", { class: "faint" }, "not measured"));
  }

  function drawAll(view, metric) {
    draw(view, metric);
    const siblings = state.siblings();
    document.getElementById("overview").hidden = siblings.length < 2;
    report.fill("small-plots", siblings.map((sibling) => smallPlot(sibling, metric)));
  }

  state.onChange(drawAll);
  document.getElementById("show-switches").addEventListener("change", () => draw(state.view, state.chosen.metric));
})();
