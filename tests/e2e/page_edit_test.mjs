// Edits by hand: seams along edges, pins in the layout, and the balance that is dragged.
import assert from "node:assert/strict";
import { after, before, describe, test } from "node:test";

import { Bench, box, cap, difference, figure, jobOf, missing, openMesh, real, shot, submitted, unwrap } from "./page.mjs";

const bench = new Bench();

describe("by hand", { skip: missing }, () => {
  before(() => bench.open());
  after(() => bench.close());

  const resultOf = async (page) => (await fetch(`${bench.server.base}/v1/jobs/${jobOf(page)}/result.json`)).json();

  /** Clicks a share of a canvas's width and height. */
  async function clickAt(page, canvas, x, y) {
    const { width, height } = await page.locator(canvas).boundingBox();
    await page.click(canvas, { position: { x: x * width, y: y * height } });
  }

  test("seams are marked from click to click, and cut where they run", async (t) => {
    const page = await bench.visit(t);
    await page.check("#preset-chart");
    await unwrap(page, bench.file("cap.obj", cap()));
    await page.check("#edit-seams");
    const bare = await shot(page, "#solid");
    await clickAt(page, "#solid", 0.4, 0.5);
    await page.locator("#seam-count", { hasText: "No edges marked. A path begins here. Click where it shall lead." }).waitFor();
    await clickAt(page, "#solid", 0.6, 0.5);
    await page.locator("#seam-count", { hasText: /[1-9]\d* edges? marked in 1 path/ }).waitFor();
    await page.mouse.move(5, 5);
    assert.ok(await difference(page, await shot(page, "#solid"), bare) > 0.0003, "the marks are seen");
    const edges = Number((await page.locator("#seam-count").innerText()).match(/^\d+/)[0]);
    const { seam_edges: sent } = await submitted(page, () => page.click("#send"));
    assert.equal(sent.reduce((sum, { vertices }) => sum + vertices.length - 1, 0), edges);
    await page.waitForFunction(() => !document.querySelector("#send").disabled);
    const { meshes: [{ vertex_map: map, positions }] } = await resultOf(page);
    const split = map.filter((v, i) => map.indexOf(v) !== i);
    assert.ok(split.length > 0 && split.every((v) => sent[0].vertices.includes(v)), "vertices of the path alone are split");
    assert.ok(positions.length > 0);
    await page.click("#seam-undo");
    assert.match(await page.locator("#seam-count").innerText(), /^No edges marked/);
  });

  test("an edge becomes a ring, which splits the surface", async (t) => {
    const page = await bench.visit(t);
    await page.check("#preset-chart");
    await unwrap(page, bench.file("cap.obj", cap()));
    assert.equal(await figure(page, "Charts"), "1");
    await page.check("#edit-seams");
    await clickAt(page, "#solid", 0.42, 0.5);
    await clickAt(page, "#solid", 0.58, 0.5);
    await page.click("#seam-ring");
    assert.match(await page.locator("#seam-count").innerText(), /in 3 paths/);
    await page.click("#send");
    await page.waitForFunction(() => document.querySelector("#figures dd")?.firstChild.textContent === "2");
  });

  const marked = async (page) => Number((await page.locator("#seam-count").innerText()).match(/^\d+/)?.[0] ?? 0);

  test("all creases are marked at once, and cut into the sides of a box", async (t) => {
    const page = await bench.visit(t);
    await unwrap(page, bench.file("box.obj", box(4)));
    await page.check("#edit-seams");
    await page.uncheck("#keep-charts");
    await page.fill("#crease-angle", "91");
    await page.click("#seam-creases");
    assert.equal(await marked(page), 0, "a box bends by 90 degrees");
    assert.match(await page.locator("#announcement").textContent(), /no edge that sharp/);
    await page.fill("#crease-angle", "80");
    await page.click("#seam-creases");
    assert.match(await page.locator("#seam-count").innerText(), /^48 edges marked in 12 paths/);
    const { seam_edges: edges } = await submitted(page, () => page.click("#send"));
    assert.equal(edges.length, 12);
    await page.waitForFunction(() => document.querySelector("#figures dd")?.firstChild.textContent === "6");
    await page.click("#seam-undo");
    assert.equal(await marked(page), 0, "what was one click is undone by one");
  });

  test("a crease is followed from one of its edges to where it forks", async (t) => {
    const page = await bench.visit(t);
    const ridge = cap(8).replace(/^v (\S+) (\S+) \S+/gm, (_, x, y) => `v ${x} ${y} ${-Math.abs(x)}`);
    await page.check("#preset-chart");
    await unwrap(page, bench.file("ridge.obj", ridge));
    await page.check("#edit-seams");
    await page.click("#seam-crease");
    assert.match(await page.locator("#announcement").textContent(), /Mark an edge of a crease first/);
    await clickAt(page, "#solid", 0.436, 0.543); // (0, 0, 0)
    await clickAt(page, "#solid", 0.436, 0.469);
    assert.equal(await marked(page), 1);
    await page.click("#seam-crease");
    assert.equal(await marked(page), 8, "the whole ridge");
  });

  test("marks are made by keyboard, at the middle of the view", async (t) => {
    const page = await bench.visit(t);
    await page.check("#preset-chart");
    await unwrap(page, bench.file("cap.obj", cap(10)));
    await page.check("#edit-seams");
    await page.focus("#solid");
    await page.keyboard.press("Enter");
    for (let turns = 0; turns < 3; turns += 1) await page.keyboard.press("ArrowRight");
    await page.keyboard.press("Enter");
    await page.locator("#seam-count", { hasText: "marked in 1 path" }).waitFor();
    const { vertices } = (await submitted(page, () => page.click("#send"))).seam_edges[0];
    // From (0.45, 0.35, 1) towards (0, 0, 0.4) the eye meets the cap at (0.24, 0.19): next to (0.2, 0.2).
    assert.equal(vertices[0], 6 * 11 + 6);
    const places = vertices.map((v) => [v % 11, Math.floor(v / 11)]);
    places.slice(1).forEach(([x, y], i) =>
      assert.ok(Math.abs(x - places[i][0]) <= 1 && Math.abs(y - places[i][1]) <= 1, "each step is an edge"));
  });

  /** A visitor who has unwrapped the cap and holds two of its vertices. */
  async function visitWithTwoPins(t) {
    const page = await bench.visit(t);
    await page.check("#preset-chart");
    await unwrap(page, bench.file("cap.obj", cap()));
    await page.check("#edit-pins");
    await clickAt(page, "#flat", 0.3, 0.5);
    await clickAt(page, "#flat", 0.7, 0.5);
    return page;
  }

  test("a pin that is dragged takes the map along", async (t) => {
    const page = await visitWithTwoPins(t);
    assert.equal(await page.locator("#pin-list li").count(), 2);
    const [u, v] = [await page.inputValue("#pin-1-U"), await page.inputValue("#pin-1-V")].map(Number);
    const { x, y, width, height } = await page.locator("#flat").boundingBox();
    const at = (a, b) => [x + width * (0.5 + (a - 0.5) / 1.06), y + height * (0.5 - (b - 0.5) / 1.06)];
    await page.mouse.move(...at(u, v));
    await page.mouse.down();
    await page.mouse.move(...at(u + 0.1, v + 0.1), { steps: 4 });
    const { constraints } = await submitted(page, () => page.mouse.up());
    assert.ok(Math.abs(constraints[1].uv[0] - u - 0.1) < 0.02 && Math.abs(constraints[1].uv[1] - v - 0.1) < 0.02, JSON.stringify(constraints));
    await page.locator("#live", { hasText: "Pins: angles" }).waitFor();
    const { meshes: [{ uv, vertex_map: map }] } = await resultOf(page);
    for (const { vertex, uv: wanted } of constraints) {
      const i = map.indexOf(vertex);
      for (const k of [0, 1]) assert.ok(Math.abs(uv[2 * i + k] - wanted[k]) < 1e-4, `vertex ${vertex} is at its pin`);
    }
  });

  test("a pin is moved by numbers, and one that cannot hold is explained", async (t) => {
    const page = await visitWithTwoPins(t);
    const options = await submitted(page, () => page.fill("#pin-0-U", "0.1").then(() => page.keyboard.press("Tab")));
    assert.equal(options.constraints[0].uv[0], 0.1);
    await page.locator("#live", { hasText: "Pins: angles" }).waitFor();
    for (const field of ["#pin-0-U", "#pin-0-V", "#pin-1-U", "#pin-1-V"]) await page.fill(field, "0.5");
    await page.keyboard.press("Tab");
    await page.locator("#live", { hasText: /Pins: .*constraint/ }).waitFor();
    await page.click("#pin-list button >> nth=0");
    assert.equal(await page.locator("#pin-list li").count(), 1);
  });

  const disk = real("disk/demosthenes-low-res.obj");
  test("the map follows the slider: 50 moves, and the last is what is shown", { skip: !disk && "the test data is missing" }, async (t) => {
    const page = await bench.visit(t);
    await page.check("#preset-chart");
    await page.selectOption("[name=method]", "hybrid");
    await unwrap(page, disk);
    const { pictures, last } = await page.evaluate(async () => {
      const [slider, live] = ["balance", "live"].map((id) => document.getElementById(id));
      const pictures = [];
      new MutationObserver(() => pictures.push(Number(live.dataset.ms))).observe(live, { childList: true });
      for (let i = 0; i < 50; i += 1) {
        slider.value = String(20 + i);
        slider.dispatchEvent(new Event("input"));
        await new Promise((done) => setTimeout(done, 50));
        while (i === 25 && pictures.length === 0) await new Promise((done) => setTimeout(done, 50));
      }
      slider.dispatchEvent(new Event("change"));
      return { pictures, last: document.getElementById("lambda").value };
    });
    await page.locator("#live", { hasText: new RegExp(`^λ ${last}: angles [\\d.]+, areas [\\d.]+\\.$`) }).waitFor();
    const { options, distortion } = await (await fetch(`${bench.server.base}/v1/jobs/${jobOf(page)}/report`)).json();
    assert.equal(options.lambda, Number(last));
    assert.equal(await figure(page, "Angles"), distortion.angle.toFixed(4));
    assert.ok(pictures.length > 0, "the map is seen on the way");
    const { jobs } = await (await fetch(`${bench.server.base}/v1/jobs?limit=200`)).json();
    const drafts = jobs.filter((job) => job.options.guarantee === "none");
    assert.deepEqual(drafts.map(({ id }) => id), [], "drafts are removed");
    t.diagnostic(`thumb to picture, ms: ${pictures.join(" ")}`);
    assert.deepEqual(page.complaints, []);
  });

  test("a draft is read from its file, and looks like the result that follows", async (t) => {
    const page = await bench.visit(t);
    await page.check("#preset-chart");
    await page.selectOption("[name=method]", "hybrid");
    await page.fill("#lambda", "0");
    await unwrap(page, bench.file("cap.obj", cap()));
    const first = await shot(page, "#flat");
    const asked = [];
    page.on("request", (one) => asked.push(new URL(one.url()).pathname.split("/").at(-1)));
    const move = (event) => page.evaluate((kind) => {
      const slider = document.getElementById("balance");
      slider.value = "100";
      slider.dispatchEvent(new Event(kind));
    }, event);
    await move("input");
    await page.locator("#live", { hasText: "(draft)" }).waitFor();
    const draft = await shot(page, "#flat");
    assert.ok(asked.includes("result") && !asked.includes("result.json"), asked.join());
    await move("change");
    await page.locator("#live", { hasText: /^λ 100: angles [\d.]+, areas [\d.]+\.$/ }).waitFor();
    const last = await shot(page, "#flat");
    const [near, far] = [await difference(page, draft, last, 64), await difference(page, first, last, 64)];
    assert.ok(near < far / 2, `${near} of the draft, ${far} of the map before`);
  });

  test("a draft that nobody waits for any more is removed", async (t) => {
    const page = await bench.visit(t);
    await page.selectOption("[name=method]", "hybrid");
    await unwrap(page, bench.file("cap.obj", cap()));
    let go;
    const held = new Promise((resolve) => { go = resolve; });
    const asked = page.waitForRequest("**/jobs/*/result");
    await page.route("**/jobs/*/result", async (route) => {
      await held;
      await route.continue();
    });
    await page.focus("#balance");
    await page.evaluate(() => document.getElementById("balance").dispatchEvent(new Event("input")));
    const draft = new URL((await asked).url()).pathname.replace("/result", "");
    await openMesh(page, bench.file("next.obj", cap(6)));
    const removed = page.waitForRequest((one) => one.method() === "DELETE" && one.url().endsWith(draft));
    go();
    await (await removed).response();
    assert.equal((await fetch(bench.server.base + draft)).status, 404);
    assert.equal(await page.locator("#live").innerText(), "");
  });

  test("another mesh begins without the edits of the last", async (t) => {
    const page = await bench.visit(t);
    await unwrap(page, bench.file("cap.obj", cap()));
    await page.check("#edit-seams");
    await clickAt(page, "#solid", 0.4, 0.5);
    await clickAt(page, "#solid", 0.6, 0.5);
    await openMesh(page, bench.file("next.obj", cap(6)));
    assert.equal(await page.locator("#edit").isVisible(), false);
    const options = await submitted(page, () => page.click("#send"));
    assert.equal(options.seam_edges, undefined);
  });
});
