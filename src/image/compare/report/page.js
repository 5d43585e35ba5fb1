
// The page around the stage.

const $ = (id) => document.getElementById(id);
const viewer = new Viewer($("stage"), $("readout"));
const cases = report.run.cases;
const decoded = new Map();
let current = -1;

function element(tag, text = "", className = "") {
  const made = document.createElement(tag);
  made.textContent = text;
  if (className) made.className = className;
  return made;
}

// The layers of a case with their pixels.
async function layersOf(index) {
  if (!decoded.has(index)) {
    decoded.set(index, Promise.all(report.pictures[index].map(async (layer) => ({
      ...layer,
      actual: layer.actual && await decode(layer.actual),
      expected: layer.expected && await decode(layer.expected),
      maps: await Promise.all(layer.maps.map(decode)),
    }))));
  }
  return decoded.get(index);
}

function headline(entry) {
  const metrics = entry.comparison?.layers[0]?.metrics;
  if (!metrics) return entry.status;
  if (metrics.mse === null) return "not finite";
  if (metrics.different === 0) return "identical";
  const name = "flip.mean" in metrics ? "flip.mean" : "rmse";
  return `${name} ${number(metrics[name])}`;
}

function number(value) {
  if (value === null || value === undefined) return "not a number";
  if (value === 0) return "0";
  const size = Math.abs(value);
  return size >= 1e-3 && size < 1e5 ? value.toPrecision(4) : value.toExponential(3);
}

function fillList() {
  const count = (status) => cases.filter((c) => c.status === status).length;
  const words = ["differs", "missing", "unusable", "same"].filter(count);
  $("title").textContent = document.title = report.title;
  $("summary").replaceChildren(...words.flatMap((word, k) => [k ? ", " : "", element("span", `${count(word)} ${word}`, word)]));
  $("cases").replaceChildren(...cases.map((entry, index) => {
    const button = element("button");
    button.dataset.status = entry.status;
    const thumb = element("canvas");
    thumb.width = thumb.height = 84;
    const note = element("span", "", "case-note");
    note.append(element("span", entry.status, entry.status), ` · ${headline(entry)}`);
    button.append(thumb, element("span", entry.name, "case-name"), note);
    button.addEventListener("click", () => select(index));
    return button;
  }));
  if (report.accept && cases.some((c) => c.status !== "same")) {
    $("accept-all").append(element("h3", "Accept all that do not pass"), command(report.accept));
  }
}

function command(text) {
  const row = element("div", "", "command");
  const copy = element("button", "Copy");
  copy.addEventListener("click", async () => {
    try {
      await navigator.clipboard.writeText(text);
    } catch {
      // Pages from a disk may not use the clipboard directly.
      const area = element("textarea", text);
      document.body.append(area);
      area.select();
      document.execCommand("copy");
      area.remove();
    }
    copy.textContent = "Copied";
    setTimeout(() => { copy.textContent = "Copy"; }, 1200);
  });
  row.append(element("code", text), copy);
  return row;
}

async function select(index) {
  current = index;
  const entry = cases[index];
  location.replace(`#${encodeURIComponent(entry.name)}`);
  [...$("cases").children].forEach((button, k) => button.setAttribute("aria-current", k === index));
  $("cases").children[index].scrollIntoView({ block: "nearest" });
  $("name").textContent = entry.name;
  $("status").textContent = entry.status;
  $("status").className = `chip ${entry.status}`;
  $("reasons").replaceChildren(...(entry.status === "same" ? [] : entry.reasons.map((r) => element("li", r))));
  $("layer").replaceChildren(...report.pictures[index].map((layer) => element("option", layer.name)));
  fillDetails(entry, report.pictures[index]);
  await showLayer(0);
}

async function showLayer(position) {
  const index = current;
  const layer = (await layersOf(index))[position];
  if (index !== current) return;
  const errors = {};
  if (layer) {
    for (const map of layer.maps) errors[map.name] = () => errorColours(map);
    const { actual, expected } = layer;
    if (actual && expected && actual.planes.length === expected.planes.length
        && actual.width === expected.width && actual.height === expected.height) {
      errors.difference = (exposure) => signedDifference(actual, expected, exposure);
    }
    const verdict = layer.name === "colour" ? cases[index].comparison?.verdict : null;
    for (const plane of verdict?.planes ?? []) {
      errors[`z of tiles, ${plane.name}`] = () => tileColours(verdict, plane, layer.width, layer.height);
    }
  }
  const names = Object.keys(errors);
  $("error-map").disabled = names.length === 0;
  $("error-map").replaceChildren(...names.map((name) => element("option", name)));
  if (names.includes(viewer.errorName)) $("error-map").value = viewer.errorName;
  viewer.errorName = $("error-map").value || undefined;
  viewer.show(layer, errors);
}

