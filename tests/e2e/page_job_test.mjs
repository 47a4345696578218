// Jobs from the page: options, progress, ends of every kind, keys, and addresses that lead back.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { after, before, describe, test } from "node:test";

import { obj } from "../contract/meshes.mjs";
import { startServer } from "../contract/server.mjs";
import { Bench, binary, cap, doorTo, downloaded, figure, jobOf, missing, openMesh, submitted, unwrap } from "./page.mjs";

const bench = new Bench();

/** Opens a mesh whose job takes long, and waits until it iterates. */
async function unwrapForLong(page, side) {
  await page.check("#preset-chart");
  await page.click("#form summary");
  await page.fill("[name='stop.iterations']", "10000");
  await openMesh(page, bench.file("large.obj", obj(side)));
  await page.click("#send");
  await page.locator("#iteration", { hasText: "Iteration" }).waitFor();
}

describe("a job of the page", { skip: missing }, () => {
  before(() => bench.open());
  after(() => bench.close());

  test("takes an OBJ to its texture coordinates", async (t) => {
    const page = await bench.visit(t);
    await page.selectOption("[name=method]", "hybrid");
    await page.fill("#lambda", "0.5");
    await unwrap(page, bench.file("grid.obj", obj(6)));
    assert.equal(await page.evaluate(() => document.activeElement.id), "result-title", "focus goes to what is new");
    assert.equal(await figure(page, "Charts"), "1");
    assert.equal(await figure(page, "Flipped triangles"), "0");
    const [name, text] = await downloaded(page, "#downloads .primary");
    assert.equal(name, "grid.uv.obj");
    assert.equal(text.toString().match(/^vt /gm).length, 49);
    const [, json] = await downloaded(page, "#downloads :text('Report')");
    const report = JSON.parse(json);
    assert.equal(await figure(page, "Angles"), report.distortion.angle.toFixed(4));
    assert.equal(await page.locator("#iteration").innerText(), "", "no line of a chart stays beside the figures of all");
    assert.equal(await page.locator("#status").innerText(), "Done: 1 chart.");
    assert.deepEqual(page.complaints, []);
    assert.deepEqual(page.elsewhere, []);
  });

  test("has the options that were changed, and shows what the method has", async (t) => {
    const page = await bench.visit(t);
    const balance = page.locator("#balance-row");
    assert.equal(await balance.isVisible(), false, "arap has no lambda");
    await page.selectOption("[name=method]", "hybrid");
    assert.equal(await balance.isVisible(), true);
    await page.selectOption("[name=method]", "arap");
    await page.click("#form summary");
    await page.fill("[name='stop.iterations']", "3");
    await page.check("[name=vertex_map]");
    await openMesh(page, bench.file("few.obj", obj(3)));
    assert.deepEqual(await submitted(page, () => page.click("#send")), { stop: { iterations: 3 }, vertex_map: true });
    await page.locator("#result").waitFor();
    const report = JSON.parse((await downloaded(page, "#downloads :text('Report')"))[1]);
    assert.equal(report.charts[0].iterations, 3);
  });

  test("of a preset shows and sends what it sets", async (t) => {
    const page = await bench.visit(t);
    await page.check("#preset-lightmap");
    assert.equal(await page.inputValue("[name=padding]"), "4");
    await page.fill("[name=resolution]", "512");
    await openMesh(page, bench.file("few.obj", obj(3)));
    assert.deepEqual(await submitted(page, () => page.click("#send")), { preset: "lightmap", resolution: 512 });
  });

  test("of several lambdas keeps the comma, and shows one map for each", async (t) => {
    const page = await bench.visit(t);
    await page.selectOption("[name=method]", "hybrid");
    await page.fill("#lambda", "1,0.1");
    await openMesh(page, bench.file("cap.obj", cap()));
    assert.deepEqual((await submitted(page, () => page.click("#send"))).lambda, [1, 0.1]);
    await page.locator("#result").waitFor();
    assert.deepEqual(await page.locator("#lambda-shown option").allInnerTexts(), ["1", "0.1"]);
    await page.selectOption("#lambda-shown", "0.1");
    await page.waitForFunction(() => !document.querySelector("#send").disabled);
    const id = jobOf(page);
    const { distortion } = await (await fetch(`${bench.server.base}/v1/jobs/${id}/report?lambda=0.1`)).json();
    assert.equal(await figure(page, "Angles"), distortion.angle.toFixed(4));
    const [, json] = await downloaded(page, "#downloads :text('Report')");
    assert.deepEqual(JSON.parse(json).distortion, distortion);
  });

  test("is not made of a lambda that is none, and the page says why", async (t) => {
    const page = await bench.visit(t);
    await page.selectOption("[name=method]", "hybrid");
    await page.fill("#lambda", "0.1, much");
    assert.match(await page.locator("#lambda-problem").innerText(), /“much” is not one/);
    await openMesh(page, bench.file("few.obj", obj(3)));
    await page.click("#send");
    await page.locator("#problem", { hasText: "λ must be a number" }).waitFor();
  });

  test("that fails says why, and the next goes on", async (t) => {
    const page = await bench.visit(t);
    await page.click("#form summary");
    await page.fill("[name=texels_per_unit]", "1e9");
    await openMesh(page, bench.file("grid.obj", obj(4)));
    await page.click("#send");
    const problem = page.locator("#problem");
    await problem.waitFor();
    assert.match(await problem.innerText(), /Code: does_not_fit/);
    assert.equal(await page.locator("#result").isVisible(), false);
    await page.fill("[name=texels_per_unit]", "");
    await unwrap(page);
    assert.equal(await problem.isVisible(), false);
  });

  test("that is cancelled ends calmly", async (t) => {
    const page = await bench.visit(t);
    await unwrapForLong(page, 150);
    assert.match(await page.locator("#energy").getAttribute("d"), /^M/);
    await page.click("#cancel");
    const message = page.locator("#problem.calm", { hasText: "Cancelled" });
    await message.waitFor();
    assert.doesNotMatch(await message.innerText(), /error|code|could not/i);
    assert.equal(await page.locator("#send").isEnabled(), true);
  });

  test("tells how much of the mesh is sent, and cancelled then leaves the job before alone", async (t) => {
    const page = await bench.visit(t);
    await unwrap(page, bench.file("grid.obj", obj(4)));
    const first = jobOf(page);
    const cdp = await page.context().newCDPSession(page);
    await openMesh(page, bench.file("large.obj", obj(150)));
    await cdp.send("Network.emulateNetworkConditions", { offline: false, latency: 0, downloadThroughput: -1, uploadThroughput: 100_000 });
    await page.click("#send");
    await page.locator("#status", { hasText: /Sending the mesh: [1-9]\d? %/ }).waitFor();
    await Promise.all([page.waitForEvent("requestfailed", (one) => one.method() === "PUT"), page.click("#cancel")]);
    await page.locator("#problem.calm", { hasText: "Cancelled" }).waitFor();
    assert.equal((await fetch(`${bench.server.base}/v1/jobs/${first}`)).status, 200);
  });

  test("cancelled before the mesh is sent sends nothing", async (t) => {
    const page = await bench.visit(t);
    const uploads = [];
    page.on("request", (request) => request.method() === "PUT" && uploads.push(request.url()));
    await page.evaluate(() => {
      const digest = crypto.subtle.digest.bind(crypto.subtle);
      crypto.subtle.digest = async (...given) => {
        await new Promise((go) => { window.go = go; });
        return digest(...given);
      };
    });
    await openMesh(page, bench.file("grid.obj", obj(4)));
    await page.click("#send");
    await page.click("#cancel");
    await page.evaluate(() => window.go());
    await page.locator("#problem.calm", { hasText: "Cancelled" }).waitFor();
    await page.evaluate(() => fetch("healthz"));
    assert.deepEqual(uploads, []);
  });

  test("is downloaded again where the connection breaks within", async (t) => {
    const door = await doorTo(bench.server.base);
    t.after(door.close);
    const page = await bench.visit(t, { base: door.base });
    await unwrap(page, bench.file("grid.obj", obj(60)));
    door.breakAfter(20_000);
    const [, bytes] = await downloaded(page, "#downloads .primary");
    assert.equal(bytes.toString().match(/^vt /gm).length, 61 * 61);
    assert.equal(door.broken(), true);
    assert.equal(await page.locator("#problem").isVisible(), false);
  });

  test("is read on where its connection was cut", async (t) => {
    const door = await doorTo(bench.server.base);
    t.after(door.close);
    const page = await bench.visit(t, { base: door.base });
    const asked = [];
    page.on("request", (request) => {
      if (request.url().endsWith("/events")) asked.push(request.headers()["last-event-id"]);
    });
    await unwrapForLong(page, 200);
    const again = page.waitForRequest((request) => request.url().endsWith("/events"));
    const before = await page.locator("#iteration").textContent();
    door.shut();
    await again;
    assert.ok(Number(asked.at(-1)) > 1, `after the event that it had: ${asked}`);
    await page.waitForFunction((text) => document.querySelector("#iteration").textContent !== text, before);
    await page.click("#cancel");
    await page.locator("#cancel").waitFor({ state: "hidden" });
  });

  test("is there again after a reload, while it runs and when it is done", async (t) => {
    const page = await bench.visit(t);
    await unwrapForLong(page, 150);
    const id = jobOf(page);
    await page.reload();
    await page.locator("#iteration", { hasText: "Iteration" }).waitFor();
    await page.click("#cancel");
    await page.locator("#problem.calm").waitFor();
    assert.ok(page.url().includes(id));
    await unwrap(page, bench.file("grid.obj", obj(4)));
    const charts = await figure(page, "Angles");
    await page.reload();
    await page.locator("#result").waitFor();
    assert.equal(await figure(page, "Angles"), charts);
    assert.equal((await downloaded(page, "#downloads .primary"))[0], "grid.uv.obj");
    assert.deepEqual(page.complaints, []);
  });

  test("that is gone is said to be", async (t) => {
    const page = await bench.visit(t, { hash: `#job=j_${"0".repeat(32)}&name=x.obj` });
    await page.locator("#problem", { hasText: "There is no such job here" }).waitFor();
  });

  test("is in the list, which leads to it", async (t) => {
    const page = await bench.visit(t);
    await unwrap(page, bench.file("listed.obj", obj(5)));
    const id = jobOf(page);
    await page.goto(`${bench.server.base}/`);
    await page.locator("#option-method").waitFor();
    await page.click("#jobs summary");
    await page.click(`#job-list a[href*="${id}"]`);
    await page.locator("#result").waitFor();
    assert.ok(page.url().includes(id));
  });

  test("of another mesh takes the place of the mesh that is open", async (t) => {
    const page = await bench.visit(t);
    await page.selectOption("[name=method]", "hybrid");
    await page.fill("#lambda", "1, 0.1");
    await unwrap(page, bench.file("first.obj", cap()));
    const first = jobOf(page);
    assert.equal(await page.locator("#lambda-row").isVisible(), true);
    await page.fill("#lambda", "0.1");
    await unwrap(page, bench.file("second.obj", obj(5)));
    assert.equal(await page.locator("#lambda-row").isVisible(), false, "one lambda needs no choice");
    await page.evaluate((job) => { location.hash = `#job=${job}&name=first.obj`; }, first);
    await page.locator("#lambda-row").waitFor();
    await page.locator("#result").waitFor();
    assert.equal(await page.locator("#opened").isVisible(), false, "the mesh of before is not open any more");
    assert.equal(await page.locator("#edit").isVisible(), false, "nor can it be edited");
    assert.equal(await page.locator("#versions").isVisible(), false);
    await page.click("#send");
    await page.locator("#problem", { hasText: "There is no mesh yet" }).waitFor();
    assert.ok(page.url().includes(first));
  });

  test("that runs is left alone when another mesh is opened", async (t) => {
    const page = await bench.visit(t);
    await unwrapForLong(page, 150);
    const job = jobOf(page);
    await openMesh(page, bench.file("next.obj", obj(3)));
    assert.equal(await page.locator("#send").isEnabled(), true);
    assert.equal(await page.locator("#cancel").isVisible(), false);
    assert.equal(await page.locator("#problem").isVisible(), false);
    assert.equal((await (await fetch(`${bench.server.base}/v1/jobs/${job}`)).json()).state, "running");
    await fetch(`${bench.server.base}/v1/jobs/${job}`, { method: "DELETE" });
    await page.fill("[name='stop.iterations']", "");
    await unwrap(page);
    assert.equal(await page.locator("#problem").isVisible(), false);
    assert.equal(await page.locator("#mesh-name").innerText(), "next.obj");
  });

  test("works where the browser calls the address insecure", async (t) => {
    const far = await startServer(binary, ["--allowed-hosts", "unwrapd.test"]);
    t.after(far.stop);
    const page = await bench.visit(t, { base: far.base.replace("127.0.0.1", "unwrapd.test") });
    assert.equal(await page.evaluate(() => isSecureContext), false);
    await unwrap(page, bench.file("grid.obj", obj(6)));
    assert.equal(await figure(page, "Charts"), "1");
    await page.click("#result summary:has-text('Share')");
    await page.click("#copy-curl");
    assert.equal(await page.evaluate(() => document.activeElement.id), "curl", "the text is selected for copying by hand");
    assert.deepEqual(page.complaints, []);
  });

  test("asks for the key that the server wants", async (t) => {
    const locked = await startServer(binary, ["--require-keys"]);
    t.after(locked.stop);
    const key = execFileSync(binary, ["keys", "add", "--data", locked.data, "--name", "page"],
      { stdio: ["ignore", "pipe", "ignore"] }).toString().trim();
    const page = await bench.visit(t, { base: locked.base });
    await openMesh(page, bench.file("grid.obj", obj(4)));
    assert.equal(await page.locator("#key").isVisible(), false);
    await page.click("#send");
    await page.locator("#problem", { hasText: "A key is needed" }).waitFor();
    assert.equal(await page.evaluate(() => document.activeElement.id), "key");
    await page.keyboard.type(key);
    await page.click("#retry");
    await page.locator("#result").waitFor();
    assert.equal((await downloaded(page, "#downloads .primary"))[0], "grid.uv.obj");
    await page.click("#jobs summary");
    await page.locator("#job-list a").waitFor();
    assert.ok(!page.url().includes(key));
    await page.reload();
    await page.locator("#problem", { hasText: "A key is needed" }).waitFor();
    await page.keyboard.type(key);
    await page.keyboard.press("Enter");
    await page.locator("#result").waitFor();
    assert.equal(await page.evaluate(() => localStorage.length + sessionStorage.length), 0);
  });
});
