// The page of maps that ./dev figure makes, by the real server and client, on a real mesh file; then
// in Chromium, where there is one. UNWRAPD_BIN: the folder of both programs.
import assert from "node:assert/strict";
import { execFile } from "node:child_process";
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { fileURLToPath, pathToFileURL } from "node:url";
import { promisify } from "node:util";

import { areaOf, inUnitsOf, plan } from "../../client/figure.mjs";
import { startServer } from "../contract/server.mjs";
import { chromium, noChromium } from "./browsers.mjs";

const run = promisify(execFile);
const bin = process.env.UNWRAPD_BIN;
const figure = fileURLToPath(new URL("../../client/figure.mjs", import.meta.url));
const folder = mkdtempSync(join(tmpdir(), "unwrap_figure_"));
const at = (name) => join(folder, name);
const METHODS = ["asap", "hybrid", "arap", "abf", "linabf", "ic", "cp", "bff", "slim"];
const TITLES = plan(METHODS, ["guarantee"]).flat().map((map) => map.title);
let server;
let page;

/** An OBJ of a dome of n x n quads, so large across. */
function dome(n, across) {
  const lines = [];
  for (let y = 0; y <= n; y += 1)
    for (let x = 0; x <= n; x += 1) {
      const [u, v] = [(2 * x) / n - 1, (2 * y) / n - 1];
      lines.push(`v ${[u, v, 1.5 * Math.exp(-2 * (u * u + v * v))].map((c) => (c * across) / 2).join(" ")}`);
    }
  const corner = (x, y) => y * (n + 1) + x + 1;
  for (let y = 0; y < n; y += 1)
    for (let x = 0; x < n; x += 1)
      lines.push(`f ${corner(x, y)} ${corner(x + 1, y)} ${corner(x + 1, y + 1)} ${corner(x, y + 1)}`);
  return `${lines.join("\n")}\n`;
}

async function makePage(name, obj) {
  writeFileSync(at(`${name}.obj`), obj);
  const { stdout } = await run("node",
    [figure, server.base, join(bin, "unwrap"), at(`${name}.obj`), at(`${name}.html`)]);
  return { said: stdout, html: readFileSync(at(`${name}.html`), "utf8") };
}

const all = (text, pattern) => [...text.matchAll(pattern)].map((match) => match[1]);
const captionsOf = (html) => all(html, /<figcaption>(.*?)<\/figcaption>/g);

const DRAWINGS = /<svg class="layout" [^>]*>(<g transform="[^"]+">.*?<\/g>)<\/svg>/gs;

/** [D_angle, D_area] of a title. */
function figuresOf(html, title) {
  const caption = captionsOf(html).find((text) => text.startsWith(`<b>${title}</b>`));
  return caption.match(/\[([\d.]+), ([\d.]+)\]/).slice(1).map(Number);
}

before(async () => {
  server = await startServer(join(bin, "unwrapd"), ["--workers", "1"]);
  page = await makePage("dome", dome(12, 1000));
});

after(async () => {
  await server?.stop();
  rmSync(folder, { recursive: true });
});

