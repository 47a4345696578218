// Back and Forward of the browser: they lead to the meshes and the jobs that were open.
import assert from "node:assert/strict";
import { after, before, describe, test } from "node:test";

import { obj } from "../contract/meshes.mjs";
import { Bench, cap, jobOf, missing, openMesh, unwrap } from "./page.mjs";

const bench = new Bench();

/** Waits until the page shows the result of a job. */
async function shows(page, job) {
  await page.waitForFunction((id) => location.hash.includes(id), job);
  await page.waitForFunction(() => !document.querySelector("#send").disabled);
  await page.locator("#result").waitFor();
}

describe("Back", { skip: missing }, () => {
  before(() => bench.open());
  after(() => bench.close());

  test("leads from a job to the one before, of the same mesh, and to the mesh itself", async (t) => {
    const page = await bench.visit(t);
    await unwrap(page, bench.file("cap.obj", cap()));
    const first = jobOf(page);
    await page.fill("[name=padding]", "7");
    await unwrap(page);
    const second = jobOf(page);
    assert.notEqual(second, first);
    await page.goBack();
    await shows(page, first);
    assert.equal(await page.locator("#mesh-name").innerText(), "cap.obj");
    assert.equal(await page.locator("#edit-seams").isDisabled(), false, "the mesh is open, so its seams can be edited");
    assert.equal(await page.locator("#curl-row").isVisible(), false, "a command would be of the options of another job");
    await page.goBack();
    await page.locator("#result").waitFor({ state: "hidden" });
    assert.equal(await page.locator("#opened").isVisible(), true);
    await page.goForward();
    await shows(page, first);
    await page.goForward();
    await shows(page, second);
    assert.deepEqual(page.complaints, []);
  });

  test("leads to the mesh before, with its job, and from the first mesh to the start", async (t) => {
    const page = await bench.visit(t);
    await unwrap(page, bench.file("first.obj", cap()));
    const job = jobOf(page);
    await openMesh(page, bench.file("second.obj", obj(4)));
    assert.equal(new URL(page.url()).hash, "");
    await page.goBack();
    await shows(page, job);
    assert.equal(await page.locator("#mesh-name").innerText(), "first.obj");
    await page.goBack();
    await page.locator("#result").waitFor({ state: "hidden" });
    assert.equal(await page.locator("#mesh-name").innerText(), "first.obj");
    await page.goBack();
    await page.locator("#opened").waitFor({ state: "hidden" });
    assert.equal(await page.locator("#views").isVisible(), false);
    assert.equal(await page.locator("#edit").isVisible(), false);
    await page.goForward();
    await page.locator("#opened").waitFor();
    assert.equal(await page.locator("#mesh-name").innerText(), "first.obj");
    assert.deepEqual(page.complaints, []);
  });

  test("after a reload leads to the result, whose mesh is not open any more", async (t) => {
    const page = await bench.visit(t);
    await unwrap(page, bench.file("cap.obj", cap()));
    const first = jobOf(page);
    await page.fill("[name=padding]", "7");
    await unwrap(page);
    await page.reload();
    await page.locator("#result").waitFor();
    await page.goBack();
    await shows(page, first);
    assert.equal(await page.locator("#opened").isVisible(), false);
    assert.equal(await page.locator("#edit-seams").isDisabled(), true);
    assert.deepEqual(page.complaints, []);
  });

  test("does not step through the maps that a slider was dragged over", async (t) => {
    const page = await bench.visit(t);
    await page.selectOption("[name=method]", "hybrid");
    await unwrap(page, bench.file("cap.obj", cap()));
    const entries = await page.evaluate(() => history.length);
    const before = jobOf(page);
    await page.evaluate(() => {
      const slider = document.querySelector("#balance");
      for (const value of [0.2, 0.4]) {
        slider.value = Number(slider.min) + value * (slider.max - slider.min);
        slider.dispatchEvent(new Event("input", { bubbles: true }));
      }
      slider.dispatchEvent(new Event("change", { bubbles: true }));
    });
    await page.waitForFunction((id) => location.hash.includes("job=") && !location.hash.includes(id), before);
    assert.equal(await page.evaluate(() => history.length), entries);
  });
});
