// The page at / of a real server in a real Chromium, for the tests of its flows. UNWRAPD is the server.
import { spawn } from "node:child_process";
import { once } from "node:events";
import { existsSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import net from "node:net";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { fileURLToPath } from "node:url";

import { startServer } from "../contract/server.mjs";
import { chromium, firefox, noChromium } from "./browsers.mjs";

export const binary = process.env.UNWRAPD;
const playwright = await import("playwright-core").catch(() => undefined);
const data = process.env.UNWRAPD_TEST_DATA ?? fileURLToPath(new URL("../../../shared/data", import.meta.url));

/** Why the tests cannot run; false if they can. */
export const missing = noChromium ||
  (!playwright && "tests/node_modules is missing: run npm ci in tests/");

/** WebGL without a GPU: what draws in its place draws the canvases alone, and not the page around them. */
const args = ["--host-resolver-rules=MAP unwrapd.test 127.0.0.1", "--no-sandbox", "--disable-quic", "--use-gl=angle", "--use-angle=swiftshader", "--disable-gpu-compositing", "--webgl-antialiasing-mode=none", "--enable-unsafe-swiftshader"];

export const launchChromium = (flags) => playwright.chromium.launch({ executablePath: chromium, args: flags });

/** A screen that nobody sees: without one Firefox draws no WebGL. Ends with the browser. */
async function hiddenScreen() {
  const screen = spawn("Xvfb", ["-displayfd", "3", "-screen", "0", "1280x1024x24"], { stdio: ["ignore", "ignore", "ignore", "pipe"] });
  const [number] = await Promise.race([once(screen.stdio[3], "data"), once(screen, "exit").then(() => [""])]);
  return { screen, display: `:${String(number).trim()}` };
}

/** Whether pages of a browser can draw the views. */
export const draws = (page) => page.evaluate(() => Boolean(document.createElement("canvas").getContext("webgl2")));

async function canDraw(browser) {
  const page = await browser.newPage();
  const can = await draws(page);
  await page.close();
  return can;
}

/**
 * Debian's Firefox, by the protocol that all browsers speak. It draws by Mesa, without a GPU. On a busy machine its
 * look for a driver may run out of time, after which it draws nothing: then it is started again.
 */
export async function launchFirefox(tries = 3) {
  const { screen, display } = await hiddenScreen();
  const browser = await playwright.firefox.launch({ executablePath: firefox, channel: "moz-firefox",
    firefoxUserPrefs: { "webgl.force-enabled": true }, env: { ...process.env, DISPLAY: display, LIBGL_ALWAYS_SOFTWARE: "1" } });
  browser.on("disconnected", () => screen.kill());
  if (tries === 1 || await canDraw(browser)) return browser;
  await browser.close();
  return launchFirefox(tries - 1);
}

/** The path of a real mesh; undefined where there are none. */
export function real(name) {
  const path = join(data, name);
  return existsSync(path) ? path : undefined;
}

/** Gives the page pixelsOf(): a picture, as base64, as an ImageData, in its own size or scaled. */
function definePixelsOf() {
  window.pixelsOf = async (bytes, { width, height } = {}) => {
    const image = new Image();
    image.src = `data:image/png;base64,${bytes}`;
    await image.decode();
    const size = { width: width ?? image.width, height: height ?? image.height };
    const pen = Object.assign(document.createElement("canvas"), size).getContext("2d");
    pen.drawImage(image, 0, 0, size.width, size.height);
    return pen.getImageData(0, 0, size.width, size.height);
  };
}

/** A server, a browser and a folder of files, for the tests of one file. */
export class Bench {
  folder = mkdtempSync(join(tmpdir(), "unwrapd-page-"));

  async open(launch = () => launchChromium(args)) {
    this.server = await startServer(binary, ["--workers", "1"]);
    this.browser = await launch();
  }

  async close() {
    await this.browser?.close();
    await this.server?.stop();
    rmSync(this.folder, { recursive: true });
  }

  /** The path of a file with these bytes. */
  file(name, bytes) {
    const path = join(this.folder, name);
    writeFileSync(path, bytes);
    return path;
  }

  /** The page as a fresh visitor sees it. */
  async visit(t, { base = this.server.base, hash = "", ...options } = {}) {
    const page = await this.blank(t, base, options);
    await page.goto(`${base}/${hash}`);
    await page.locator("#option-method").waitFor();
    return page;
  }

  /** A fresh visitor's browser; complaints are what its console got, elsewhere what it asked of others. */
  async blank(t, base = this.server.base, options = {}) {
    const context = await this.browser.newContext({ viewport: { width: 1280, height: 900 }, reducedMotion: "reduce", ...options });
    t.after(() => context.close());
    await context.addInitScript(definePixelsOf);
    const page = await context.newPage();
    page.setDefaultTimeout(60_000);
    page.complaints = [];
    page.elsewhere = [];
    page.on("pageerror", (error) => page.complaints.push(String(error)));
    page.on("console", (line) => line.type() === "error" && page.complaints.push(line.text()));
    page.on("request", (request) => {
      const url = request.url();
      if (!url.startsWith(base) && !/^(blob|data):/.test(url)) page.elsewhere.push(url);
    });
    return page;
  }
}

/** Opens files and waits until the mesh has been looked at. */
export async function openMesh(page, ...files) {
  await page.setInputFiles("#files", files);
  await page.locator("#analysis li", { hasText: "triangle" }).first().waitFor();
}

/** Unwraps what is open and waits for the result. */
export async function unwrap(page, ...files) {
  if (files.length > 0) await openMesh(page, ...files);
  await page.click("#send");
  await page.locator("#result").waitFor();
}

/** Opens a mesh whose job takes long, and waits until it iterates. */
export async function unwrapForLong(page, file) {
  await page.check("#preset-chart");
  await page.click("#form summary");
  await page.fill("[name='stop.iterations']", "10000");
  await openMesh(page, file);
  await page.click("#send");
  await page.locator("#iteration", { hasText: "Iteration" }).waitFor();
}

/** [name, bytes] of what a button gives. */
export async function downloaded(page, button) {
  const [download] = await Promise.all([page.waitForEvent("download"), page.click(button)]);
  return [download.suggestedFilename(), readFileSync(await download.path())];
}

export const figure = (page, name) =>
  page.locator(`#figures div:has(dt:text-is("${name}")) dd`).evaluate((dd) => dd.firstChild.textContent);

/** Drops files on an element of the page. files: [name, bytes]. */
export async function drop(page, selector, files) {
  const dropped = await page.evaluateHandle((all) => {
    const transfer = new DataTransfer();
    for (const [name, bytes] of all) transfer.items.add(new File([new Uint8Array(bytes)], name));
    return transfer;
  }, files.map(([name, bytes]) => [name, [...Buffer.from(bytes)]]));
  await page.dispatchEvent(selector, "drop", { dataTransfer: dropped });
}

/** What a canvas shows: the share of pixels that differ from its corner, how many colours, and the corner's green. */
export async function seen(page, canvas) {
  return page.evaluate(async (bytes) => {
    const { data, width, height } = await pixelsOf(bytes);
    const at = (x, y) => 4 * (y * width + x);
    const colourAt = (i) => (data[i] >> 4) * 256 + (data[i + 1] >> 4) * 16 + (data[i + 2] >> 4);
    const colours = new Map();
    for (let y = 6; y < height - 6; y += 1)
      for (let x = 6; x < width - 6; x += 1) colours.set(colourAt(at(x, y)), (colours.get(colourAt(at(x, y))) ?? 0) + 1);
    const all = (width - 12) * (height - 12);
    return { share: 1 - colours.get(colourAt(at(6, 6))) / all, colours: colours.size, ground: data[at(6, 6) + 1] };
  }, (await page.locator(canvas).screenshot()).toString("base64"));
}

/** A picture of a canvas, once what was asked for is drawn. */
export async function shot(page, canvas) {
  await page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));
  return (await page.locator(canvas).screenshot()).toString("base64");
}

