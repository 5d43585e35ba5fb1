// Opens a report in headless Chromium, clicks through it, and fails on any error.
//
//     node tools/test_report.mjs REPORT.html SCREENSHOT_FOLDER
//
// Called by tools/test_report.sh, which makes the report and installs playwright-core.

import assert from "node:assert/strict";
import { statSync } from "node:fs";
import { resolve } from "node:path";
import { chromium } from "playwright-core";

const [report, folder] = process.argv.slice(2);
const browser = await chromium.launch({
  executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium",
  args: ["--no-sandbox"],
});
const problems = [];

async function open(colorScheme) {
  const context = await browser.newContext({ viewport: { width: 1400, height: 1000 }, colorScheme });
  const page = await context.newPage();
  page.on("console", (message) => {
    if (["error", "warning"].includes(message.type())) problems.push(`console: ${message.text()}`);
  });
  page.on("pageerror", (error) => problems.push(`page: ${error.message}`));
  page.on("request", (request) => {
    if (!/^(file|data|blob):/.test(request.url())) problems.push(`request: ${request.url()}`);
  });
  await page.goto(`file://${resolve(report)}`);
  await page.waitForFunction(() => document.querySelector("#cases canvas") && viewer.layer);
  return page;
}

// Hash of what a pane shows, and how many colours it has.
const pane = (page, index) => page.evaluate((index) => {
  const canvas = document.querySelectorAll("#stage canvas")[index];
  const copy = new OffscreenCanvas(canvas.width, canvas.height).getContext("2d", { willReadFrequently: true });
  copy.drawImage(canvas, 0, 0);
  const { data } = copy.getImageData(0, 0, canvas.width, canvas.height);
  const colours = new Set();
  let hash = 0;
  for (let i = 0; i < data.length; i += 4) {
    const colour = (data[i] << 16) | (data[i + 1] << 8) | data[i + 2];
    hash = (hash * 31 + colour) | 0;
    colours.add(colour);
  }
  return { hash, colours: colours.size };
}, index);

const click = (page, text) => page.getByRole("button", { name: text, exact: true }).click();

// Selects a case by its name, and waits for its pixels.
async function choose(page, name) {
  await page.locator("#cases button", { hasText: name }).first().click();
  await page.waitForFunction((name) =>
    document.getElementById("name").textContent === name && viewer.layer === undefined
    || document.getElementById("name").textContent === name
    && decoded.get(current) && viewer.layer.name === (report.pictures[current][0]?.name), name);
  await page.waitForTimeout(80);
}

const page = await open("light");
const names = await page.locator("#cases .case-name").allTextContents();
const statuses = await page.locator("#cases button").evaluateAll((all) => all.map((b) => b.dataset.status));
const order = ["unusable", "missing", "differs", "same"];
const ranks = statuses.map((status) => order.indexOf(status));
assert.deepEqual(ranks, [...ranks].sort(), "the worst comes first");
console.log(`${names.length} pictures, ${(statSync(report).size / 1e6).toFixed(2)} MB`);

// Every case in every mode.
for (const [index, name] of names.entries()) {
  await choose(page, name);
  for (const mode of ["Side by side", "Slider", "Blink", "Error"]) {
    await click(page, mode);
    await page.waitForTimeout(30);
  }
  await click(page, "Side by side");
  if (!["missing", "unusable"].includes(statuses[index])) {
    for (const k of [0, 1]) assert((await pane(page, k)).colours > 2, `${name}: pane ${k} is blank`);
  }
}

// A linear picture that differs.
const linear = names.find((name, k) => name.endsWith(".exr") && statuses[k] === "differs");
assert(linear, "the report has an .exr that differs");
await choose(page, linear);
await page.waitForTimeout(200);
await page.screenshot({ path: `${folder}/report-side.png` });

// The exposure brightens, and comes back.
const before = await pane(page, 0);
const setExposure = (value) => page.locator("#exposure").evaluate((slider, value) => {
  slider.value = value;
  slider.dispatchEvent(new Event("input"));
}, value);
await setExposure(2);
assert.notEqual((await pane(page, 0)).hash, before.hash, "exposure has no effect");
assert.match(await page.locator("#exposure-value").textContent(), /\+2\.00 EV/);
await setExposure(0);
assert.equal((await pane(page, 0)).hash, before.hash, "exposure does not come back");

