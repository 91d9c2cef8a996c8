// Two pictures at one place and magnification: split, flipped, or as heat maps of their error.
"use strict";

(() => {
  const { data, make, state } = report;
  const REFERENCE = "reference";
  const modes = { split: "Split", a: "A", b: "B", "heat-a": "Error of A", "heat-b": "Error of B" };
  const shown = { a: null, b: REFERENCE, mode: "split", split: 0.5 };
  /** Screen pixels per picture pixel, and the picture's point in the middle; no scale: fitted. */
  const place = { scale: null, x: 0, y: 0 };
  const loaded = { a: null, b: null };
  const canvas = make("canvas", { tabindex: "0", role: "img", "aria-label": "pictures A and B" });
  const tags = { a: make("span", { class: "tag a" }), b: make("span", { class: "tag b" }) };

  // Which picture

  const withPictures = () => state.pointsOf(state.view).filter((point) => point.pictures.picture != null);
  const labelOf = (side) => (shown[side] === REFERENCE ? "reference picture" : data.points[shown[side]]?.label ?? "no picture");

  function idOf(side, heat) {
    const point = shown[side] === REFERENCE ? withPictures()[0] : data.points[shown[side]];
    if (!point) return null;
    if (heat) return shown[side] === REFERENCE ? null : point.pictures.heatmap;
    return shown[side] === REFERENCE ? point.pictures.reference : point.pictures.picture;
  }

  async function reload() {
    const heat = shown.mode.startsWith("heat");
    const ids = { a: idOf("a", heat), b: idOf("b", heat) };
    const fetched = await Promise.all(["a", "b"].map((side) => (ids[side] == null ? null : report.pictures.load(ids[side]).catch(() => null))));
    // The choice may have moved on while pictures were loading.
    if (ids.a !== idOf("a", heat) || ids.b !== idOf("b", heat) || heat !== shown.mode.startsWith("heat")) return;
    [loaded.a, loaded.b] = fetched;
    draw();
    report.profile.update();
  }

  function show(side, index) {
    shown[side] = index;
    if (shown.mode === (side === "a" ? "b" : "a") || shown.mode.startsWith("heat")) shown.mode = side;
    refresh();
    document.getElementById("viewer").scrollIntoView({ block: "start" });
    canvas.focus({ preventScroll: true });
  }

  function pairButton(a, b) {
    const compare = () => {
      shown.b = b;
      shown.mode = "split";
      show("a", a);
    };
    const both = [a, b].every((index) => data.points[index].pictures.picture != null);
    return both ? make("button", { type: "button", class: "small", onclick: compare, "aria-label": `compare ${data.points[a].label} with ${data.points[b].label}` }, "compare") : null;
  }

  // Drawing

  const size = () => state.view.size;
  const fitted = () => Math.min(canvas.clientWidth / size()[0], canvas.clientHeight / size()[1]);
  const scale = () => place.scale ?? fitted();

  function draw() {
    const context = canvas.getContext("2d");
    const ratio = window.devicePixelRatio || 1;
    const [width, height] = [canvas.clientWidth, canvas.clientHeight];
    Object.assign(canvas, { width: width * ratio, height: height * ratio });
    context.scale(ratio, ratio);
    const edge = { split: shown.split * width, a: width, "heat-a": width }[shown.mode] ?? 0;
    drawSide(context, loaded.a, 0, edge);
    drawSide(context, loaded.b, edge, width);
    drawLine(context);
    if (shown.mode === "split") {
      context.fillStyle = "#fff";
      context.fillRect(edge - 0.5, 0, 1, height);
    }
    showTags();
  }

  function drawSide(context, image, left, right) {
    if (!image || right <= left) return;
    const s = scale();
    context.save();
    context.beginPath();
    context.rect(left, 0, right - left, canvas.clientHeight);
    context.clip();
    context.imageSmoothingEnabled = s < 1;
    context.drawImage(image, canvas.clientWidth / 2 - place.x * s, canvas.clientHeight / 2 - place.y * s, size()[0] * s, size()[1] * s);
    context.restore();
  }

  /** Where the profile is taken. */
  function drawLine(context) {
    const { direction, at } = report.profile.line();
    const s = scale();
    context.fillStyle = "#fffb";
    if (direction === "row") context.fillRect(0, canvas.clientHeight / 2 + (at + 0.5 - place.y) * s, canvas.clientWidth, 1);
    else context.fillRect(canvas.clientWidth / 2 + (at + 0.5 - place.x) * s, 0, 1, canvas.clientHeight);
  }

  function showTags() {
    for (const side of ["a", "b"]) {
      const heat = shown.mode.startsWith("heat");
      tags[side].hidden = shown.mode !== "split" && !shown.mode.endsWith(side);
      tags[side].textContent = `${side.toUpperCase()}: ${labelOf(side)}${heat ? ", FLIP" : ""}${loaded[side] ? "" : " (no picture)"}`;
    }
  }

  // Moving

  function fit() {
    Object.assign(place, { scale: null, x: size()[0] / 2, y: size()[1] / 2 });
    draw();
  }

  /** Keeps the picture's point under (x, y) of the canvas where it is. */
  function zoom(factor, x = canvas.clientWidth / 2, y = canvas.clientHeight / 2) {
    const [old, now] = [scale(), Math.min(64, Math.max(fitted() / 4, scale() * factor))];
    place.x += (x - canvas.clientWidth / 2) * (1 / old - 1 / now);
    place.y += (y - canvas.clientHeight / 2) * (1 / old - 1 / now);
    place.scale = now;
    draw();
  }

  function pan(dx, dy) {
    place.x -= dx / scale();
    place.y -= dy / scale();
    draw();
  }

  function setMode(mode) {
    const wasHeat = shown.mode.startsWith("heat");
    shown.mode = mode;
    showControls();
    if (wasHeat !== mode.startsWith("heat")) reload();
    else draw();
  }

  const other = { split: "a", a: "b", b: "a", "heat-a": "heat-b", "heat-b": "heat-a" };
  const keys = {
    " ": () => setMode(other[shown.mode]), "+": () => zoom(1.5), "=": () => zoom(1.5), "-": () => zoom(1 / 1.5), 0: fit, f: fit,
    ArrowLeft: () => pan(40, 0), ArrowRight: () => pan(-40, 0), ArrowUp: () => pan(0, 40), ArrowDown: () => pan(0, -40),
  };

  canvas.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey || !keys[event.key]) return;
    event.preventDefault();
    keys[event.key]();
  });
  canvas.addEventListener("wheel", (event) => {
    event.preventDefault();
    zoom(2 ** (-event.deltaY / 300), event.offsetX, event.offsetY);
  }, { passive: false });
  canvas.addEventListener("pointerdown", (event) => canvas.setPointerCapture(event.pointerId));
  canvas.addEventListener("pointermove", (event) => event.buttons && canvas.hasPointerCapture(event.pointerId) && pan(event.movementX, event.movementY));
  new ResizeObserver(() => state.view && draw()).observe(canvas);

  // Controls

  function pictureSelect(side) {
    const listed = [...withPictures().map((point) => [point.index, point.label]), [REFERENCE, "reference picture"]];
    const onchange = (event) => {
      shown[side] = event.target.value === REFERENCE ? REFERENCE : Number(event.target.value);
      refresh();
      document.getElementById(`picture-${side}`).focus();
    };
    const options = listed.map(([value, text]) => make("option", { value, selected: value === shown[side] }, text));
    return make("label", {}, side.toUpperCase(), make("select", { id: `picture-${side}`, onchange }, options));
  }

  function showControls() {
    const focused = document.activeElement?.id;
    const button = (id, text, onclick, pressed) => make("button", { id, type: "button", onclick, "aria-pressed": pressed == null ? null : String(pressed) }, text);
    const modeButton = ([mode, name]) => button(`mode-${mode}`, name, () => setMode(mode), shown.mode === mode);
    const move = (event) => {
      shown.split = Number(event.target.value);
      draw();
    };
    report.fill("viewer-controls",
      pictureSelect("a"), pictureSelect("b"),
      make("span", { class: "group", role: "group", "aria-label": "what is shown" }, Object.entries(modes).map(modeButton)),
      make("label", {}, "Split", make("input", { id: "split", type: "range", min: 0, max: 1, step: 0.01, value: shown.split, disabled: shown.mode !== "split", oninput: move })),
      make("span", { class: "group", role: "group", "aria-label": "magnification" },
        button("zoom-out", "−", () => zoom(1 / 1.5)), button("zoom-in", "+", () => zoom(1.5)), button("fit", "Fit", fit)),
      shown.mode.startsWith("heat") ? Plot.legend({ color: { type: "linear", scheme: "magma", domain: [0, 1], label: "FLIP" }, width: 160 }) : null);
    if (focused) document.getElementById(focused)?.focus();
  }

  function refresh() {
    showControls();
    reload();
  }

  state.onChange((view) => {
    const listed = withPictures().map((point) => point.index);
    const settle = (side, otherwise) => (shown[side] === REFERENCE || listed.includes(shown[side]) ? shown[side] : otherwise);
    Object.assign(shown, { a: settle("a", listed[0] ?? null), b: settle("b", REFERENCE) });
    report.profile.resize(view.size);
    report.fill("viewer-stage", canvas, tags.a, tags.b);
    Object.assign(loaded, { a: null, b: null });
    refresh();
    fit();
  });

  report.viewer = { show, pairButton, redraw: draw, loaded, labelOf, mode: () => shown.mode };
})();
