// Meshes come to the page: every format, in parts and archives, from anywhere; and what it says of them.
import assert from "node:assert/strict";
import { after, before, describe, test } from "node:test";

import { glb, gltf, obj } from "../contract/meshes.mjs";
import { Bench, downloaded, drop, missing, openMesh, real, seen, unwrap } from "./page.mjs";

const bench = new Bench();
const TETRAHEDRON = { points: [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], faces: [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]] };

function stl() {
  const { points, faces } = TETRAHEDRON;
  const facets = faces.map((face) => `facet normal 0 0 0\nouter loop\n${face.map((v) => `vertex ${points[v].join(" ")}`).join("\n")}\nendloop\nendfacet`);
  return `solid made\n${facets.join("\n")}\nendsolid made\n`;
}

function ply() {
  const { points, faces } = TETRAHEDRON;
  const head = ["ply", "format ascii 1.0", "element vertex 4", ...["x", "y", "z"].map((axis) => `property float ${axis}`),
    "element face 4", "property list uchar int vertex_indices", "end_header"];
  return [...head, ...points.map((point) => point.join(" ")), ...faces.map((face) => `3 ${face.join(" ")}`), ""].join("\n");
}

/** A pyramid on five sides: six faces, one of five corners, or the same as a strip and a fan of strips. */
function pyramid(kind) {
  const points = [...Array(5).keys()].map((k) => [Math.cos((2 * Math.PI * k) / 5), Math.sin((2 * Math.PI * k) / 5), 0]).concat([[0, 0, 1]]);
  const lists = kind === "face"
    ? [[4, 3, 2, 1, 0], ...[0, 1, 2, 3, 4].map((k) => [k, (k + 1) % 5, 5])]
    : [[4, 3, 0, 2, 1, -1, 0, 1, 5, 2, 2, -1, 2, 3, 5, 4, -1, 4, 0, 5]];
  const head = Buffer.from(["ply", "format binary_big_endian 1.0", "element vertex 6", ...["x", "y", "z"].map((axis) => `property double ${axis}`),
    `element ${kind} ${lists.length}`, "property list uchar int vertex_indices", "end_header", ""].join("\n"));
  const values = Buffer.alloc(6 * 24);
  points.flat().forEach((value, i) => values.writeDoubleBE(value, 8 * i));
  return Buffer.concat([head, values, ...lists.map((list) => {
    const bytes = Buffer.alloc(1 + 4 * list.length);
    bytes.writeUInt8(list.length);
    list.forEach((corner, i) => bytes.writeInt32BE(corner, 1 + 4 * i));
    return bytes;
  })]);
}

/** With normals and colours, and corners on lines of their own. */
function off() {
  const { points, faces } = TETRAHEDRON;
  return ["NOFF # made", "4 4 6", ...points.map((point) => `${point.join(" ")} 0 0 1 # a corner`),
    ...faces.map((face) => `3 ${face.join("\n")} 255 0 0`), ""].join("\n");
}