/**
 * The share of pixels by which two pictures differ visibly, at the size of the first. side: both are
 * scaled to it before, which takes no notice of half a pixel.
 */
export function difference(page, one, other, side) {
  return page.evaluate(async ([a, b, scaled]) => {
    const first = await pixelsOf(a, { width: scaled, height: scaled });
    const [p, q] = [first.data, (await pixelsOf(b, first)).data];
    let differing = 0;
    for (let i = 0; i < p.length; i += 4)
      if ([0, 1, 2].some((k) => Math.abs(p[i + k] - q[i + k]) > 48)) differing += 1;
    return (4 * differing) / p.length;
  }, [one, other, side]);
}

/** The job that the page's address names. */
export const jobOf = (page) => new URLSearchParams(new URL(page.url()).hash.slice(1)).get("job");

/** The options of the job that is submitted upon an action. */
export async function submitted(page, action) {
  const [request] = await Promise.all([page.waitForRequest((one) => /\/v1\/meshes\/[0-9a-f]+\/jobs\?/.test(one.url())), action()]);
  return request.postDataJSON();
}

/** A part of a sphere above a square of n by n quads: one disk, on which maps of different lambdas differ. */
export function cap(n = 12) {
  const lines = [];
  for (let y = 0; y <= n; y += 1)
    for (let x = 0; x <= n; x += 1) {
      const [a, b] = [(2 * x) / n - 1, (2 * y) / n - 1];
      lines.push(`v ${a} ${b} ${1 - 0.6 * (a * a + b * b)}`);
    }
  for (let y = 0; y < n; y += 1)
    for (let x = 0; x < n; x += 1) {
      const v = y * (n + 1) + x + 1;
      lines.push(`f ${v} ${v + 1} ${v + n + 2} ${v + n + 1}`);
    }
  return `${lines.join("\n")}\n`;
}

