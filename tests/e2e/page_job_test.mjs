// Jobs from the page: options, progress, ends of every kind, and addresses that lead back.
import assert from "node:assert/strict";
import { after, before, describe, test } from "node:test";

import { obj } from "../contract/meshes.mjs";
import { Bench, cap, downloaded, figure, jobOf, missing, openMesh, submitted, unwrap, unwrapForLong } from "./page.mjs";

const bench = new Bench();

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

  test("shows the flips that the report counts, although the file winds every fourth quad the other way", async (t) => {
    const page = await bench.visit(t);
    let quads = 0;
    const lines = cap(16).split("\n").map((line) => {
      if (line.startsWith("v")) return line.replace(/\S+$/, (z) => 15 * z);
      const [word, ...corners] = line.split(" ");
      return word === "f" && (quads += 1) % 4 === 0 ? ["f", ...corners.reverse()].join(" ") : line;
    });
    await page.click("#form summary");
    await page.check("#preset-paper"); // the map of so deep a bowl has folds
    await unwrap(page, bench.file("bowl.obj", lines.join("\n")));
    const flipped = Number(await figure(page, "Flipped triangles"));
    assert.ok(flipped > 20, `${flipped} of 512 are flipped`);
    assert.match(await page.locator("#charts li").textContent(), new RegExp(`^Chart 1 512 triangles,.*, ${flipped} flipped triangles$`));
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
    await page.fill("#lambda", "0.2");
    await unwrap(page);
    assert.equal(await page.locator("#lambdas-row").isVisible(), false);
  });

  test("of several lambdas shows the maps beside each other, and each in the views", async (t) => {
    const page = await bench.visit(t);
    await page.selectOption("[name=method]", "hybrid");
    await page.fill("#lambda", "0.001, 0.1, 100");
    await unwrap(page, bench.file("cap.obj", cap()));
    const reports = await Promise.all([0.001, 0.1, 100].map(async (lambda) =>
      (await fetch(`${bench.server.base}/v1/jobs/${jobOf(page)}/report?lambda=${lambda}`)).json()));
    assert.deepEqual(await page.locator("#lambdas button").allInnerTexts(), reports.map(({ distortion: { angle, area } }, i) =>
      `λ ${[0.001, 0.1, 100][i]}: angles ${angle.toFixed(3)}, areas ${area.toFixed(3)}`));
    await page.waitForFunction(() => [...document.querySelectorAll("#lambdas img")].every((image) => image.naturalWidth === 320));
    const sources = await page.evaluate(() => Promise.all([...document.querySelectorAll("#lambdas img")].map(async ({ src }) => (await (await fetch(src)).text()))));
    assert.equal(new Set(sources).size, 6, "each picture is of a map of its own");
    assert.equal(await page.locator("#lambdas button").first().getAttribute("aria-pressed"), "true");
    await page.click("#lambdas button >> nth=2");
    await page.waitForFunction(() => !document.querySelector("#send").disabled);
    assert.equal(await figure(page, "Angles"), reports[2].distortion.angle.toFixed(4));
    assert.equal(await page.inputValue("#lambda-shown"), "100");
    assert.equal(await page.locator("#lambdas button >> nth=2").getAttribute("aria-pressed"), "true");
    assert.deepEqual(page.complaints, []);
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
    await unwrapForLong(page, bench.file("large.obj", obj(150)));
    assert.match(await page.locator("#energy").getAttribute("d"), /^M/);
    await page.click("#cancel");
    const message = page.locator("#problem.calm", { hasText: "Cancelled" });
    await message.waitFor();
    assert.doesNotMatch(await message.innerText(), /error|code|could not/i);
    assert.equal(await page.locator("#send").isEnabled(), true);
  });

  test("draws the curve of its energy once for each picture", async (t) => {
    const page = await bench.visit(t);
    await page.check("#preset-chart");
    await page.click("#form summary");
    await page.fill("[name='stop.iterations']", "3000");
    await page.evaluate(() => {
      window.drawn = new Map();
      let frame = 0;
      const next = () => requestAnimationFrame(() => { frame += 1; next(); });
      next();
      const energy = document.getElementById("energy");
      const set = energy.setAttribute.bind(energy);
      energy.setAttribute = (...given) => {
        window.drawn.set(frame, (window.drawn.get(frame) ?? 0) + 1);
        set(...given);
      };
    });
    await unwrap(page, bench.file("small.obj", obj(4)));
    const counts = await page.evaluate(() => [...window.drawn.values()]);
    assert.ok(counts.length > 1, "it is drawn");
    assert.ok(Math.max(...counts) <= 2, `${Math.max(...counts)} times in one picture`); // 2: a new job clears it
  });

  test("is there again after a reload, while it runs and when it is done", async (t) => {
    const page = await bench.visit(t);
    await unwrapForLong(page, bench.file("large.obj", obj(150)));
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

  test("whose address was cut off is said to be", async (t) => {
    const page = await bench.visit(t, { hash: "#job=j_0123" });
    await page.locator("#problem", { hasText: "This address names no job" }).waitFor();
    assert.deepEqual(page.complaints, []);
  });

  test("is in the list, which leads to it", async (t) => {
    const page = await bench.visit(t);
    await unwrap(page, bench.file("listed.obj", obj(5)));
    const id = jobOf(page);
    await page.goto(`${bench.server.base}/`);
    await page.locator("#option-method").waitFor();
    await page.click("#jobs summary");
    assert.equal(await page.locator(`#job-list a[href*="${id}"]`).innerText(), "listed.obj");
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
    assert.equal(await page.locator("#edit-seams").isDisabled(), true, "nor can its seams be edited");
    assert.equal(await page.locator("#versions").isVisible(), false);
    await page.click("#send");
    await page.locator("#problem", { hasText: "There is no mesh yet" }).waitFor();
    assert.ok(page.url().includes(first));
  });

  test("that runs is left alone when another mesh is opened", async (t) => {
    const page = await bench.visit(t);
    await unwrapForLong(page, bench.file("large.obj", obj(150)));
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
});
