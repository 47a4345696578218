// The page at / of a real server in a real Chromium (CHROMIUM, else Debian's), for the tests of its
// flows. UNWRAPD is the server.
import { existsSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { fileURLToPath } from "node:url";

import { startServer } from "../contract/server.mjs";

export const binary = process.env.UNWRAPD;
const executablePath = process.env.CHROMIUM ?? "/usr/bin/chromium";
const playwright = await import("playwright-core").catch(() => undefined);
const data = process.env.UNWRAPD_TEST_DATA ?? fileURLToPath(new URL("../../../shared/data", import.meta.url));

/** Why the tests cannot run; false if they can. */
export const missing = (!existsSync(executablePath) && `there is no Chromium at ${executablePath}`) ||
  (!playwright && "tests/node_modules is missing: run npm ci in tests/");

/** WebGL without a GPU. */
const args = ["--host-resolver-rules=MAP unwrapd.test 127.0.0.1", "--no-sandbox", "--disable-quic", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"];

/** The path of a real mesh; undefined where there are none. */
export function real(name) {
  const path = join(data, name);
  return existsSync(path) ? path : undefined;
}

/** A server, a browser and a folder of files, for the tests of one file. */
export class Bench {
  folder = mkdtempSync(join(tmpdir(), "unwrapd-page-"));

  async open(flags = ["--workers", "1"]) {
    this.server = await startServer(binary, flags);
    this.browser = await playwright.chromium.launch({ executablePath, args });
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
    const context = await this.browser.newContext({ viewport: { width: 1280, height: 900 }, ...options });
    t.after(() => context.close());
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
  const png = (await page.locator(canvas).screenshot()).toString("base64");
  return page.evaluate(async (bytes) => {
    const image = new Image();
    image.src = `data:image/png;base64,${bytes}`;
    await image.decode();
    const pen = Object.assign(document.createElement("canvas"), { width: image.width, height: image.height }).getContext("2d");
    pen.drawImage(image, 0, 0);
    const { data: pixels } = pen.getImageData(6, 6, image.width - 12, image.height - 12);
    const at = (i) => (pixels[i] >> 4) * 256 + (pixels[i + 1] >> 4) * 16 + (pixels[i + 2] >> 4);
    const colours = new Set();
    let other = 0;
    for (let i = 0; i < pixels.length; i += 4) {
      colours.add(at(i));
      if (at(i) !== at(0)) other += 1;
    }
    return { share: (4 * other) / pixels.length, colours: colours.size, ground: pixels[1] };
  }, png);
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
    const images = await Promise.all([a, b].map(async (bytes) => {
      const image = new Image();
      image.src = `data:image/png;base64,${bytes}`;
      await image.decode();
      return image;
    }));
    const { width, height } = scaled ? { width: scaled, height: scaled } : images[0];
    const [p, q] = images.map((image) => {
      const pen = Object.assign(document.createElement("canvas"), { width, height }).getContext("2d");
      pen.drawImage(image, 0, 0, width, height);
      return pen.getImageData(0, 0, width, height).data;
    });
    let differing = 0;
    for (let i = 0; i < p.length; i += 4)
      if ([0, 1, 2].some((k) => Math.abs(p[i + k] - q[i + k]) > 48)) differing += 1;
    return (4 * differing) / p.length;
  }, [one, other, side]);
}