/** A box of n quads along each edge: it has sharp edges alone at the edges of the box. */
export function box(n) {
  const [index, points, faces] = [new Map(), [], []];
  const at = (...p) => {
    if (!index.has(`${p}`)) index.set(`${p}`, points.push(`v ${p.join(" ")}`));
    return index.get(`${p}`);
  };
  for (const axis of [0, 1, 2])
    for (const side of [0, n])
      for (let a = 0; a < n; a += 1)
        for (let b = 0; b < n; b += 1) {
          const corner = (i, j) => at(...[0, 1, 2].map((k) => (k === axis ? side : k === (axis + 1) % 3 ? a + i : b + j)));
          const quad = [corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)];
          faces.push(`f ${(side ? quad : quad.reverse()).join(" ")}`);
        }
  return [...points, ...faces, ""].join("\n");
}

/** A door before the server that can be shut upon all who have come through it, now or after so many bytes for them. */
export async function doorTo(base) {
  const inside = new Set();
  const shut = () => inside.forEach((end) => end.destroy());
  let left = Infinity;
  const door = net.createServer((near) => {
    const far = net.connect(Number(new URL(base).port), "127.0.0.1");
    for (const end of [near, far])
      inside.add(end.on("error", () => {}).on("close", () => inside.delete(end)));
    near.pipe(far).pipe(near);
    far.on("data", ({ length }) => {
      left -= length;
      if (left < 0) shut();
      if (left < 0) left = Infinity;
    });
  });
  await new Promise((resolve) => door.listen(0, "127.0.0.1", resolve));
  const breakAfter = (bytes) => { left = bytes; };
  return { base: `http://127.0.0.1:${door.address().port}`, shut, breakAfter, broken: () => left === Infinity, close: () => (shut(), door.close()) };
}