function table(rows, head) {
  const made = element("table");
  if (head) {
    const row = element("tr");
    row.append(...head.map((text) => element("th", text)));
    made.append(row);
  }
  for (const { cells, isOther } of rows) {
    const row = element("tr", "", isOther ? "other" : "");
    row.append(...cells.map((text, k) => element(k === 0 ? "th" : "td", text, isFinite(text) && k && cells.length === 2 ? "number" : "")));
    made.append(row);
  }
  const scroll = element("div", "", "scroll");
  scroll.append(made);
  return scroll;
}

function section(title, ...content) {
  const made = element("div");
  made.append(element("h3", title), ...content);
  return made;
}

function fillDetails(entry, pictures) {
  const parts = [];
  const { comparison, metadata } = entry;
  for (const layer of comparison?.layers ?? []) {
    const rows = layer.order.map((name) => ({ cells: [name, number(layer.metrics[name])] }));
    rows.push({ cells: ["epsilon of relmse", number(layer.epsilon)] });
    if (layer.hdrflip_exposures) {
      const { start, stop, count } = layer.hdrflip_exposures;
      rows.push({ cells: ["exposures of hdrflip", `${count} from ${start.toFixed(2)} to ${stop.toFixed(2)} EV`] });
    }
    const title = comparison.layers.length > 1 ? `Errors, ${layer.name}` : "Errors";
    parts.push(section(title, table(rows)));
  }
  const verdict = comparison?.verdict;
  if (verdict) {
    const percent = (v) => `${(100 * v).toPrecision(3)} %`;
    const rows = verdict.planes.flatMap((p) => [
      { cells: [p.name, p.alarms.length ? `more than noise: ${p.alarms.join(", ")}` : "no more than noise"], isOther: p.alarms.length > 0 },
      { cells: ["mean", `${percent(p.difference / p.reference_mean)}, z ${p.z.toFixed(1)}; ${percent(p.visible_bias)} would show`] },
      { cells: ["worst tile", `z ${p.tiles[p.worst_tile].toFixed(1)}`] },
      ...(p.worst_pixel ? [
        { cells: ["worst pixel", `(${p.worst_pixel.x}, ${p.worst_pixel.y}), z ${p.worst_pixel.z.toFixed(1)}`] },
        { cells: ["p-values below 0.05", `${p.small_p_values} of ${p.noisy_pixels} pixels`] },
      ] : []),
    ]);
    parts.push(section("Verdict by the noise", table(rows),
      element("p", `p ${verdict.p_value === 0 ? "below 1e-300" : verdict.p_value.toExponential(2)} at a rate of false alarms of ${verdict.level}; noise from ${verdict.basis}.`, "remark")));
  }
  const notes = [...comparison?.notes ?? []];
  const factor = pictures[0]?.actual?.factor ?? pictures[0]?.expected?.factor ?? 1;
  if (factor > 1) notes.push(`shown at 1/${factor} of its size to keep the page small; the numbers are of the whole`);
  if (comparison) notes.unshift(`rules: ${comparison.rules.join(", ")}`);
  const { actual, expected } = metadata;
  const names = [...new Set([...Object.keys(actual ?? {}), ...Object.keys(expected ?? {})])].sort();
  if (names.length) {
    const rows = names.map((name) => {
      const [a, b] = [actual?.[name] ?? "", expected?.[name] ?? ""];
      return { cells: [name.replace(/^steradian\./, ""), a, b], isOther: Boolean(actual && expected) && a !== b };
    });
    parts.push(section("What made them", table(rows, ["", "actual", "expected"])));
  }
  const commands = section("Commands", element("p", "reproduces the actual picture", "remark"));
  const reproduce = actual && reproducing(actual, entry);
  commands.append(reproduce ? command(reproduce) : element("p", "unknown: the file does not say what made it"));
  if (entry.status !== "same" && entry.status !== "unusable" && actual) {
    commands.append(element("p", "accepts it", "remark"), command(`steradian compare --accept ${quote(entry.actual)} ${quote(entry.expected)}`));
  }
  commands.append(...notes.map((note) => element("p", note, "remark")));
  commands.className = "wide";
  $("details").replaceChildren(commands, ...parts);
}

function quote(word) {
  return /^[\w./=,:+-]+$/.test(word) ? word : `'${word.replaceAll("'", "'\\''")}'`;
}

