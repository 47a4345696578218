// The views: colours, the link of mesh and layout, before and after; and what can be kept of a result.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { readFileSync } from "node:fs";
import { after, before, describe, test } from "node:test";

import { obj } from "../contract/meshes.mjs";
import { Bench, cap, difference, downloaded, jobOf, missing, openMesh, real, seen, shot, unwrap } from "./page.mjs";

const bench = new Bench();

/** A cube of quads, with texture coordinates that put all six sides on one place. */
function cube() {
  const points = [0, 1, 2, 3, 4, 5, 6, 7].map((i) => `v ${i & 1} ${(i >> 1) & 1} ${i >> 2}`);
  const sides = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
  const faces = sides.map((side) => `f ${side.map((v, i) => `${v + 1}/${i + 1}`).join(" ")}`);
  return [...points, "vt 0.1 0.1", "vt 0.9 0.1", "vt 0.9 0.9", "vt 0.1 0.9", ...faces, ""].join("\n");
}

describe("the views of the page", { skip: missing }, () => {
  before(() => bench.open());
  after(() => bench.close());

  const changed = async (page, canvas, old) => (await difference(page, await shot(page, canvas), old)) > 0.0005;
  /** Whether a canvas soon shows what it showed. */
  const like = async (page, canvas, old) => {
    for (let tries = 0; tries < 10; tries += 1) if (await difference(page, await shot(page, canvas), old, 32) < 0.02) return true;
    return false;
  };

  test("show a real mesh and its charts in every colouring", { skip: !real("closed/spot_control_mesh.obj") && "the test data is missing" }, async (t) => {
    const page = await bench.visit(t);
    await unwrap(page, real("closed/spot_control_mesh.obj"));
    const pictures = new Set();
    for (const colouring of ["plain", "checker", "stretch", "angle", "area", "charts"]) {
      await page.selectOption("#colouring", colouring);
      pictures.add(await shot(page, "#solid") + await shot(page, "#flat"));
      assert.equal(await page.locator("#legend").isVisible(), ["stretch", "angle", "area"].includes(colouring));
      assert.ok((await seen(page, "#flat")).share > 0.3, `the layout by ${colouring}`);
    }
    assert.equal(pictures.size, 6, "each colouring is a picture of its own");
    const { charts } = await (await fetch(`${bench.server.base}/v1/jobs/${jobOf(page)}/report`)).json();
    const [worst] = charts.map(({ distortion }) => distortion).sort((a, b) => b.angle + b.area - a.angle - a.area);
    const [, angle, area] = (await page.locator("#charts li").first().textContent()).match(/angles ([\d.]+), areas ([\d.]+) \(the worst\)/);
    for (const [shown, reported] of [[angle, worst.angle], [area, worst.area]])
      assert.ok(Math.abs(shown - reported) < 0.03, `the page's figure is ${shown}, the report's ${reported}`);
    await page.selectOption("#colouring", "plain");
    const plain = await shot(page, "#solid");
    await page.check("#show-wire");
    assert.ok(await changed(page, "#solid", plain));
    assert.deepEqual(page.complaints, []);
  });

  test("show an image of the person's own, and say what is none", async (t) => {
    const page = await bench.visit(t);
    const choosing = page.waitForEvent("filechooser"); // long before it is opened
    await unwrap(page, bench.file("grid.obj", obj(4)));
    await page.selectOption("#colouring", "image");
    const png = await page.evaluate(() => {
      const canvas = Object.assign(document.createElement("canvas"), { width: 8, height: 8 });
      const pen = canvas.getContext("2d");
      pen.fillStyle = "#d00";
      pen.fillRect(0, 0, 8, 8);
      return canvas.toDataURL().split(",")[1];
    });
    await (await choosing).setFiles(bench.file("red.png", Buffer.from(png, "base64")));
    const isRed = async () => page.evaluate(async (bytes) => {
      const { data, width, height } = await pixelsOf(bytes);
      const [r, g, b] = data.subarray(4 * ((height >> 1) * width + (width >> 1)));
      return r > 150 && g < 60 && b < 60;
    }, await shot(page, "#flat"));
    for (let tries = 0; tries < 50 && !(await isRed()); tries += 1);
    assert.ok(await isRed(), "the layout shows the image");
    await page.setInputFiles("#image", bench.file("no.png", "no image"));
    await page.locator("#problem", { hasText: "not an image" }).waitFor();
  });

  test("free what they have drawn: textures and buffers do not grow", async (t) => {
    const page = await bench.visit(t);
    await page.evaluate(() => {
      window.alive = 0;
      for (const kind of ["Texture", "Buffer"]) {
        const gl = WebGL2RenderingContext.prototype;
        const [make, free] = [gl[`create${kind}`], gl[`delete${kind}`]];
        gl[`create${kind}`] = function count() { window.alive += 1; return make.call(this); };
        gl[`delete${kind}`] = function count(it) { window.alive -= 1; return free.call(this, it); };
      }
    });
    const image = bench.file("image.png", await page.locator("header").screenshot());
    page.on("filechooser", () => {}); // the image is given to its input below
    await unwrap(page, bench.file("cube.obj", cube()));
    const round = async () => {
      for (const colouring of ["plain", "image", "charts", "image", "checker"]) {
        await page.selectOption("#colouring", colouring);
        if (colouring === "image") await page.setInputFiles("#image", image);
        await shot(page, "#flat");
      }
      await page.focus("#flat");
      await page.keyboard.press("Enter");
      await page.keyboard.press("Escape");
      await shot(page, "#flat");
      return page.evaluate(() => window.alive);
    };
    await round();
    const once = await round();
    for (let rounds = 0; rounds < 4; rounds += 1) await round();
    assert.equal(await round(), once);
  });

  test("are linked both ways by a click, and let go by Escape", async (t) => {
    const page = await bench.visit(t);
    await unwrap(page, bench.file("cube.obj", cube()));
    const picked = page.locator("#picked");
    const [solid, flat] = [await shot(page, "#solid"), await shot(page, "#flat")];
    await page.click("#solid");
    await page.locator("#picked", { hasText: /Chart \d+ of \d+: \d+ triangles?, angles 2\./ }).waitFor();
    await page.mouse.move(5, 5);
    assert.ok(await changed(page, "#flat", flat), "a click on the mesh shows in the layout");
    await page.focus("#solid");
    await page.keyboard.press("Escape");
    assert.equal(await picked.innerText(), "");
    assert.ok(await like(page, "#flat", flat));
    await page.locator("#flat").hover();
    assert.ok(await changed(page, "#solid", solid), "what is pointed at in the layout shows on the mesh");
    await page.mouse.move(5, 5);
    await page.focus("#flat");
    await page.keyboard.press("Enter");
    await page.locator("#picked", { hasText: "Chart" }).waitFor();
  });

  test("turn, move and zoom by keys", async (t) => {
    const page = await bench.visit(t);
    await unwrap(page, bench.file("cube.obj", cube()));
    for (const canvas of ["#solid", "#flat"]) {
      await page.focus(canvas);
      let last = await shot(page, canvas);
      for (const key of ["ArrowLeft", "ArrowUp", "+", "-"]) {
        await page.keyboard.press(key);
        assert.ok(await changed(page, canvas, last), `${key} in ${canvas}`);
        last = await shot(page, canvas);
      }
    }
  });

  test("show the texture coordinates that came in, beside those that came out", async (t) => {
    const page = await bench.visit(t);
    await openMesh(page, bench.file("cube.obj", cube()));
    assert.match(await page.locator("#analysis").innerText(), /1 set of texture coordinates: vt with \d islands?/);
    const before = await shot(page, "#flat");
    await page.click("#send");
    await page.locator("#result").waitFor();
    const after = await shot(page, "#flat");
    assert.ok(await difference(page, after, before, 32) > 0.05);
    await page.check("#before");
    assert.ok(await like(page, "#flat", before));
    await page.check("#after");
    assert.ok(await like(page, "#flat", after));
  });

  /** A square of a red and a green half by its image, and a blue one by its factor, as a glTF. */
  async function painted(page) {
    const png = await page.evaluate(() => {
      const canvas = Object.assign(document.createElement("canvas"), { width: 64, height: 64 });
      const pen = canvas.getContext("2d");
      [["#f00", 0], ["#0f0", 32]].forEach(([colour, x]) => { pen.fillStyle = colour; pen.fillRect(x, 0, 32, 64); });
      return canvas.toDataURL();
    });
    const floats = Float32Array.from([0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 2, 0, 0, 3, 0, 0, 3, 1, 0, 2, 1, 0, 0, 1, 1, 1, 1, 0, 0, 0]);
    const bytes = Buffer.concat([Buffer.from(floats.buffer), Buffer.from(Uint16Array.from([0, 1, 2, 0, 2, 3]).buffer)]);
    const accessor = (byteOffset, type, count, more = {}) => [{ buffer: 0, byteOffset, byteLength: count * (type === "VEC3" ? 12 : 8) },
      { bufferView: 0, componentType: 5126, count, type, ...more }];
    const parts = [accessor(0, "VEC3", 4, { min: [0, 0, 0], max: [1, 1, 0] }), accessor(48, "VEC3", 4, { min: [2, 0, 0], max: [3, 1, 0] }), accessor(96, "VEC2", 4),
      [{ buffer: 0, byteOffset: 128, byteLength: 12 }, { componentType: 5123, count: 6, type: "SCALAR" }]];
    const primitive = (POSITION, material) => ({ attributes: { POSITION, TEXCOORD_0: 2 }, indices: 3, material });
    return JSON.stringify({
      asset: { version: "2.0" }, scenes: [{ nodes: [0] }], nodes: [{ mesh: 0 }], meshes: [{ primitives: [primitive(0, 0), primitive(1, 1)] }],
      materials: [{ pbrMetallicRoughness: { baseColorTexture: { index: 0 } } }, { pbrMetallicRoughness: { baseColorFactor: [0, 0, 1, 1] } }],
      textures: [{ source: 0 }], images: [{ uri: png }], bufferViews: parts.map(([view]) => view),
      accessors: parts.map(([, one], bufferView) => ({ ...one, bufferView })),
      buffers: [{ byteLength: bytes.length, uri: `data:application/octet-stream;base64,${bytes.toString("base64")}` }],
    });
  }

  /** The shares of red, green and blue in a picture of a canvas. */
  const hues = async (page, canvas) => page.evaluate(async (bytes) => {
    const { data } = await pixelsOf(bytes);
    const counts = [0, 0, 0];
    for (let i = 0; i < data.length; i += 4)
      for (const k of [0, 1, 2]) if ([0, 1, 2].every((j) => j === k ? data[i + j] > 90 : data[i + j] < 60)) counts[k] += 4 / data.length;
    return counts;
  }, await shot(page, canvas));

  test("show materials as they came in, and where new texture coordinates put them", async (t) => {
    const page = await bench.visit(t);
    await openMesh(page, bench.file("cube.obj", cube()));
    assert.equal(await page.locator("#colouring option[value=materials]").isDisabled(), true, "this mesh has none");
    await openMesh(page, bench.file("painted.gltf", await painted(page)));
    await page.uncheck("#show-seams");
    await page.selectOption("#colouring", "materials");
    const areSeen = async (canvas, least) => {
      for (let tries = 0; tries < 40; tries += 1) if ((await hues(page, canvas)).every((share) => share > least)) return true;
      return false;
    };
    assert.ok(await areSeen("#solid", 0.02), `${await hues(page, "#solid")}`);
    await page.click("#form summary");
    await page.selectOption("[name=textures]", "transfer");
    await unwrap(page);
    assert.ok(await areSeen("#solid", 0.02), `after: ${await hues(page, "#solid")}`);
    assert.ok(await areSeen("#flat", 0.02), `after: ${await hues(page, "#flat")}`);
    const [bare] = [await shot(page, "#solid"), await page.check("#edit-islands"), await page.click("#lock-all")];
    assert.equal(await difference(page, await shot(page, "#solid"), bare), 0, "no tint of locked islands lies over materials");
    await page.check("#before");
    assert.ok(await areSeen("#solid", 0.02), `before again: ${await hues(page, "#solid")}`);
    await page.selectOption("#colouring", "plain");
    assert.ok((await hues(page, "#solid")).every((share) => share < 0.001), "other colours are without them");
    assert.deepEqual(page.complaints, []);
  });

  /** A strip of three quads whose last lies upon its first in the layout. */
  const FOLDED = ["v 0 0 0", "v 1 0 0", "v 2 0 0", "v 3 0 0", "v 0 1 0", "v 1 1 0", "v 2 1 0", "v 3 1 0",
    "vt 0.1 0.1", "vt 0.5 0.1", "vt 0.9 0.1", "vt 0.3 0.2", "vt 0.1 0.5", "vt 0.5 0.5", "vt 0.9 0.5", "vt 0.3 0.6",
    "f 1/1 2/2 6/6 5/5", "f 2/2 3/3 7/7 6/6", "f 3/3 4/4 8/8 7/7", ""].join("\n");

  test("hatch the triangles that overlap, in space and in the layout", async (t) => {
    const page = await bench.visit(t);
    await openMesh(page, bench.file("folded.obj", FOLDED));
    assert.match(await page.locator("#faults").innerText(), /^6 triangles overlap others/);
    for (const canvas of ["#solid", "#flat"]) {
      await page.check("#show-overlaps");
      const hatched = await shot(page, canvas);
      await page.uncheck("#show-overlaps");
      assert.ok(await difference(page, await shot(page, canvas), hatched) > 0.005, canvas);
    }
    await unwrap(page);
    assert.equal(await page.locator("#faults").innerText(), "");
    assert.equal(await page.locator("#overlaps-row").isVisible(), false);
    await page.check("#before");
    assert.equal(await page.locator("#overlaps-row").isVisible(), true);
  });

  test("frame the worst chart, in space and in the layout", async (t) => {
    const page = await bench.visit(t);
    await page.check("#preset-chart");
    await unwrap(page, bench.file("two.obj", `v 3 0 0\nv 4 0 0\nv 4 1 0\nf 1 2 3\n${cap(6).replace(/^f.*$/gm, (line) => line.replace(/\d+/g, (v) => Number(v) + 3))}`));
    const { charts } = await (await fetch(`${bench.server.base}/v1/jobs/${jobOf(page)}/report`)).json();
    assert.equal(charts.length, 2);
    assert.equal(await page.locator("#faults").innerText(), "The frame shows chart 2, the most distorted one.");
    for (const canvas of ["#solid", "#flat"]) {
      await page.check("#show-worst");
      const framed = await shot(page, canvas);
      await page.uncheck("#show-worst");
      assert.ok(await difference(page, await shot(page, canvas), framed) > 0.001, canvas);
    }
  });

  test("name the worst chart, notes and repairs in words", async (t) => {
    const page = await bench.visit(t);
    await page.check("#preset-chart");
    const doubled = `${cube()}f 1/1 3/2 4/3 2/4\n`;
    await unwrap(page, bench.file("doubled.obj", doubled));
    assert.match(await page.locator("#notes").innerText(), /repeated another/);
    await page.click("#charts-title");
    const first = page.locator("#charts li").first();
    await first.locator("button").click();
    assert.match(await page.locator("#picked").innerText(), /^Chart \d+/);
  });

  test("of a result give the same bytes as the API, in every format", async (t) => {
    const page = await bench.visit(t);
    await unwrap(page, bench.file("cube.obj", cube()));
    const links = { GLB: ["result", "model/gltf-binary"], OBJ: ["result", "model/obj"], "Layout (SVG)": ["layout.svg", "*/*"], "Layout (PNG)": ["layout.png", "*/*"] };
    for (const [label, [path, Accept]] of Object.entries(links)) {
      const [, bytes] = await downloaded(page, `#downloads button:has-text("${label}")`);
      const answer = await fetch(`${bench.server.base}/v1/jobs/${jobOf(page)}/${path}`, { headers: { Accept } });
      assert.ok(Buffer.from(await answer.arrayBuffer()).equals(bytes), label);
    }
    const [name, svg] = await downloaded(page, "#downloads button:has-text('Template')");
    assert.equal(name, "cube.template.svg");
    assert.match(svg.toString(), /viewBox="0 0 1024 1024"/);
  });

  test("of a result can be shared by a link and repeated by curl", async (t) => {
    const page = await bench.visit(t, { permissions: ["clipboard-read", "clipboard-write"] });
    await page.selectOption("[name=method]", "hybrid");
    await page.fill("#lambda", "0.25");
    const path = bench.file("it's cube.obj", cube());
    await unwrap(page, path);
    await page.click("#result summary:has-text('Share')");
    await page.click("#make-link");
    await page.waitForFunction(() => document.querySelector("#link").value !== "");
    const linked = Buffer.from(await (await fetch(await page.inputValue("#link"))).arrayBuffer());
    const [, bytes] = await downloaded(page, "#downloads .primary");
    assert.ok(linked.equals(bytes));
    await page.click("#copy-curl");
    const command = await page.evaluate(() => navigator.clipboard.readText());
    execFileSync("sh", ["-c", command], { cwd: bench.folder });
    assert.ok(readFileSync(`${bench.folder}/it's cube.uv.obj`).equals(bytes), command);
  });
});