// What stands under the cursor are the picture's values: its pixel in the middle of the pane.
const box = await page.locator("#stage canvas").first().boundingBox();
await page.mouse.move(box.x + box.width / 2 + 1, box.y + box.height / 2 + 1);
const told = await page.locator("#readout").textContent();
const truth = await page.evaluate(() => {
  const { width, height, actual } = viewer.layer;
  const [x, y] = [Math.floor(width / 2), Math.floor(height / 2)];
  const index = Math.floor(y / actual.factor) * actual.width + Math.floor(x / actual.factor);
  return `(${x}, ${y})   actual ${actual.channels[0]} ${HALVES[actual.planes[0][index]].toPrecision(4)}`;
});
assert(told.startsWith(truth), `${told} does not begin with ${truth}`);

// Zoom and pan move all panes together.
const all = () => Promise.all([0, 1, 2].map((k) => pane(page, k)));
const fitted = await all();
await page.mouse.wheel(0, -600);
const zoomed = await all();
zoomed.forEach((z, k) => assert.notEqual(z.hash, fitted[k].hash, `the wheel does not zoom pane ${k}`));
await page.mouse.down();
await page.mouse.move(box.x + box.width / 2 + 60, box.y + box.height / 2 + 40, { steps: 4 });
await page.mouse.up();
(await all()).forEach((p, k) => assert.notEqual(p.hash, zoomed[k].hash, `dragging does not move pane ${k}`));
await click(page, "Worst pixel");
await page.waitForTimeout(50);
await page.screenshot({ path: `${folder}/report-worst.png` });
await click(page, "Fit");
(await all()).forEach((p, k) => assert.equal(p.hash, fitted[k].hash, `pane ${k} is not fitted again`));

// The slider.
await click(page, "Slider");
const wide = await page.locator("#stage canvas").boundingBox();
const middle = await pane(page, 0);
await page.mouse.move(wide.x + wide.width / 2, wide.y + wide.height / 2);
await page.mouse.down();
await page.mouse.move(wide.x + wide.width * 0.6, wide.y + wide.height / 2, { steps: 5 });
await page.mouse.up();
assert.notEqual((await pane(page, 0)).hash, middle.hash, "the slider does not move");
assert.equal(await page.evaluate(() => Math.round(viewer.split * 10)), 6);
await page.screenshot({ path: `${folder}/report-slider.png` });

// Blinking goes on by itself, and by the space bar.
await click(page, "Blink");
const first = await page.locator("#stage figcaption").textContent();
await page.waitForFunction((first) => document.querySelector("#stage figcaption").textContent !== first, first);
await page.locator("#stage").focus();
const shown = await page.locator("#stage figcaption").textContent();
await page.keyboard.press("Space");
assert.notEqual(await page.locator("#stage figcaption").textContent(), shown, "space does not flip");

// Every map of errors.
await click(page, "Error");
const hashes = new Set();
for (const name of await page.locator("#error-map option").allTextContents()) {
  await page.locator("#error-map").selectOption(name);
  const map = await pane(page, 0);
  assert(map.colours > 1, `map ${name} is blank`);
  hashes.add(map.hash);
  if (name.startsWith("z of tiles")) await page.screenshot({ path: `${folder}/report-tiles.png` });
}
assert(hashes.size > 2, "the maps of errors are all the same");

// The list: filter, keys, command.
await page.locator("#only-failing").check();
assert.equal(await page.locator("#cases button:visible").count(), statuses.filter((s) => s !== "same").length);
await page.locator("#only-failing").uncheck();
await page.locator("#stage").focus();
const at = await page.locator("#name").textContent();
await page.keyboard.press("ArrowDown");
await page.waitForFunction((at) => document.getElementById("name").textContent !== at, at);
await page.locator("#details .command button").first().click();
await page.waitForFunction(() => [...document.querySelectorAll("button")].some((b) => b.textContent === "Copied"));
const commands = await page.locator(".command code").allTextContents();
assert(commands.some((text) => text.startsWith("steradian compare --accept ")), "no command accepts");
assert(commands.some((text) => text.startsWith("steradian render ")), "no command reproduces");

const dark = await open("dark");
await choose(dark, linear);
await dark.waitForTimeout(300);
await dark.screenshot({ path: `${folder}/report-dark.png`, fullPage: true });
const narrow = await open("light");
await narrow.setViewportSize({ width: 420, height: 900 });
await narrow.waitForTimeout(200);
await narrow.screenshot({ path: `${folder}/report-narrow.png` });

await browser.close();
assert.deepEqual(problems, [], "the page has errors");
console.log("no errors in the console, no requests to a network");