// The call that made a picture, from its metadata: `command` if it says so, else from the settings
// of this renderer that are not the usual ones.
function reproducing(metadata, entry) {
  if (metadata.command ?? metadata["steradian.command"]) return metadata.command ?? metadata["steradian.command"];
  const get = (name) => metadata[`steradian.${name}`];
  if (!get("scene")) return null;
  const layer = report.pictures[cases.indexOf(entry)][0];
  const words = ["steradian", "render", quote(`${get("scene")}.gltf`), "--resolution", `${layer?.width}x${layer?.height}`];
  const flags = [
    ["spp", "spp", null], ["seed", "seed", "0"], ["block", "block", null], ["strategy", "strategy", "mis"],
    ["sampler", "sampler", "sobol"], ["accel", "accel", "bvh"], ["light_samples", "light-samples", "1"],
    ["max_bounces", "max-bounces", "none"], ["only_bounce", "only-bounce", "none"],
  ];
  for (const [name, flag, usual] of flags) {
    if (get(name) !== undefined && get(name) !== usual) words.push(`--${flag}`, quote(get(name)));
  }
  if (get("roulette") === "false") words.push("--no-roulette");
  if (get("path_reuse") === "true") words.push("--path-reuse");
  if (get("camera")) words.push("--camera", quote(get("camera")));
  words.push("-o", quote(entry.name.split("/").pop()));
  return words.join(" ");
}

function setExposure(value) {
  viewer.exposure = value;
  $("exposure").value = value;
  $("exposure-value").textContent = `${value >= 0 ? "+" : ""}${value.toFixed(2)} EV`;
  viewer.draw();
}

function setMode(mode) {
  for (const button of $("modes").children) button.setAttribute("aria-pressed", button.dataset.mode === mode);
  viewer.setMode(mode);
}

function toWorst() {
  const worst = cases[current].comparison?.layers[$("layer").selectedIndex]?.worst;
  if (worst) viewer.zoomTo(Math.max(viewer.view.zoom, 12), worst.x + 0.5, worst.y + 0.5);
}

function step(by) {
  const shown = [...$("cases").children].map((button, k) => (button.hidden ? -1 : k)).filter((k) => k >= 0);
  const next = shown[shown.indexOf(current) + by];
  if (next !== undefined) select(next);
}

for (const button of $("modes").children) button.addEventListener("click", () => setMode(button.dataset.mode));
$("exposure").addEventListener("input", () => setExposure(Number($("exposure").value)));
$("exposure").addEventListener("dblclick", () => setExposure(0));
$("layer").addEventListener("change", () => showLayer($("layer").selectedIndex));
$("error-map").addEventListener("change", () => { viewer.errorName = $("error-map").value; viewer.draw(); });
$("fit").addEventListener("click", () => viewer.fit());
$("natural").addEventListener("click", () => viewer.zoomTo(1));
$("worst").addEventListener("click", toWorst);
$("only-failing").addEventListener("change", () => {
  for (const button of $("cases").children) {
    button.hidden = $("only-failing").checked && button.dataset.status === "same";
  }
});
document.addEventListener("keydown", (event) => {
  if (event.ctrlKey || event.metaKey || event.altKey || event.target.matches("input, select, textarea")) return;
  const keys = {
    1: () => setMode("side"), 2: () => setMode("slider"), 3: () => setMode("blink"), 4: () => setMode("error"),
    0: () => viewer.fit(), "+": () => setExposure(viewer.exposure + 0.25), "-": () => setExposure(viewer.exposure - 0.25),
    ArrowDown: () => step(1), ArrowUp: () => step(-1),
    " ": () => { if (viewer.mode === "blink") { viewer.isPaused = true; viewer.flip(); } },
  };
  if (event.key === " " && (viewer.mode !== "blink" || event.target.matches("button"))) return;
  if (keys[event.key]) {
    event.preventDefault();
    keys[event.key]();
  }
});

// Small pictures for the list, one after the other.
async function drawThumbs() {
  for (let index = 0; index < cases.length; index++) {
    const layer = (await layersOf(index))[0];
    const picture = layer?.actual ?? layer?.expected;
    if (!picture) continue;
    const thumb = $("cases").children[index].querySelector("canvas");
    const scale = Math.max(thumb.width / picture.width, thumb.height / picture.height);
    const context = thumb.getContext("2d");
    context.imageSmoothingEnabled = scale < 1;
    context.drawImage(develop(picture, 0), (thumb.width - picture.width * scale) / 2,
      (thumb.height - picture.height * scale) / 2, picture.width * scale, picture.height * scale);
  }
}

fillList();
setMode("side");
setExposure(0);
const asked = cases.findIndex((entry) => `#${encodeURIComponent(entry.name)}` === location.hash);
if (cases.length) select(Math.max(asked, 0)).then(drawThumbs);
