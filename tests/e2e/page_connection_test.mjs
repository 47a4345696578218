// The page and its server: uploads, connections that break, addresses that are not secure, and keys.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { after, before, describe, test } from "node:test";

import { obj } from "../contract/meshes.mjs";
import { startServer } from "../contract/server.mjs";
import { Bench, binary, doorTo, downloaded, figure, jobOf, missing, openMesh, real, unwrap, unwrapForLong } from "./page.mjs";

const bench = new Bench();

describe("a job of the page", { skip: missing }, () => {
  before(() => bench.open());
  after(() => bench.close());

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

  const tree = real("gltf/sharpgltf/tests/Assets/tree.glb");
  test("offers its materials by its address, too, and tells where they cannot be read", { skip: !tree && "the test data is missing" }, async (t) => {
    const page = await bench.visit(t);
    await unwrap(page, tree);
    const again = await bench.visit(t, { hash: `#job=${jobOf(page)}&name=tree.glb` });
    await again.locator("#result").waitFor();
    assert.equal(await again.locator("#colouring option[value=materials]").isDisabled(), false);
    const gone = { code: "result_expired", title: "Gone", status: 410, detail: "The result is gone." };
    await again.route(/\/result(\?|$)/, (route) => route.fulfill({ status: 410, contentType: "application/problem+json", body: JSON.stringify(gone) }));
    await again.selectOption("#colouring", "materials");
    await again.locator("#problem", { hasText: "The result is gone." }).waitFor();
    await unwrap(again, bench.file("plain.obj", obj(2)));
    assert.equal(await again.locator("#colouring").inputValue(), "checker", "an OBJ has none");
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
    await unwrapForLong(page, bench.file("large.obj", obj(200)));
    const again = page.waitForRequest((request) => request.url().endsWith("/events"));
    const before = await page.locator("#iteration").textContent();
    door.shut();
    await again;
    assert.ok(Number(asked.at(-1)) > 1, `after the event that it had: ${asked}`);
    await page.waitForFunction((text) => document.querySelector("#iteration").textContent !== text, before);
    await page.click("#cancel");
    await page.locator("#cancel").waitFor({ state: "hidden" });
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