test("the page has every map, with its figures and both of its pictures", () => {
  const captions = captionsOf(page.html);
  assert.equal(captions.length, TITLES.length);
  TITLES.forEach((title, k) => {
    assert.ok(captions[k].startsWith(`<b>${title}</b><br>[`), captions[k]);
    for (const value of figuresOf(page.html, title)) assert.ok(value >= 2 && value < 4, captions[k]);
    assert.ok(page.said.includes(`${title}: [`), `${title} is not told`);
  });
  for (const [kind, pattern] of [["preview", /<img class="preview" alt="[^"]+" src="([^"]+)"/g], ["layout", DRAWINGS]]) {
    const pictures = all(page.html, pattern);
    assert.equal(pictures.length, TITLES.length, kind);
    assert.ok(new Set(pictures).size > TITLES.length / 2, `one ${kind} for all`);
  }
  assert.match(page.html, /<h1>dome\.obj, 288 triangles<\/h1>/);
});

test("the page needs nothing but itself: pictures are whole, and nothing is linked or run", () => {
  const sources = all(page.html, /src="([^"]*)"/g);
  assert.equal(sources.length, TITLES.length);
  for (const source of sources) {
    const bytes = Buffer.from(source.replace("data:image/png;base64,", ""), "base64");
    assert.equal(bytes.toString("latin1", 1, 4), "PNG");
    assert.equal(bytes.toString("latin1", bytes.length - 8, bytes.length - 4), "IEND");
  }
  assert.doesNotMatch(page.html, /<script|<link|<a |url\(|https?:/);
});

/** The corners of the triangles of a drawing, as its transform puts them; y points down. */
function pointsOf(drawing) {
  const [, left = 0, top = 0, degrees, scale, x, y, unit] = drawing.match(
    /"(?:translate\((\S+) (\S+)\) )?rotate\((\S+)\) scale\((\S+) -\S+\) translate\((\S+) (\S+)\) scale\((\S+)\)/).map((text) => Number(text ?? 0));
  const [c, s] = [Math.cos((degrees * Math.PI) / 180), Math.sin((degrees * Math.PI) / 180)];
  return all(drawing, /M(-?\d+[ -]\d*)l/g).map((pair) => {
    const [a, b] = pair.match(/-?\d+/g).map(Number);
    const [p, q] = [scale * (a * unit + x), -scale * (b * unit + y)];
    return [left + c * p - s * q, top + s * p + c * q];
  });
}

const boxOf = (points) => [0, 1].flatMap((k) => [Math.min, Math.max].map((of) => of(...points.map((p) => p[k]))));

test("maps lie on each other: each is about as wide and as high as ARAP's, around one middle", () => {
  const boxes = all(page.html, DRAWINGS).map((drawing) => {
    const points = pointsOf(drawing);
    assert.ok(points.length > 200);
    return boxOf(points);
  });
  const arap = boxes[TITLES.findIndex((title) => title.startsWith("ARAP"))];
  const size = arap[1] - arap[0];
  boxes.forEach((own, k) => own.forEach((side, i) =>
    assert.ok(Math.abs(side - arap[i]) < 0.25 * size, `${TITLES[k]}: ${own} beside ${arap}`)));
  assert.equal(new Set(all(page.html, /<svg class="layout" [^>]*viewBox="([^"]+)"/g)).size, 1, "one scale");
});

/** An OBJ with other OBJs beside each other. */
function beside(...objs) {
  let before = 0;
  return objs.map((obj, k) => {
    const lines = obj.replace(/^v (\S+)/gm, (_, x) => `v ${Number(x) + 2000 * k}`).replace(/^f .*$/gm, (face) => face.replace(/\d+/g, (v) => Number(v) + before));
    before += obj.match(/^v /gm).length;
    return lines;
  }).join("");
}

test("each of several charts has one place and one direction in all maps, and none lies on another", async () => {
  const { html } = await makePage("three", beside(dome(8, 1000), dome(4, 300), dome(6, 600)));
  const drawings = all(html, DRAWINGS).map((drawing) => all(drawing, /(<g transform="[^"]+">.*?<\/g>)/gs).map(pointsOf));
  assert.equal(drawings.length, TITLES.length);
  const boxes = drawings.map((charts) => charts.map(boxOf));
  assert.deepEqual(drawings[0].map((points) => points.length > 100), [true, false, false], "every triangle is with its own chart");
  for (const charts of drawings) assert.deepEqual(charts.map((points) => points.length), drawings[0].map((points) => points.length));
  for (const charts of boxes) {
    charts.forEach((box, k) => {
      const size = Math.max(boxes[0][k][1] - boxes[0][k][0], boxes[0][k][3] - boxes[0][k][2]);
      box.forEach((side, i) => assert.ok(Math.abs(side - boxes[0][k][i]) < 0.25 * size, `${box} beside ${boxes[0][k]}`));
      for (const other of charts.slice(0, k))
        assert.ok([0, 2].some((i) => other[i + 1] < box[i] || box[i + 1] < other[i]), `${box} lies on ${other}`);
    });
  }
});

test("lambda walks from the conformal map to the rigid one, whatever the mesh's units", () => {
  const walk = TITLES.filter((title) => title.includes("λ")).map((title) => figuresOf(page.html, title));
  for (let k = 1; k < walk.length; k += 1) {
    assert.ok(walk[k][0] >= walk[k - 1][0], `D_angle ${walk}`);
    assert.ok(walk[k][1] <= walk[k - 1][1], `D_area ${walk}`);
  }
  const area = walk.map((figures) => figures[1]);
  assert.ok(area[1] > area.at(-1) + 0.02, `the first lambda is near rigid: ${area}`);
  assert.ok(area.at(-2) < area.at(-1) + 0.005, `the last lambda is not: ${area}`);
  const options = { method: "hybrid", lambda: 0.25 };
  assert.deepEqual(inUnitsOf(8, options), { method: "hybrid", lambda: "2" });
  assert.deepEqual(inUnitsOf(undefined, { method: "arap" }), { method: "arap" });
  assert.throws(() => inUnitsOf(undefined, options), /area is not known/);
  assert.equal(areaOf({ charts: [{ area: 2 }, { area: 3 }] }), 5);
});

/** What Chromium prints and logs for a page. */
async function browse(address, ...flags) {
  const quiet = ["--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run",
    "--disable-background-networking", "--disable-component-update", "--disable-sync",
    "--hide-scrollbars", "--enable-logging=stderr", `--user-data-dir=${at("profile")}`];
  const { stdout, stderr } = await run(chromium, [...quiet, ...flags, address],
    { timeout: 120_000, maxBuffer: 1 << 28 });
  return { dom: stdout, console: stderr.split("\n").filter((line) => line.includes("CONSOLE")) };
}

test("a browser shows every picture and complains of nothing", { skip: noChromium }, async () => {
  const probe = `<script>addEventListener("load", () => {
    document.title = "widths " + [...document.images].map((image) => image.naturalWidth);
  });</script></body>`;
  writeFileSync(at("probe.html"), page.html.replace("</body>", probe));
  const { dom, console } = await browse(pathToFileURL(at("probe.html")), "--dump-dom");
  const widths = dom.match(/<title>widths ([\d,]+)<\/title>/)[1].split(",").map(Number);
  assert.equal(widths.length, TITLES.length);
  assert.ok(widths.every((width) => width >= 256), `${widths}`);
  assert.deepEqual(console, []);
  await browse(pathToFileURL(at("dome.html")), "--window-size=1500,1400", `--screenshot=${at("page.png")}`);
  assert.ok(readFileSync(at("page.png")).length > 50_000, "the picture of the page is not blank");
});
