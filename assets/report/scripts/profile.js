// Luminance of both pictures along one row or column, as the screen shows it.
"use strict";

(() => {
  const { make } = report;
  const line = { direction: "row", at: 0 };
  let size = [1, 1];

  const decode = (byte) => (byte <= 10.31475 ? byte / 255 / 12.92 : ((byte / 255 + 0.055) / 1.055) ** 2.4);
  const last = () => size[line.direction === "row" ? 1 : 0] - 1;

  /** Rec. 709 luminance of the sRGB picture, linear, 1 for white. */
  function luminance(image) {
    const [width, height] = line.direction === "row" ? [image.naturalWidth, 1] : [1, image.naturalHeight];
    const context = Object.assign(document.createElement("canvas"), { width, height }).getContext("2d");
    context.drawImage(image, line.direction === "row" ? 0 : -line.at, line.direction === "row" ? -line.at : 0);
    const bytes = context.getImageData(0, 0, width, height).data;
    return d3.range(width * height).map((i) => 0.2126 * decode(bytes[4 * i]) + 0.7152 * decode(bytes[4 * i + 1]) + 0.0722 * decode(bytes[4 * i + 2]));
  }

  function plot() {
    const { loaded, labelOf } = report.viewer;
    const colors = { a: d3.schemeObservable10[0], b: d3.schemeObservable10[1] };
    const sides = ["a", "b"].filter((side) => loaded[side]);
    const names = Object.fromEntries(sides.map((side) => [side, `${side.toUpperCase()}: ${labelOf(side)}`]));
    const samples = sides.flatMap((side) => luminance(loaded[side]).map((value, pixel) => ({ pixel, value, side: names[side] })));
    return samples.length
      ? Plot.plot({
          width: 1140, height: 200, marginLeft: 60, grid: true, ariaLabel: `luminance along ${line.direction} ${line.at}`,
          x: { label: `pixel of ${line.direction} ${line.at} →` }, y: { label: "↑ luminance" },
          color: { domain: sides.map((side) => names[side]), range: sides.map((side) => colors[side]), legend: true },
          marks: [Plot.lineY(samples, { x: "pixel", y: "value", stroke: "side", strokeWidth: 1.25 })],
        })
      : make("p", { class: "faint" }, "No picture to take a profile of.");
  }

  function controls() {
    const turn = (event) => {
      line.direction = event.target.value;
      line.at = Math.floor(last() / 2);
      changed("profile-direction");
    };
    const move = (event) => {
      line.at = Number(event.target.value);
      changed("profile-at");
    };
    const option = (value) => make("option", { value, selected: value === line.direction }, value);
    return make("div", { class: "controls" },
      make("label", {}, "Luminance along a", make("select", { id: "profile-direction", onchange: turn }, option("row"), option("column"))),
      make("label", {}, `${line.direction} ${line.at} of ${last() + 1}`,
        make("input", { id: "profile-at", type: "range", min: 0, max: last(), step: 1, value: line.at, oninput: move })));
  }

  /** A slider that is being dragged must stay the same element. */
  function changed(focused) {
    const field = document.getElementById(focused);
    if (focused === "profile-at") {
      field.parentNode.firstChild.textContent = `${line.direction} ${line.at} of ${last() + 1}`;
      document.getElementById("profile-plot").replaceChildren(plot());
    } else {
      update();
      document.getElementById(focused).focus();
    }
    report.viewer.redraw();
  }

  /** Heat maps have no luminance worth a profile. */
  function update() {
    const heat = report.viewer.mode().startsWith("heat");
    report.fill("profile", ...(heat ? [] : [controls(), make("div", { id: "profile-plot" }, plot())]));
  }

  function resize(next) {
    size = next;
    line.at = Math.floor(last() / 2);
  }

  report.profile = { line: () => line, update, resize };
})();
