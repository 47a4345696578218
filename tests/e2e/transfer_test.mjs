// Assets before and after textures=transfer, drawn from eight sides by three.js in a real Chromium:
// what a renderer shows that knows nothing of this project.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { after, before, describe, test } from "node:test";
import { fileURLToPath } from "node:url";

import { Bench, missing, real } from "./page.mjs";

const ORIGIN = "http://look.test";
const THREE = fileURLToPath(new URL("../node_modules/three/", import.meta.url));
const MOST_DIFFERENCE = 2; // of 255, mean over pixels away from seams
const TEXTURES = "gltf/babylon/Tests/AssetGenerator/0.6/Mesh_PrimitiveAttribute/Textures";

const PAGE = `<!doctype html><link rel="icon" href="data:,">
<script type="importmap">{"imports": {"three": "/build/three.module.js", "three/addons/": "/examples/jsm/"}}</script>
<script type="module" src="/look.js"></script>`;

/** How two GLBs look beside each other in look.js. */
async function comparison(bench, t, ...assets) {
  const page = await bench.blank(t, ORIGIN);
  await page.route(`${ORIGIN}/**`, (route) => {
    const { pathname } = new URL(route.request().url());
    if (pathname === "/") return route.fulfill({ contentType: "text/html", body: PAGE });
    const path = pathname === "/look.js" ? fileURLToPath(new URL("look.js", import.meta.url)) : THREE + pathname;
    return route.fulfill({ contentType: "text/javascript", body: readFileSync(path) });
  });
  await page.goto(ORIGIN);
  await page.waitForFunction(() => window.compare !== undefined);
  const sides = await page.evaluate(([old, now]) => window.compare(old, now), assets.map((glb) => glb.toString("base64")));
  assert.deepEqual(page.complaints, []);
  return sides;
}

/**
 * A bent plate with a wave, whose UVs repeat a colour and a normal map, the first one turned. It has
 * tangents: without them three.js takes frames of its own, which are not those of MikkTSpace.
 */
function plate(colour, normal) {
  const n = 24;
  const rows = [...Array(n + 1).keys()];
  const places = rows.flatMap((y) => rows.map((x) => [x / n, y / n]));
  const point = (u, v) => {
    const r = 1 + 0.15 * Math.sin(7 * v);
    return [r * Math.sin(4.4 * u), 2 * v - 1, r * Math.cos(4.4 * u)];
  };
  const upright = (u, v) => {
    const slope = (0.15 * 7 * Math.cos(7 * v)) / 2;
    const length = Math.hypot(1, slope);
    return [Math.sin(4.4 * u) / length, -slope / length, Math.cos(4.4 * u) / length];
  };
  const corners = rows.slice(1).flatMap((y) => rows.slice(1).flatMap((x) => {
    const b = y * (n + 1) + x;
    const a = b - n - 1;
    return [a - 1, a, b, a - 1, b, b - 1];
  }));
  const parts = [
    Float32Array.from(places.flatMap(([u, v]) => point(u, v))),
    Float32Array.from(places.flatMap(([u, v]) => upright(u, v))),
    Float32Array.from(places.flatMap(([u]) => [Math.cos(4.4 * u), 0, -Math.sin(4.4 * u), 1])),
    Float32Array.from(places.flatMap(([u, v]) => [0.8 * u - 0.3, 0.2 - 0.5 * v])),
    Uint32Array.from(corners),
    colour,
    normal,
  ].map((array) => Buffer.from(array.buffer, array.byteOffset, array.byteLength));
  const count = places.length;
  return glbOf(parts, {
    accessors: [
      { bufferView: 0, componentType: 5126, count, type: "VEC3", min: [-1.15, -1, -1.15], max: [1.15, 1, 1.15] },
      { bufferView: 1, componentType: 5126, count, type: "VEC3" },
      { bufferView: 2, componentType: 5126, count, type: "VEC4" },
      { bufferView: 3, componentType: 5126, count, type: "VEC2" },
      { bufferView: 4, componentType: 5125, count: corners.length, type: "SCALAR" },
    ],
    meshes: [{ primitives: [{ attributes: { POSITION: 0, NORMAL: 1, TANGENT: 2, TEXCOORD_0: 3 }, indices: 4, material: 0 }] }],
    images: [5, 6].map((bufferView) => ({ bufferView, mimeType: "image/png" })),
    textures: [{ source: 0 }, { source: 1 }],
    materials: [{
      normalTexture: { index: 1 },
      pbrMetallicRoughness: {
        metallicFactor: 0,
        baseColorTexture: { index: 0, extensions: { KHR_texture_transform: { rotation: 0.4, scale: [1.3, 0.8], offset: [0.1, -0.2] } } },
      },
    }],
    extensionsUsed: ["KHR_texture_transform"],
    nodes: [{ mesh: 0 }],
    scenes: [{ nodes: [0] }],
    scene: 0,
  });
}

