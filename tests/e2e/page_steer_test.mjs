// Steering by hand: edges that are kept from seams, and islands that stay where others are packed.
import assert from "node:assert/strict";
import { after, before, describe, test } from "node:test";

import { glbOf } from "../contract/meshes.mjs";
import { Bench, box, difference, jobOf, missing, openMesh, real, shot, submitted, unwrap } from "./page.mjs";

const bench = new Bench();

describe("steered by hand", { skip: missing }, () => {
  before(() => bench.open());
  after(() => bench.close());

  const resultOf = async (page) => (await fetch(`${bench.server.base}/v1/jobs/${jobOf(page)}/result.json`)).json();
  const idle = (page) => page.waitForFunction(() => !document.querySelector("#send").disabled);

  /** The edges of a result whose sides have different UVs, by vertices of the input, lower first. */
  function seamsOf({ meshes: [{ faces, uv, vertex_map: map }] }) {
    const sides = new Map();
    for (let h = 0; h < faces.length; h += 1) {
      const [a, b] = [faces[h], faces[h % 3 === 2 ? h - 2 : h + 1]];
      const key = [map[a], map[b]].sort((x, y) => x - y).join();
      const ends = (map[a] < map[b] ? [a, b] : [b, a]).flatMap((v) => [uv[2 * v], uv[2 * v + 1]]);
      sides.set(key, [...(sides.get(key) ?? []), ends.join()]);
    }
    return new Set([...sides].filter(([, own]) => own.length === 2 && own[0] !== own[1]).map(([key]) => key));
  }

  test("no seam runs along edges that are kept", async (t) => {
    const page = await bench.visit(t);
    await unwrap(page, bench.file("box.obj", box(4)));
    const before = seamsOf(await resultOf(page));
    await page.check("#edit-keep");
    assert.match(await page.locator("#seam-purpose").innerText(), /no seam runs along these edges/);
    assert.ok(await page.locator("#keep-charts-row").isHidden());
    const bare = await shot(page, "#solid");
    await page.fill("#crease-angle", "80");
    await page.click("#seam-creases");
    assert.match(await page.locator("#seam-count").innerText(), /^48 edges marked in 12 paths/);
    await page.mouse.move(5, 5);
    assert.ok(await difference(page, await shot(page, "#solid"), bare) > 0.0003, "the marks are seen");
    await page.click("#seam-undo");
    await page.click("#seam-creases");
    const options = await submitted(page, () => page.click("#send"));
    const kept = new Set(options.keep_edges.flatMap(({ vertices }) =>
      vertices.slice(1).map((v, k) => [v, vertices[k]].sort((x, y) => x - y).join())));
    assert.equal(kept.size, 48);
    assert.equal(options.seam_edges, undefined, "the present charts do not stay");
    await idle(page);
    const result = await resultOf(page);
    const cut = [...seamsOf(result)].filter((edge) => kept.has(edge)).length;
    assert.ok([...before].some((edge) => kept.has(edge)), "creases are where seams are by themselves");
    assert.equal(cut, 0, `${cut} of 48`);
    assert.deepEqual(result.report.notes.filter(({ code }) => code === "kept_edges_cut"), []);
    assert.ok(seamsOf(result).size > 0);
  });

  test("pins and drafts keep the present charts, and kept edges wait", async (t) => {
    const page = await bench.visit(t);
    await unwrap(page, bench.file("box.obj", box(2)));
    await page.check("#edit-keep");
    await page.fill("#crease-angle", "80");
    await page.click("#seam-creases");
    await page.check("#edit-pins");
    await page.focus("#flat");
    const uv = await faceAt(page, 0);
    const { x, y } = await placeOf(page, uv);
    await page.mouse.click(x, y);
    await page.check("#edit-keep");
    assert.match(await page.locator("#seam-count").innerText(), /count once there is no pin/);
    const options = await submitted(page, () => page.click("#send"));
    assert.ok(options.constraints.length === 1 && options.seam_edges.length > 0 && !options.keep_edges);
  });

  /** Where a point of the page lies on the screen, while all of the page is shown. */
  async function placeOf(page, [u, v]) {
    await page.locator("#flat").scrollIntoViewIfNeeded();
    const { x, y, width, height } = await page.locator("#flat").boundingBox();
    return { x: x + width * (0.5 + (u - 0.5) / 1.06), y: y + height * (0.5 - (v - 0.5) / 1.06) };
  }

  /** The middle of a face in the layout. */
  async function faceAt(page, face) {
    const { meshes: [{ faces, uv }] } = await resultOf(page);
    const corners = faces.slice(3 * face, 3 * face + 3);
    return [0, 1].map((k) => corners.reduce((sum, v) => sum + uv[2 * v + k] / 3, 0));
  }

  const cornersOf = ({ meshes: [{ faces, uv }] }, face) => faces.slice(3 * face, 3 * face + 3).map((v) => [uv[2 * v], uv[2 * v + 1]]);

  /** A visitor whose box is cut into its six sides, of 32 triangles each. */
  async function visitWithSixIslands(t) {
    const page = await bench.visit(t);
    await unwrap(page, bench.file("box.obj", box(4)));
    await page.check("#edit-seams");
    await page.uncheck("#keep-charts");
    await page.fill("#crease-angle", "80");
    await page.click("#seam-creases");
    await submitted(page, () => page.click("#send"));
    await page.waitForFunction(() => document.querySelector("#figures dd")?.firstChild.textContent === "6");
    await idle(page);
    return page;
  }

  test("locked islands stay, and the others are packed around them", async (t) => {
    const page = await visitWithSixIslands(t);
    const before = await resultOf(page);
    await page.check("#edit-islands");
    assert.equal(await page.locator("#lock-count").innerText(), "0 islands of 6 locked.");
    const bare = await shot(page, "#flat");
    for (const face of [0, 64]) {
      const { x, y } = await placeOf(page, await faceAt(page, face));
      await page.mouse.click(x, y);
      await page.check("#island-locked");
    }
    assert.equal(await page.locator("#lock-count").innerText(), "2 islands of 6 locked.");
    await page.mouse.move(5, 5);
    assert.ok(await difference(page, await shot(page, "#flat"), bare) > 0.01, "locks are seen");
    if (process.env.SHOTS) await page.screenshot({ path: `${process.env.SHOTS}/locked.png` });
    await page.fill("#option-padding", "1");
    const first = jobOf(page);
    const options = await submitted(page, () => page.click("#pack-again"));
    assert.equal(options.repack_only, true);
    assert.equal(options.padding, 1);
    assert.deepEqual(options.locked_islands, [{ mesh: 0, face: 0 }, { mesh: 0, face: 64 }]);
    await page.waitForFunction((id) => location.hash.includes("job=") && !location.hash.includes(id) && !document.querySelector("#send").disabled, first);
    const result = await resultOf(page);
    const islandOf = (face) => Math.floor(face / 32);
    for (let face = 0; face < 192; face += 1)
      if ([0, 2].includes(islandOf(face))) assert.deepEqual(cornersOf(result, face), cornersOf(before, face), `face ${face}`);
    assert.ok([32, 96].some((face) => `${cornersOf(result, face)}` !== `${cornersOf(before, face)}`), "others moved");
    assert.equal(await page.locator("#lock-count").innerText(), "2 islands of 6 locked.", "they stay locked");
    if (process.env.SHOTS) await page.screenshot({ path: `${process.env.SHOTS}/packed.png` });
    await page.click("#unlock-all");
    const free = await submitted(page, () => page.click("#pack-again"));
    assert.equal(free.locked_islands, undefined);
  });

  test("an island is moved and turned by hand, and packing leaves it there", async (t) => {
    const page = await visitWithSixIslands(t);
    const before = await resultOf(page);
    await page.check("#edit-islands");
    await page.click("#lock-all");
    const from = await faceAt(page, 64);
    const drag = async (start, end, key) => {
      const [{ x, y }, to] = [await placeOf(page, start), await placeOf(page, end)];
      if (key) await page.keyboard.down(key);
      await page.mouse.move(x, y);
      await page.mouse.down();
      await page.mouse.move((x + to.x) / 2, (y + to.y) / 2, { steps: 3 });
      await page.mouse.move(to.x, to.y);
      await page.mouse.up();
      if (key) await page.keyboard.up(key);
    };
    const bare = await shot(page, "#flat");
    await drag(from, [from[0] < 0.5 ? from[0] + 0.1 : from[0] - 0.1, from[1]]);
    assert.match(await page.locator("#lock-count").innerText(), /^6 islands of 6 locked. 1 island moved/);
    assert.ok(await difference(page, await shot(page, "#flat"), bare) > 0.01, "the layout shows it there");
    assert.match(await page.locator("#faults").innerText(), /overlap others/, "it lies on its neighbour");
    assert.equal(await page.locator("#island-name").innerText(), "Chart 3");
    const moved = Number(await page.inputValue("#island-u"));
    assert.ok(Math.abs(Math.abs(moved) - 0.1) < 0.01, `${moved}`);
    await page.click("#island-back");
    assert.equal(await page.locator("#lock-count").innerText(), "6 islands of 6 locked.");
    assert.ok(await difference(page, await shot(page, "#flat"), bare) < 0.01, "it is back");
    // By numbers, and by Shift: a quarter turn of a square about its middle.
    await page.fill("#island-turn", "45");
    await page.press("#island-turn", "Tab");
    await page.fill("#island-turn", "0");
    await page.press("#island-turn", "Tab");
    const corners = [...Array(32).keys()].flatMap((k) => cornersOf(before, 64 + k));
    const [low, high] = [Math.min, Math.max].map((least) => [0, 1].map((k) => least(...corners.map((c) => c[k]))));
    const [middle, reach] = [low.map((l, k) => (l + high[k]) / 2), (high[0] - low[0]) * 0.4];
    await drag([middle[0] + reach, middle[1]], [middle[0], middle[1] + reach], "Shift");
    const turned = Number(await page.inputValue("#island-turn"));
    assert.ok(Math.abs(turned - 90) < 2, `${turned}`);
    await page.fill("#island-turn", "90");
    await page.press("#island-turn", "Tab");
    const first = jobOf(page);
    const options = await submitted(page, () => page.click("#pack-again"));
    const wanted = options.locked_islands.find(({ turn }) => turn);
    assert.deepEqual(wanted, { mesh: 0, face: 64, turn: 90, move: [0, 0] });
    assert.equal(options.locked_islands.length, 6);
    await page.waitForFunction((id) => location.hash.includes("job=") && !location.hash.includes(id) && !document.querySelector("#send").disabled, first);
    const result = await resultOf(page);
    for (let face = 0; face < 192; face += 1)
      for (const [k, [u, v]] of cornersOf(before, face).entries()) {
        const isTurned = Math.floor(face / 32) === 2;
        const place = isTurned ? [middle[0] - (v - middle[1]), middle[1] + (u - middle[0])] : [u, v];
        const now = cornersOf(result, face)[k];
        assert.ok(Math.hypot(now[0] - place[0], now[1] - place[1]) < 1e-6, `face ${face}`);
      }
    assert.equal(result.report.overlaps, 0);
    assert.equal(await page.locator("#lock-count").innerText(), "6 islands of 6 locked.");
  });

  test("an island is locked by keyboard, and what does not fit is told", async (t) => {
    const page = await visitWithSixIslands(t);
    await page.check("#edit-islands");
    await page.click("#lock-all");
    assert.equal(await page.locator("#lock-count").innerText(), "6 islands of 6 locked.");
    await page.check("#edit-look");
    const { x, y } = await placeOf(page, await faceAt(page, 5));
    await page.mouse.click(x, y);
    await page.focus("#flat");
    await page.keyboard.press("l");
    assert.match(await page.locator("#announcement").textContent(), /^Chart 1 is unlocked/);
    await page.check("#edit-islands");
    assert.equal(await page.locator("#lock-count").innerText(), "5 islands of 6 locked.");
    const before = await resultOf(page);
    await page.fill("#option-padding", "120");
    await page.click("#pack-again");
    await page.locator("#problem", { hasText: /do not fit beside the locked ones/ }).waitFor();
    assert.equal(await page.locator("#lock-count").innerText(), "5 islands of 6 locked.", "what was arranged stays");
    assert.deepEqual(await resultOf(page), before, "the address is that of the result");
    await page.fill("#option-padding", "1");
    await page.click("#pack-again");
    await page.locator("#status", { hasText: "Packed again" }).waitFor();
    await page.click("#send");
    await page.locator("#status", { hasText: "Done" }).waitFor();
    assert.match(await page.locator("#lock-count").innerText(), /^0 islands of 6 locked.$/, "the mesh that was opened is unwrapped, without locks");
  });

  test("an island that is moved off the page is told before it is sent, and what lies on others is hatched after it", async (t) => {
    const page = await visitWithSixIslands(t);
    await page.check("#edit-islands");
    const { x, y } = await placeOf(page, await faceAt(page, 64));
    await page.mouse.click(x, y);
    await page.fill("#island-u", "-0.9");
    await page.press("#island-u", "Tab");
    assert.match(await page.locator("#lock-count").innerText(), /Chart 3 lies beyond the page/);
    await page.click("#pack-again");
    await page.locator("#problem", { hasText: /Move Chart 3 onto the page/ }).waitFor();
    await page.fill("#island-turn", "400");
    await page.press("#island-turn", "Tab");
    assert.equal(await page.inputValue("#island-turn"), "360");
    await page.click("#island-back");
    await page.click("#lock-all");
    const [own, other] = [await faceAt(page, 64), await faceAt(page, 0)];
    await page.fill("#island-u", String(((other[0] - own[0]) / 2).toFixed(3)));
    await page.press("#island-u", "Tab");
    await page.fill("#island-v", String(((other[1] - own[1]) / 2).toFixed(3)));
    await page.press("#island-v", "Tab");
    assert.match(await page.locator("#faults").innerText(), /overlap others/);
    await page.click("#pack-again");
    await page.locator("#status", { hasText: "Packed again" }).waitFor();
    assert.match(await page.locator("#faults").innerText(), /overlap others/);
    assert.ok((await resultOf(page)).report.notes.some(({ code }) => code === "overlaps"));
  });

  test("charts that were packed are kept by vertices of the mesh that is open", async (t) => {
    const page = await bench.visit(t);
    const lines = box(4).split("\n").map((line) => line.split(" "));
    const numbers = (kind) => lines.filter(([first]) => first === kind).map(([, ...rest]) => rest.map(Number));
    const mesh = { positions: Float32Array.from(numbers("v").flat()),
      indices: Uint32Array.from(numbers("f").flatMap(([a, b, c, d]) => [a, b, c, a, c, d]).map((v) => v - 1)) };
    await unwrap(page, bench.file("box.glb", glbOf(mesh)));
    const [{ vertex_map: map }] = (await resultOf(page)).meshes;
    assert.ok(map.length > mesh.positions.length / 3, "seams duplicate vertices");
    await page.check("#edit-islands");
    await page.click("#pack-again");
    await page.locator("#status", { hasText: "Packed again" }).waitFor();
    await page.check("#edit-seams");
    await page.fill("#crease-angle", "80");
    await page.click("#seam-creases");
    const { seam_edges: edges } = await submitted(page, () => page.click("#send"));
    const sides = new Set(numbers("f").flatMap(([a, b, c, d]) => [[a, b], [b, c], [c, d], [d, a], [a, c]])
      .map((ends) => ends.map((v) => v - 1).sort((x, y) => x - y).join()));
    for (const { vertices } of edges)
      for (const [k, v] of vertices.slice(1).entries()) assert.ok(sides.has([vertices[k], v].sort((x, y) => x - y).join()), `${vertices[k]} to ${v}`);
    await page.locator("#status", { hasText: "Done" }).waitFor();
    assert.equal(await page.locator("#figures dd").first().evaluate((dd) => dd.firstChild.textContent), "6");
  });

  test("images are painted for the islands where they were packed, in the set that the textures use", { skip: !real("gltf/sharpgltf/tests/Assets/tree.glb") && "there are no real meshes" }, async (t) => {
    const page = await bench.visit(t);
    await openMesh(page, real("gltf/sharpgltf/tests/Assets/tree.glb"));
    await page.click("text=More options");
    await page.selectOption("#option-textures", "transfer");
    await unwrap(page);
    await page.check("#edit-islands");
    await page.click("#lock-all");
    const options = await submitted(page, () => page.click("#pack-again"));
    assert.equal(options.textures, "transfer");
    await page.locator("#status", { hasText: "Packed again" }).waitFor();
    assert.equal((await resultOf(page)).report.texcoord, options.texcoord);
    await page.reload();
    await page.locator("#result").waitFor();
    assert.ok(await page.locator("#edit-closed").isVisible());
    assert.ok(await page.locator("#edit-seams").isDisabled());
    await page.check("#edit-islands");
    assert.match(await page.locator("#lock-count").innerText(), /^0 islands of \d+ locked/, "islands are arranged without the mesh, too");
  });
});