describe("the page opens", { skip: missing }, () => {
  before(() => bench.open());
  after(() => bench.close());

  const says = (page) => page.locator("#analysis").innerText();

  for (const [name, bytes] of [["solid.stl", stl()], ["solid.ply", ply()], ["solid.off", off()]])
    test(`${name} and shows it before anything is sent`, async (t) => {
      const page = await bench.visit(t);
      await openMesh(page, bench.file(name, bytes));
      assert.match(await says(page), /4 triangles and 4 vertices\.\nOne connected piece; closed: it has no boundary\.\nNo texture/);
      assert.ok((await seen(page, "#solid")).share > 0.05, "the mesh is on the screen");
      await page.click("#send");
      await page.locator("#result").waitFor();
      assert.deepEqual(page.complaints, []);
      assert.deepEqual(page.elsewhere, []);
    });

  for (const kind of ["face", "tristrips"])
    test(`a PLY with ${kind === "face" ? "a face of five corners" : "strips of triangles"}, as the server reads it`, async (t) => {
      const page = await bench.visit(t);
      await openMesh(page, bench.file("pyramid.ply", pyramid(kind)));
      assert.match(await says(page), /8 triangles and 6 vertices\.\nOne connected piece; closed: it has no boundary\./);
      await unwrap(page);
      assert.match(await page.locator("#result").innerText(), /charts?/);
      assert.deepEqual(page.complaints, []);
    });

  test("a glTF with the buffers beside it, dropped beside the box", async (t) => {
    const page = await bench.visit(t);
    const { text, buffer } = gltf("grid.bin");
    await drop(page, "#jobs", [["grid.bin", buffer], ["chair.gltf", text]]);
    await page.locator("#analysis", { hasText: "A disk" }).waitFor();
    assert.equal(await page.locator("#mesh-name").innerText(), "chair.gltf");
    await unwrap(page);
    const [name, json] = await downloaded(page, "#downloads .primary");
    assert.equal(name, "chair.uv.gltf");
    assert.ok("TEXCOORD_0" in JSON.parse(json).meshes[0].primitives[0].attributes);
    assert.deepEqual(page.complaints, []);
  });

  test("one of two meshes, and says so", async (t) => {
    const page = await bench.visit(t);
    await openMesh(page, bench.file("first.obj", obj(2)), bench.file("second.obj", obj(3)));
    assert.match(await says(page), /Only first\.obj is open, not second\.obj: open one mesh at a time\./);
    assert.match(await says(page), /8 triangles/);
  });

  test("the next mesh in place of the first", async (t) => {
    const page = await bench.visit(t);
    await unwrap(page, bench.file("first.obj", obj(2)));
    await openMesh(page, bench.file("next.glb", glb(5)));
    assert.equal(await page.locator("#mesh-name").innerText(), "next.glb");
    assert.match(await says(page), /50 triangles/);
    assert.equal(await page.locator("#result").isVisible(), false, "the result of the first is gone");
    assert.ok(!page.url().includes("job="), "and its address");
  });

  test("nothing in place of a mesh that is open, where text is dropped or a file is no mesh", async (t) => {
    const page = await bench.visit(t);
    await openMesh(page, bench.file("grid.obj", obj(3)));
    await page.evaluate(() => {
      const dataTransfer = new DataTransfer();
      dataTransfer.setData("text/plain", "words");
      document.body.dispatchEvent(new DragEvent("drop", { dataTransfer, bubbles: true }));
    });
    await page.setInputFiles("#files", bench.file("words.obj", "hello"));
    await page.locator("#problem").waitFor();
    assert.equal(await page.locator("#mesh-name").innerText(), "grid.obj");
    assert.equal(await page.locator("#opened").isVisible(), true);
  });

  test("what is no mesh with words that help", async (t) => {
    const page = await bench.visit(t);
    await page.setInputFiles("#files", [bench.file("notes.txt", "hello")]);
    await page.locator("#problem", { hasText: "There is no mesh among these files: notes.txt" }).waitFor();
    await page.setInputFiles("#files", [bench.file("broken.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n")]);
    await page.locator("#problem", { hasText: "face 1 names vertex 9, which does not exist" }).waitFor();
    await page.setInputFiles("#files", [bench.file("empty.obj", "v 0 0 0\n")]);
    await page.locator("#problem", { hasText: "empty.obj has no triangles" }).waitFor();
    assert.equal(await page.locator("#problem-title").evaluate((title) => document.activeElement === title), true);
  });

  const encodings = ["u16", "draco_eb_q14", "meshopt", "quant_i16", "3prims", "nonindexed", "ext", "datauri", "4instances"];
  for (const encoding of encodings) {
    const ending = ["ext", "datauri"].includes(encoding) ? "gltf" : "glb";
    const path = real(`gltf/derived/demosthenes16k_${encoding}.${ending}`);
    test(`a real glTF as ${encoding}`, { skip: !path && "the test data is missing" }, async (t) => {
      const page = await bench.visit(t);
      await openMesh(page, ...[path, encoding === "ext" && path.replace(".gltf", ".bin")].filter(Boolean));
      assert.match(await says(page), /A disk|4 connected pieces/);
      assert.ok((await seen(page, "#solid")).share > 0.01);
      assert.deepEqual(page.complaints, []);
      assert.deepEqual(page.elsewhere, []);
    });
  }

  test("a .gltf whose buffer was forgotten", { skip: !real("gltf/derived") && "the test data is missing" }, async (t) => {
    const page = await bench.visit(t);
    await page.setInputFiles("#files", [real("gltf/derived/demosthenes16k_ext.gltf")]);
    await page.locator("#problem", { hasText: "demosthenes16k_ext.bin" }).waitFor();
    assert.match(await page.locator("#problem").innerText(), /Open it together with/);
  });

  test("an archive, and sends it whole", async (t) => {
    const page = await bench.visit(t);
    const { text, buffer } = gltf("parts/grid.bin");
    const archive = zip({ "parts/grid.bin": buffer, "chair.gltf": Buffer.from(text) });
    await unwrap(page, bench.file("chair.zip", archive));
    assert.equal(await page.locator("#mesh-name").innerText(), "chair.gltf");
    assert.equal((await downloaded(page, "#downloads .primary"))[0], "chair.uv.gltf");
  });
});

/** An archive without compression. */
function zip(files) {
  const { zipSync } = fflate;
  return Buffer.from(zipSync(Object.fromEntries(Object.entries(files).map(([name, bytes]) => [name, new Uint8Array(bytes)])), { level: 0 }));
}
const fflate = await import("three/examples/jsm/libs/fflate.module.js").catch(() => undefined);
