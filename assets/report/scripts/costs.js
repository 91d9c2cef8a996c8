// Where the time goes: bars of ms per pass, and what else a frame costs.
"use strict";

(() => {
  const { data, make, number, bytes, state } = report;
  const PREDICTION = "predicted_ms:";
  const all = "all";

  /** Points of techniques, at the chosen samples per pixel. */
  function chosenPoints(view) {
    const spp = document.getElementById("cost-spp").value;
    const points = state.pointsOf(view).filter(({ point }) => !point.switch && (spp === all || String(point.spp) === spp));
    return d3.sort(points, (point) => report.millisecondsOf(point) ?? Infinity);
  }

  function showSpp(view) {
    const field = document.getElementById("cost-spp");
    const counts = d3.sort(new Set(state.pointsOf(view).map(({ point }) => point.spp)));
    const kept = counts.map(String).includes(field.value) || field.value === all ? field.value : String(counts[0]);
    field.replaceChildren(...[...counts, all].map((spp) => make("option", { value: spp, selected: String(spp) === kept }, spp)));
  }

  function bars(points) {
    const passes = points.flatMap((point) => point.passes.map((pass, order) => ({ ...pass, order, label: point.label })));
    if (!passes.length) return make("p", { class: "faint" }, "No passes were measured here.");
    const names = [...new Set(passes.map((pass) => pass.name))];
    const title = (pass) => [
      pass.name, pass.label, `median ${number(pass.median_ms)} ms, 95 % below ${number(pass.p95_ms)} ms, spread ${number(pass.spread_ms)} ms`,
      `reads ${bytes(pass.bytes_read)}, writes ${bytes(pass.bytes_written)}`,
    ].join("\n");
    const margin = Math.min(420, 20 + 7 * d3.max(points, (point) => point.label.length));
    return Plot.plot({
      width: 1140, height: 80 + 30 * points.length, marginLeft: margin, marginRight: 30, marginBottom: 40, ariaLabel: "Milliseconds per pass",
      x: { label: "ms per frame →", grid: true }, y: { label: null, domain: points.map((point) => point.label), padding: 0.25 },
      color: { domain: names, range: [...d3.schemeTableau10, ...d3.schemeSet2, ...d3.schemeSet3], legend: true },
      marks: [
        Plot.barX(passes, { x: "median_ms", y: "label", fill: "name", order: "order", title, tip: true, inset: 0.25, ariaLabel: title }),
        Plot.ruleX([0]),
      ],
    });
  }

  function table(points) {
    const figure = (key, show = report.interval) => (point) => (point.figures[key] ? show(point.figures[key]) : null);
    const count = ({ value }) => bytes(value);
    const column = (key, show) => {
      const kind = report.figureKind(key);
      return { title: kind.name + (kind.unit && kind.unit !== "B" ? `, ${kind.unit}` : ""), help: kind.help, number: true, of: figure(key, show) };
    };
    const predicted = [...new Set(points.flatMap((point) => Object.keys(point.figures).filter((key) => key.startsWith(PREDICTION))))].sort();
    const prediction = (key) => ({
      title: make("span", {}, key.slice(PREDICTION.length), make("br"), "prediction, ms"), help: "predicted, not measured", number: true, of: figure(key),
    });
    const ofTables = data.figures.filter((kind) => kind.group === "table");
    const columns = [
      column("frame_ms"), column("frame_ms_p95", ({ value }) => number(value)), column("cpu_ms", ({ value }) => number(value)),
      column("first_frame_ms", ({ value }) => number(value)), column("rays_per_pixel", ({ value }) => number(value)),
      column("bytes_read", count), column("bytes_written", count), column("bandwidth", ({ value }) => number(value)), column("memory_bytes", count),
      ...ofTables.map((kind) => column(kind.key)),
      ...predicted.map(prediction),
    ];
    const measured = columns.filter((column) => points.some((point) => column.of(point) != null));
    return report.table(null, [{ title: "setting", of: (point) => point.label }, ...measured], points);
  }

  function draw(view) {
    const points = chosenPoints(view);
    report.fill("pass-bars", bars(points));
    report.fill("cost-table", table(points));
  }

  state.onChange((view) => {
    showSpp(view);
    draw(view);
  });
  document.getElementById("cost-spp").addEventListener("change", () => draw(state.view));
})();
