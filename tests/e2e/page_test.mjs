// The page at / of the real server, driven in a real Chromium (CHROMIUM, else Debian's): whole jobs
// from the files that are chosen to the one that is downloaded, and what can go wrong on the way.
// UNWRAPD is the server.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { existsSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import net from "node:net";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after, before, describe, test } from "node:test";

import { startServer } from "../contract/server.mjs";
import { gltf, obj } from "../contract/meshes.mjs";

const binary = process.env.UNWRAPD;
const executablePath = process.env.CHROMIUM ?? "/usr/bin/chromium";
const playwright = await import("playwright-core").catch(() => undefined);
const folder = mkdtempSync(join(tmpdir(), "unwrapd-page-"));
const missing = (!existsSync(executablePath) && `there is no Chromium at ${executablePath}`) ||
  (!playwright && "tests/node_modules is missing: run npm ci in tests/");

/** The path of a file with these bytes. */
function file(name, bytes) {
  const path = join(folder, name);
  writeFileSync(path, bytes);
  return path;
}

/** A door before the server that can be shut upon all who have come through it. */
async function doorTo(base) {
  const inside = new Set();
  const door = net.createServer((near) => {
    const far = net.connect(Number(new URL(base).port), "127.0.0.1");
    for (const end of [near, far])
      inside.add(end.on("error", () => {}).on("close", () => inside.delete(end)));
    near.pipe(far).pipe(near);
  });
  await new Promise((resolve) => door.listen(0, "127.0.0.1", resolve));
  const shut = () => inside.forEach((end) => end.destroy());
  return { base: `http://127.0.0.1:${door.address().port}`, shut, close: () => (shut(), door.close()) };
}

