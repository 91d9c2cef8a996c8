// The price list: switches, then neighbours on the front. Decided and sorted by the program, shown here.
"use strict";

(() => {
  const { data, make } = report;
  const none = () => make("span", { class: "faint" }, "no measurable difference");
  const kinds = {
    gain: ["Gains", "better in one, not worse in the other"],
    step: ["Accuracy steps", "less error for more time, most gained per ms first"],
    shortcut: ["Shortcuts", "less time for more error, least lost per ms first"],
    loss: ["Losses", "worse in one, not better in the other"],
    "no-difference": ["No measurable difference", "neither in time nor in error"],
  };

  function difference(span, unit, isBetter) {
    if (!span) return none();
    const range = make("span", { class: "range" }, `${report.signed(span.low)} to ${report.signed(span.high)}`);
    return [make("span", { class: isBetter ? "better" : "" }, `${report.signed(span.value)} ${unit}`), " ", range];
  }

  function change(price) {
    const [base, changed] = [data.points[price.base], data.points[price.changed]];
    const set = changed.point.switch;
    if (set) return [make("div", {}, `${set.key}: ${set.base_value} → ${set.value}`), make("div", { class: "faint" }, base.label)];
    const same = base.point.technique === changed.point.technique && base.point.spp !== changed.point.spp;
    return [
      make("div", {}, same ? `${base.point.technique}, ${base.point.spp} → ${changed.point.spp} spp` : `${base.label} → ${changed.label}`),
    ];
  }

  function list(caption, prices, kind) {
    // "One" metrics differ by their distance from 1.
    const unit = kind.better === "one" ? `|${kind.name} − 1|` : kind.unit || kind.name;
    const improves = (span) => span && (kind.better === "more" ? span.value > 0 : span.value < 0);
    return report.table(caption, [
      { title: "change", of: change },
      { title: "time", number: true, of: ({ ms }) => difference(ms, "ms", ms?.value < 0) },
      { title: "error", number: true, of: ({ error }) => difference(error, unit, improves(error)) },
      { title: `${unit} per ms`, number: true, of: ({ per_ms }) => (per_ms == null ? null : report.number(per_ms)) },
      { title: "pictures", of: ({ base, changed }) => report.viewer.pairButton(base, changed) },
    ], prices);
  }

  function draw(view, metric) {
    const kind = report.figureKind(metric);
    const { switches = [], steps = [] } = view.tables[metric] ?? {};
    const groups = Object.entries(kinds).map(([key, [title, meaning]]) => {
      const prices = switches.filter((price) => price.kind === key);
      return prices.length ? list([`${title} `, make("span", { class: "faint" }, meaning)], prices, kind) : null;
    });
    const along = steps.length ? list(["Along the front ", make("span", { class: "faint" }, "from each setting to the next better one")], steps, kind) : null;
    const empty = switches.length ? null : make("p", { class: "faint" }, "No switches were measured here.");
    report.fill("price-list", empty, groups, along);
  }

  report.state.onChange(draw);
})();
