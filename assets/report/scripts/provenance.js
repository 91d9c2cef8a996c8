// Machine, device, driver, commit, seeds, references: what a reader needs to measure the same again.
"use strict";

(() => {
  const { data, make, number, state } = report;

  const row = ([name, value]) => [make("dt", {}, name), make("dd", {}, value)];
  const list = (values) => [...new Set(values)].join(", ");

  function draw(view) {
    const points = state.pointsOf(view);
    const { provenance } = data.runs[view.run];
    const times = d3.sort(points, (point) => point.time).map((point) => point.time);
    const spp = d3.extent(points, (point) => point.reference.samples_per_pixel);
    const errors = d3.extent(points, (point) => point.reference.standard_error);
    const between = ([low, high], text = number) => (low === high ? text(low) : `${text(low)} to ${text(high)}`);
    report.fill("provenance-table", make("dl", {}, [
      ["device", provenance.device], ["driver", provenance.driver],
      ["machine", `${provenance.machine}: ${provenance.cpu}, ${provenance.cores} cores, ${provenance.os}`],
      ["program", `pathspace ${provenance.program}, commit ${provenance.commit}`],
      ["suites", list(points.map((point) => point.suite))],
      ["scene", `${view.scene}${view.source === view.scene ? "" : `, ${view.source}`}, ${view.moves} moves`],
      ["acceleration structure", list(points.map((point) => point.point.trace))],
      ["frames per setting, the last measured", list(points.map((point) => point.point.frames))],
      ["seeds per setting", between(d3.extent(points, (point) => point.seeds))],
      ["reference", `${between(spp)} samples per pixel, relative standard error ${between(errors)}`],
      ["measured", between([times[0], times.at(-1)], String)],
      ["report by", `pathspace ${data.program}`],
    ].map(row)));
  }

  state.onChange(draw);
})();