describe("the page", { skip: missing }, () => {
  let server;
  let browser;

  before(async () => {
    server = await startServer(binary, ["--workers", "1"]);
    const args = ["--no-sandbox", "--disable-gpu", "--disable-quic"];
    browser = await playwright.chromium.launch({ executablePath, args });
  });

  after(async () => {
    await browser?.close();
    await server?.stop();
    rmSync(folder, { recursive: true });
  });

  /** The page of a server as a fresh visitor sees it; complaints are what its console got. */
  async function visit(t, base = server.base) {
    const page = await browser.newPage();
    t.after(() => page.close());
    page.setDefaultTimeout(60_000);
    page.complaints = [];
    page.on("pageerror", (error) => page.complaints.push(String(error)));
    page.on("console", (line) => line.type() === "error" && page.complaints.push(line.text()));
    await page.goto(`${base}/`);
    await page.locator("[name=method]").waitFor();
    return page;
  }

  async function unwrap(page, ...files) {
    await page.setInputFiles("#files", files);
    await page.click("#send");
  }

  /** [name, bytes] of what the link gives. */
  async function downloaded(page, link) {
    const [download] = await Promise.all([page.waitForEvent("download"), page.click(link)]);
    return [download.suggestedFilename(), readFileSync(await download.path(), "utf8")];
  }

  const figure = (page, name) => page.locator(`#figures div:has(dt:text-is("${name}")) dd`).textContent();
  const widths = (page) => page.evaluate(async () => {
    const images = [...document.images];
    await Promise.all(images.map((image) => image.decode()));
    return images.map((image) => image.naturalWidth);
  });

  test("takes an OBJ to its texture coordinates", async (t) => {
    const page = await visit(t);
    await page.selectOption("[name=method]", "hybrid");
    await page.fill("[name=lambda]", "0.5");
    await unwrap(page, file("grid.obj", obj(6)));
    await page.locator("#result").waitFor();
    assert.equal(await figure(page, "Charts"), "1");
    assert.equal(await figure(page, "Flipped"), "0");
    const [name, text] = await downloaded(page, "#asset");
    assert.equal(name, "grid.uv.obj");
    assert.equal(text.match(/^vt /gm).length, 49);
    const [, json] = await downloaded(page, "#report");
    const report = JSON.parse(json);
    assert.equal(await figure(page, "Angles (2 is ideal)"), report.distortion.angle.toFixed(4));
    assert.ok((await widths(page)).every((width) => width >= 256), "both pictures are there");
    assert.match(await page.locator("#iteration").textContent(), /^Iteration \d+: energy/);
    assert.deepEqual(page.complaints, []);
  });

  test("sends only what was changed, and shows only what counts", async (t) => {
    const page = await visit(t);
    const rowOf = (name) => page.locator(`label:has([name="${name}"])`);
    assert.equal(await rowOf("lambda").isVisible(), false, "arap has no lambda");
    await page.selectOption("[name=method]", "hybrid");
    assert.equal(await rowOf("lambda").isVisible(), true);
    await page.selectOption("[name=method]", "arap");
    await page.click("summary");
    await page.fill("[name='stop.iterations']", "3");
    await page.check("[name=vertex_map]");
    await page.evaluate(() => {
      const plain = window.fetch;
      window.fetch = (url, init) => {
        if (init?.body) init.body.get("options").text().then((text) => { window.sent = text; });
        return plain(url, init);
      };
    });
    await unwrap(page, file("few.obj", obj(3)));
    await page.locator("#result").waitFor();
    assert.equal(await page.evaluate(() => window.sent), '{"stop":{"iterations":3},"vertex_map":true}');
    const report = JSON.parse((await downloaded(page, "#report"))[1]);
    assert.equal(report.charts[0].iterations, 3);
  });

  test("takes a glTF with the buffers beside it, by dropping", async (t) => {
    const page = await visit(t);
    const { text, buffer } = gltf("grid.bin");
    const files = [["grid.bin", buffer], ["chair.gltf", text]].map(([name, bytes]) => [name, [...bytes]]);
    const dropped = await page.evaluateHandle((all) => {
      const data = new DataTransfer();
      for (const [name, bytes] of all) data.items.add(new File([new Uint8Array(bytes)], name));
      return data;
    }, files);
    await page.dispatchEvent("#drop", "drop", { dataTransfer: dropped });
    assert.equal(await page.locator("#chosen").textContent(), "grid.bin, chair.gltf");
    await page.click("#send");
    await page.locator("#result").waitFor();
    const [name, json] = await downloaded(page, "#asset");
    assert.equal(name, "chair.uv.gltf");
    assert.ok("TEXCOORD_0" in JSON.parse(json).meshes[0].primitives[0].attributes);
  });

  test("says what is wrong with a mesh, and goes on with the next", async (t) => {
    const page = await visit(t);
    await unwrap(page, file("broken.obj", "v 0 0 0\nv 1 0 0\nv 0 1 zero\nf 1 2 3\n"));
    const problem = page.locator("#problem");
    await problem.waitFor();
    assert.match(await problem.textContent(), /line 3.*Code: malformed_obj/s);
    assert.equal(await page.locator("#result").isVisible(), false);
    await unwrap(page, file("grid.obj", obj(4)));
    await page.locator("#result").waitFor();
    assert.equal(await problem.isVisible(), false);
  });

  test("cancels", async (t) => {
    const page = await visit(t);
    await page.click("summary");
    await page.fill("[name='stop.iterations']", "10000");
    await unwrap(page, file("large.obj", obj(150)));
    await page.locator("#iteration", { hasText: "Iteration" }).waitFor();
    await page.click("#cancel");
    await page.locator("#problem", { hasText: "cancelled" }).waitFor();
    assert.equal(await page.locator("#send").isEnabled(), true);
  });

  test("reads on where its connection was cut", async (t) => {
    const door = await doorTo(server.base);
    t.after(door.close);
    const page = await visit(t, door.base);
    const asked = [];
    page.on("request", (request) => {
      if (request.url().endsWith("/events")) asked.push(request.headers()["last-event-id"]);
    });
    await page.click("summary");
    await page.fill("[name='stop.iterations']", "10000");
    await unwrap(page, file("large.obj", obj(200)));
    await page.locator("#iteration", { hasText: "Iteration" }).waitFor();
    const again = page.waitForRequest((request) => request.url().endsWith("/events"));
    const before = await page.locator("#iteration").textContent();
    door.shut();
    await again;
    assert.ok(Number(asked.at(-1)) > 1, `after the event that it had: ${asked}`);
    await page.waitForFunction((text) => document.querySelector("#iteration").textContent !== text, before);
    await page.click("#cancel");
    await page.locator("#cancel").waitFor({ state: "hidden" });
  });

  test("asks for the key that the server wants", async (t) => {
    const locked = await startServer(binary, ["--require-keys"]);
    t.after(locked.stop);
    const key = execFileSync(binary, ["keys", "add", "--data", locked.data, "--name", "page"],
      { stdio: ["ignore", "pipe", "ignore"] }).toString().trim();
    const page = await visit(t, locked.base);
    assert.equal(await page.locator("#key").isVisible(), false);
    await unwrap(page, file("grid.obj", obj(4)));
    await page.locator("#problem", { hasText: "unauthorized" }).waitFor();
    await page.fill("#key", key);
    await page.click("#send");
    await page.locator("#result").waitFor();
    assert.ok((await widths(page)).every((width) => width >= 256), "pictures need the key as well");
    assert.ok(!page.url().includes(key));
  });
});
