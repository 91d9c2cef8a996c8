// Equal time and equal error: who wins each row, who tied, who came next. Decided by the program, shown here.
"use strict";

(() => {
  const { data, make, number } = report;

  const winners = (row) => {
    if (!row.best.length) return make("span", { class: "faint" }, "none");
    const names = row.best.map((index) => make("div", {}, data.points[index].label));
    if (row.best.length > 1) names.at(-1).append(" ", report.tie());
    return names;
  };
  const figures = (row, key, unit) => row.best.map((index) => make("div", {}, report.interval(data.points[index].figures[key], unit)));
  const runnerUp = (row, key, unit) =>
    row.next == null ? null : [make("div", {}, data.points[row.next].label), make("div", {}, report.interval(data.points[row.next].figures[key], unit))];

  function equalTime(view, metric) {
    const kind = report.figureKind(metric);
    const rows = view.tables[metric]?.equal_time ?? [];
    const columns = [
      { title: "within", of: (row) => (row.multiple ? `${row.multiple}× (${number(row.limit)} ms)` : `${number(row.limit)} ms`) },
      { title: "best", of: winners },
      { title: kind.name, of: (row) => figures(row, metric, kind.unit) },
      { title: "next", of: (row) => runnerUp(row, metric, kind.unit) },
    ];
    const multiples = rows.filter((row) => row.multiple);
    return [
      report.table(null, columns, rows.filter((row) => !row.multiple)),
      multiples.length ? report.table("Multiples of 1 spp path tracing", columns, multiples) : make("p", { class: "note" }, "Path tracing at 1 spp was not measured here."),
    ];
  }

  function equalError(view) {
    return report.table(null, [
      { title: "FLIP at most", of: (row) => String(row.limit) },
      { title: "fastest", of: winners },
      { title: "frame", of: (row) => figures(row, "frame_ms", "ms") },
      { title: "next", of: (row) => runnerUp(row, "frame_ms", "ms") },
    ], view.equal_error);
  }

  /** What a reader in a hurry wants to know. */
  function lead(view, metric) {
    const kind = report.figureKind(metric);
    const row = view.tables[metric]?.equal_time.find((candidate) => candidate.limit === 16.6);
    const said = (index) => [make("strong", {}, data.points[index].label), ` (${kind.name} `, report.interval(data.points[index].figures[metric], kind.unit), ")"];
    const best = row?.best.length
      ? ["Within 16.6 ms per frame ", row.best.flatMap((index, i) => [i ? " and " : "", said(index)]), row.best.length > 1 ? " tie for best." : " is best."]
      : ["Nothing that was measured keeps within 16.6 ms per frame."];
    const plain = data.points[view.path_tracing];
    const beside = plain?.figures[metric] && [" Path tracing at 1 spp takes ", report.interval(plain.figures.frame_ms, "ms"), `, with ${kind.name} `, report.interval(plain.figures[metric], kind.unit), "."];
    return [`${report.state.sceneName(view)}, ${report.state.sizeName(view)}: `, best, beside].flat(3);
  }

  report.state.onChange((view, metric) => {
    report.fill("lead", lead(view, metric));
    report.fill("equal-time", equalTime(view, metric));
    report.fill("equal-error", equalError(view));
  });
})();