/** A binary glTF of one buffer with a view for each part. */
function glbOf(parts, json) {
  const padded = parts.map((part) => Buffer.concat([part, Buffer.alloc(-part.length & 3)]));
  let byteOffset = 0;
  const bufferViews = parts.map((part, i) => {
    const view = { buffer: 0, byteOffset, byteLength: part.length };
    byteOffset += padded[i].length;
    return view;
  });
  const text = JSON.stringify({ asset: { version: "2.0" }, ...json, bufferViews, buffers: [{ byteLength: byteOffset }] });
  const chunks = [Buffer.from(text + " ".repeat(-text.length & 3)), Buffer.concat(padded)];
  const heads = chunks.map((chunk, i) => {
    const head = Buffer.alloc(8, i === 0 ? "\0\0\0\0JSON" : "\0\0\0\0BIN\0");
    head.writeUInt32LE(chunk.length);
    return head;
  });
  const head = Buffer.alloc(12, "glTF");
  head.writeUInt32LE(2, 4);
  head.writeUInt32LE(12 + 16 + chunks[0].length + byteOffset, 8);
  return Buffer.concat([head, heads[0], chunks[0], heads[1], chunks[1]]);
}

describe("textures that were transferred look the same in three.js", { skip: missing || (!real(TEXTURES) && "the test data is missing") }, () => {
  const bench = new Bench();
  before(() => bench.open());
  after(() => bench.close());

  async function unwrapped(file, query) {
    const answer = await fetch(`${bench.server.base}/v1/unwrap?compression=none&${query}`, {
      method: "POST",
      headers: { "Content-Type": "model/gltf-binary" },
      body: file,
    });
    assert.equal(answer.status, 200, await (answer.ok ? "" : answer.text()));
    return Buffer.from(await answer.arrayBuffer());
  }

  async function compare(t, file, page = "") {
    const [old, now] = [await unwrapped(file, "texcoord=free"), await unwrapped(file, `textures=transfer&${page}`)];
    const sides = await comparison(bench, t, old, now);
    assert.equal(sides.length, 8);
    sides.forEach(({ difference, compared, shown }, i) => {
      t.diagnostic(`side ${i}: ${difference.toFixed(3)} of 255 over ${compared} of ${shown} pixels`);
      assert.ok(difference <= MOST_DIFFERENCE, `side ${i}: ${difference}`);
      assert.ok(shown >= 5_000 && compared >= 0.4 * shown, `side ${i}: ${compared} of ${shown} pixels are compared`);
    });
  }

  test("a model with a JPEG", (t) => compare(t, readFileSync(real("gltf/pmndrs/pmndrs.glb"))));

  test("a plate with a turned image that repeats and a normal map, on a page that is not square", (t) =>
    compare(t, plate(readFileSync(real(`${TEXTURES}/BaseColor_Plane.png`)), readFileSync(real(`${TEXTURES}/Normal_Plane.png`))), "width=512&height=1536"));
});
