// Plays a reader of the report, and leaves [check, null or what was there instead] for each check in <pre id="findings">.
"use strict";

(async () => {
  const findings = [];
  const check = (name, holds, instead = "") => findings.push([name, holds ? null : String(instead) || "not so"]);
  const byId = (id) => document.getElementById(id);
  const all = (selector) => [...document.querySelectorAll(selector)];
  const sleep = (ms) => new Promise((resolve) => setTimeout(resolve, ms));

  async function until(name, condition) {
    for (let tries = 0; tries < 100 && !condition(); tries++) await sleep(50);
    check(name, condition());
  }
  function choose(id, value) {
    byId(id).value = value;
    byId(id).dispatchEvent(new Event("change"));
  }
  const dots = () => all("#error-plot [role=button]");
  const rows = (id) => all(`#${id} tbody tr`);
  const canvas = () => document.querySelector("#viewer-stage canvas");
  const picture = () => canvas().toDataURL();
  const press = (key) => canvas().dispatchEvent(new KeyboardEvent("keydown", { key, bubbles: true, cancelable: true }));

  async function plots() {
    check("12 settings are dots", dots().length === 12, dots().length);
    check("a dot says what it is", /reference.*1 spp, 16 frames.*frame 4 ms.*FLIP 0\.42/s.test(dots()[0].getAttribute("aria-label")), dots()[0].getAttribute("aria-label"));
    check("each scene has a small plot", all("#small-plots svg").length === 2);
    byId("show-switches").click();
    check("switches are 5 more dots", dots().length === 17, dots().length);
    byId("show-switches").click();
    for (const metric of ["relmse", "psnr", "energy", "bias2", "variance", "temporal"]) {
      const before = byId("error-plot").innerHTML;
      choose("choose-metric", metric);
      check(`${metric} is another plot`, dots().length === 12 && byId("error-plot").innerHTML !== before, dots().length);
    }
    choose("choose-metric", "bias2");
    check("estimates below 0 are told", byId("metric-help").textContent.includes("Triangles") && byId("point-table").textContent.includes("−0.0"), byId("metric-help").textContent);
    choose("choose-metric", "temporal");
    check("the address knows the metric", location.hash.includes("metric=temporal"), location.hash);
    choose("choose-metric", "flip");
  }

  async function tables() {
    check("6 budgets and 5 multiples", rows("equal-time").length === 11, rows("equal-time").length);
    check("4 levels of FLIP", rows("equal-error").length === 4);
    check("two filters tie within 10 ms", /path-space.*atrous.*tie/s.test(rows("equal-time")[1].textContent), rows("equal-time")[1].textContent);
    const prices = byId("price-list").textContent;
    check("a step, a shortcut, a loss", ["light-tree: 0 → 1", "mis: 1 → 0", "effects: auto → all"].every((text) => prices.includes(text)), prices);
    check("no difference is said to be none", /ray-offset.*no measurable difference.*no measurable difference/s.test(prices), prices);
    check("the front's steps have prices", prices.includes("reference, 1 spp → atrous, 1 spp"), prices);
    check("hash tables are told of", byId("cost-table").textContent.includes("occupancy"), byId("cost-table").textContent);
    check("predictions are called that", byId("cost-table").textContent.includes("Example GPU 2070prediction, ms"), byId("cost-table").textContent);
    check("4 techniques at 1 spp have bars", all("#pass-bars rect").length >= 14, all("#pass-bars rect").length);
    check("17 measurements are listed with commands", rows("point-table").length === 17 && all("#point-table code").length === 17, rows("point-table").length);
    check("nothing is wrong here", !byId("warnings").textContent && !all("#point-table .bad").length, byId("warnings").textContent);
  }

  async function pictures() {
    await until("both pictures come", () => all("#profile-plot [aria-label=line] path").length === 2);
    const split = picture();
    byId("mode-a").click();
    const a = picture();
    press(" ");
    const b = picture();
    check("A, B and both are three pictures", new Set([split, a, b]).size === 3);
    press(" ");
    check("space flips back", picture() === a);
    press("+");
    check("zoom magnifies", picture() !== a);
    const zoomed = picture();
    press("ArrowLeft");
    check("arrows move", picture() !== zoomed);
    press("0");
    check("0 fits again", picture() === a);
    byId("mode-split").click();
    byId("split").value = 0.2;
    byId("split").dispatchEvent(new Event("input"));
    check("the slider moves the split", picture() !== split);
    byId("mode-heat-a").click();
    await until("the heat map comes", () => picture() !== a && all("#viewer-controls svg, #viewer-controls canvas").length > 0);
    byId("mode-split").click();
    await until("the profile comes back", () => all("#profile-plot [aria-label=line] path").length === 2);
    const profile = byId("profile-plot").innerHTML;
    choose("profile-direction", "column");
    check("a column has another profile", byId("profile-plot").innerHTML !== profile && byId("profile-at").max === "159", byId("profile-at").max);
    dots()[4].dispatchEvent(new KeyboardEvent("keydown", { key: "Enter" }));
    check("Enter on a dot shows its picture", byId("picture-a").selectedOptions[0].text.startsWith("unfiltered, 4 spp"), byId("picture-a").selectedOptions[0].text);
  }

  async function views() {
    choose("choose-scene", "hall, camera moves");
    check("the other scene is shown", dots().length === 12 && byId("lead").textContent.startsWith("hall, camera moves, 160×90"), byId("lead").textContent);
    check("faults are red", all("#point-table .bad").some((element) => element.textContent === "7 NaN"));
    check("a poor reference is told", /less than 10 times better than 1 of 17/.test(byId("warnings").textContent), byId("warnings").textContent);
    check("text stays text", !document.querySelector("main b") && byId("point-table").textContent.includes("<b>bold</b>"));
    await until("its pictures come", () => all("#profile-plot [aria-label=line] path").length === 2);
    choose("choose-run", "1");
    check("the other device is shown", byId("provenance-table").textContent.includes("deviceSoftware device"), byId("provenance-table").textContent);
    check("and the scene stays", byId("choose-scene").value === "hall, camera moves", byId("choose-scene").value);
    check("every select and slider has a name", all("select, input").every((field) => field.labels.length > 0));
  }

  try {
    await plots();
    await tables();
    await pictures();
    await views();
  } catch (error) {
    check("no exception", false, error.stack);
  }
  const result = document.createElement("pre");
  result.id = "findings";
  result.textContent = JSON.stringify(findings);
  document.body.append(result);
})();
