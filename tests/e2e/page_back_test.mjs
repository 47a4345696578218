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

/** Unwraps a mesh twice, with other padding: both jobs. */
async function twoJobs(page, file) {
  await page.fill("[name=padding]", "5");
  await unwrap(page, file);
  const first = jobOf(page);
  await page.fill("[name=padding]", "7");
  await unwrap(page);
  assert.notEqual(jobOf(page), first);
  return [first, jobOf(page)];
}

describe("Back", { skip: missing }, () => {
  before(() => bench.open());
  after(() => bench.close());

  test("leads from a job to the one before, of the same mesh, and to the mesh itself", async (t) => {
    const page = await bench.visit(t);
    const [first, second] = await twoJobs(page, bench.file("cap.obj", cap()));
    assert.match(await page.inputValue("#curl"), /"padding":7/);
    await page.goBack();
    await shows(page, first);
    assert.equal(await page.locator("#mesh-name").innerText(), "cap.obj");
    assert.equal(await page.locator("#edit-seams").isDisabled(), false, "the mesh is open, so its seams can be edited");
    assert.match(await page.inputValue("#curl"), /"padding":5/, "the command is of this job");
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
    const [first] = await twoJobs(page, bench.file("cap.obj", cap()));
    await page.reload();
    await page.locator("#result").waitFor();
    await page.goBack();
    await shows(page, first);
    assert.equal(await page.locator("#opened").isVisible(), false);
    assert.equal(await page.locator("#edit-seams").isDisabled(), true);
    assert.deepEqual(page.complaints, []);
  });

  test("twice at once leads two steps back, and both jobs stay ahead", async (t) => {
    const page = await bench.visit(t);
    const [, second] = await twoJobs(page, bench.file("cap.obj", cap()));
    const entries = await page.evaluate(() => history.length);
    await page.evaluate(() => new Promise((done) => {
      addEventListener("popstate", () => setTimeout(() => done(history.back())), { once: true });
      history.back();
    }));
    await page.locator("#result").waitFor({ state: "hidden" });
    await page.waitForFunction(() => !document.querySelector("#send").disabled);
    assert.equal(new URL(page.url()).hash, "");
    assert.equal(await page.locator("#mesh-name").innerText(), "cap.obj");
    assert.equal(await page.evaluate(() => history.length), entries);
    await page.evaluate(() => history.go(2));
    await shows(page, second);
    assert.deepEqual(page.complaints, []);
  });

  test("while a job is sent leaves it to the server, and the page where Back leads", async (t) => {
    const page = await bench.visit(t);
    await unwrap(page, bench.file("cap.obj", cap()));
    const first = jobOf(page);
    await openMesh(page, bench.file("second.obj", obj(30)));
    await page.click("#send");
    await page.goBack();
    await shows(page, first);
    await page.waitForTimeout(1000);
    assert.equal(jobOf(page), first);
    assert.equal(await page.locator("#mesh-name").innerText(), "cap.obj");
  });

  test("is not undone by what a slider asked for before", async (t) => {
    const page = await bench.visit(t);
    await page.selectOption("[name=method]", "hybrid");
    const [first] = await twoJobs(page, bench.file("cap.obj", cap(60)));
    await page.evaluate(() => {
      const slider = document.querySelector("#balance");
      slider.value = slider.max;
      slider.dispatchEvent(new Event("change", { bubbles: true }));
    });
    await page.goBack();
    await shows(page, first);
    await page.waitForTimeout(1500);
    assert.equal(jobOf(page), first);
    assert.equal(await page.locator("#live").innerText(), "");
    await page.goForward();
    await page.waitForFunction((id) => location.hash.includes("job=") && !location.hash.includes(id), first);
  });

  test("to a job that is gone shows no result of another", async (t) => {
    const page = await bench.visit(t);
    const [first] = await twoJobs(page, bench.file("cap.obj", cap()));
    await fetch(`${bench.server.base}/v1/jobs/${first}`, { method: "DELETE" });
    await page.goBack();
    await page.locator("#problem", { hasText: "There is no such job here" }).waitFor();
    assert.equal(await page.locator("#edit").isVisible(), false);
    assert.equal(await page.locator("#no-layout").isVisible(), true, "the mesh has no map");
    await page.goBack();
    await page.locator("#problem").waitFor({ state: "hidden" });
    assert.equal(await page.locator("#mesh-name").innerText(), "cap.obj");
  });

  test("after a job that is refused leads to the mesh", async (t) => {
    const page = await bench.visit(t);
    await unwrap(page, bench.file("cap.obj", cap()));
    await page.fill("[name=padding]", "600");
    await page.click("#send");
    await page.locator("#problem").waitFor();
    await page.goBack();
    await page.locator("#problem").waitFor({ state: "hidden" });
    assert.equal(await page.locator("#no-layout").isVisible(), true);
  });

  test("and the link to the content leave mesh, job and address alone", async (t) => {
    const page = await bench.visit(t);
    await unwrap(page, bench.file("cap.obj", cap()));
    const address = page.url();
    await page.focus("#skip");
    await page.keyboard.press("Enter");
    assert.equal(await page.evaluate(() => document.activeElement.id), "main");
    assert.equal(page.url(), address);
    await page.evaluate(() => { location.hash = "#elsewhere"; });
    await page.waitForFunction((url) => location.href === url, address);
    assert.equal(await page.locator("#result").isVisible(), true);
    assert.equal(await page.locator("#opened").isVisible(), true);
  });

  test("has nothing in between of a packing that was cancelled", async (t) => {
    const page = await bench.visit(t);
    await unwrap(page, bench.file("cap.obj", cap(60)));
    const [first, entries] = [jobOf(page), await page.evaluate(() => history.length)];
    await page.check("#edit-islands");
    await page.click("#pack-again");
    await page.locator("#cancel").waitFor();
    await page.click("#cancel");
    await page.waitForFunction(() => !document.querySelector("#send").disabled);
    const ended = await page.locator("#problem", { hasText: "Cancelled" }).isVisible();
    assert.equal(await page.evaluate(() => history.length), entries + (ended ? 0 : 1), "else it was packed before");
    await page.goBack();
    if (!ended) await shows(page, first);
    else await page.locator("#result").waitFor({ state: "hidden" });
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
