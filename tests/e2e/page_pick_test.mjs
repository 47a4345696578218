// What lies under a pointer, held against every face by formulas that the page does not use.
import assert from "node:assert/strict";
import { existsSync, readFileSync } from "node:fs";
import { test } from "node:test";
import { fileURLToPath } from "node:url";

const typescript = fileURLToPath(new URL("../node_modules/typescript/lib/typescript.js", import.meta.url));
const skip = !existsSync(typescript) && "run npm ci in tests/";

async function pickOfThePage() {
  const { default: ts } = await import(typescript);
  const source = readFileSync(new URL("../../client/web/src/view/pick.ts", import.meta.url), "utf8");
  const { outputText } = ts.transpileModule(source, { compilerOptions: { module: "esnext", target: "es2022" } });
  return import(`data:text/javascript,${encodeURIComponent(outputText)}`);
}

/** Repeatable numbers in [-1, 1). */
function numbers(seed) {
  let state = seed;
  return () => (state = (state * 1103515245 + 12345) % 2 ** 31) / 2 ** 30 - 1;
}

/** Small triangles here and there. */
function soup(faces, next, isFlat) {
  const positions = new Float32Array(9 * faces);
  for (let f = 0; f < faces; f += 1) {
    const middle = [next(), next(), isFlat ? 0 : next()];
    for (let i = 0; i < 9; i += 1) positions[9 * f + i] = middle[i % 3] + (isFlat && i % 3 === 2 ? 0 : 0.6 * next());
  }
  return positions;
}

const corner = (values, size, c) => Array.from(values.slice(size * c, size * (c + 1)));
const minus = (a, b) => a.map((x, i) => x - b[i]);
const det = ([a, b, c]) =>
  a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0]) + a[2] * (b[0] * c[1] - b[1] * c[0]);

/** By Cramer's rule: o + t d = a + u (b - a) + v (c - a). */
function nearestOfAll(positions, o, d) {
  let best = { face: -1, distance: Infinity };
  for (let f = 0; f < positions.length / 9; f += 1) {
    const [a, b, c] = [0, 1, 2].map((k) => corner(positions, 3, 3 * f + k));
    const [e, g, r] = [minus(b, a), minus(c, a), minus(o, a)];
    const all = det([e, g, d.map((x) => -x)]);
    if (all === 0) continue;
    const [u, v, t] = [det([r, g, d.map((x) => -x)]) / all, det([e, r, d.map((x) => -x)]) / all, det([e, g, r]) / all];
    if (u >= 0 && v >= 0 && u + v <= 1 && t > 0 && t < best.distance) best = { face: f, distance: t };
  }
  return best;
}

/** By angles: those at which a point sees the corners of a triangle around it turn once. */
function lastAround(uv, x, y) {
  for (let f = uv.length / 6 - 1; f >= 0; f -= 1) {
    const angles = [0, 1, 2].map((k) => Math.atan2(uv[6 * f + 2 * k + 1] - y, uv[6 * f + 2 * k] - x));
    const turn = angles.reduce((sum, angle, k) => sum + Math.atan2(Math.sin(angles[(k + 1) % 3] - angle), Math.cos(angles[(k + 1) % 3] - angle)), 0);
    if (Math.abs(turn) > Math.PI) return f;
  }
  return -1;
}

test("the nearest face along a ray is that of a search through all of them", { skip }, async () => {
  const { boxesOf, faceAlong } = await pickOfThePage();
  let hits = 0;
  for (let k = 1; k <= 40; k += 1) {
    const next = numbers(k);
    const positions = soup(1 + ((k * 37) % 400), next, k % 4 === 0);
    const boxes = boxesOf(positions, 3);
    for (let ray = 0; ray < 100; ray += 1) {
      const [o, d] = [[2 * next(), 2 * next(), 2 * next()], [next(), next(), next()]];
      if (ray % 5 === 0) d[ray % 3] = 0;
      const [seen, wanted] = [faceAlong(positions, boxes, o, d), nearestOfAll(positions, o, d)];
      assert.ok(seen.distance === wanted.distance || Math.abs(seen.distance - wanted.distance) < 1e-9 * wanted.distance, `mesh ${k}, ray ${ray}`);
      if (k % 4 !== 0) assert.equal(seen.face, wanted.face, "in a flat mesh several are as near");
      hits += seen.face >= 0;
    }
  }
  assert.ok(hits > 500, `${hits} rays met a face`);
});

test("the face around a point of the page is the last of all that are", { skip }, async () => {
  const { boxesOf, faceAround } = await pickOfThePage();
  let hits = 0;
  for (let k = 1; k <= 40; k += 1) {
    const next = numbers(k);
    const positions = soup(1 + ((k * 53) % 400), next, true);
    const uv = positions.filter((_, i) => i % 3 !== 2);
    const boxes = boxesOf(uv, 2);
    for (let point = 0; point < 100; point += 1) {
      const [x, y] = [1.2 * next(), 1.2 * next()];
      assert.equal(faceAround(uv, boxes, x, y), lastAround(uv, x, y), `mesh ${k}, ${x} ${y}`);
      hits += lastAround(uv, x, y) >= 0;
    }
  }
  assert.ok(hits > 2000, `${hits} points lie in a face`);
});
