// What every part of the report uses: elements, numbers, intervals. Text from records only ever becomes text nodes.
"use strict";

report.make = function make(tag, attributes = {}, ...children) {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (name.startsWith("on")) element.addEventListener(name.slice(2), value);
    else if (value === true) element.setAttribute(name, "");
    else if (value !== false && value != null) element.setAttribute(name, value);
  }
  element.append(...children.flat(Infinity).filter((child) => child != null));
  return element;
};

report.fill = (id, ...children) => document.getElementById(id).replaceChildren(...children.flat(Infinity).filter((child) => child != null));

/** Columns: {title, help, number: right-aligned, of: row => node, text, or list of them}. */
report.table = function table(caption, columns, rows, rowAttributes = () => ({})) {
  const { make } = report;
  const numeric = (column) => (column.number ? { class: "number" } : {});
  const head = columns.map((column) => make("th", { scope: "col", title: column.help, ...numeric(column) }, column.title));
  const cell = (row) => (column, index) =>
    make(index ? "td" : "th", { ...(index ? {} : { scope: "row" }), ...numeric(column) }, column.of(row) ?? "–");
  const body = rows.map((row) => make("tr", rowAttributes(row), columns.map(cell(row))));
  return make("table", {}, caption && make("caption", {}, caption), make("thead", {}, make("tr", {}, head)), make("tbody", {}, body));
};

/** Three significant digits, without exponents where a person would write none. */
report.number = function number(value) {
  if (value == null || !Number.isFinite(value)) return "–";
  const size = Math.abs(value);
  if (size !== 0 && (size < 1e-4 || size >= 1e7)) return value.toExponential(2).replace("-", "−");
  const text = size >= 100 ? Math.round(value).toLocaleString("en") : String(Number(value.toPrecision(3)));
  return text.replace("-", "−");
};

report.signed = (value) => (value > 0 ? "+" : "") + report.number(value);

report.bytes = function bytes(value) {
  if (value == null) return "–";
  const step = Math.min(4, Math.floor(Math.log2(Math.max(value, 1)) / 10));
  return `${report.number(value / 1024 ** step)} ${["B", "KiB", "MiB", "GiB", "TiB"][step]}`;
};

/** "0.123" and its interval, small, where the two differ. */
report.interval = function interval(span, unit = "") {
  if (!span) return null;
  const { make, number } = report;
  const value = number(span.value) + (unit ? ` ${unit}` : "");
  return span.low === span.high ? [value] : [value, " ", make("span", { class: "range" }, `${number(span.low)}${span.low < 0 ? " to " : "–"}${number(span.high)}`)];
};

report.figureKind = (key) => report.data.figures.find((kind) => kind.key === key);
report.millisecondsOf = (point) => point.figures.frame_ms?.value;
report.tie = () => report.make("span", { class: "tie" }, "tie");

/** Names, colours: one per technique over the whole report. */
report.techniques = [...new Set(report.data.points.map((point) => point.point.technique))].sort();
report.techniqueColor = d3.scaleOrdinal(report.techniques, [...d3.schemeObservable10, ...d3.schemeTableau10]);
