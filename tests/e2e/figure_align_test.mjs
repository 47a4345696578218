// How ./dev figure turns maps to each other, held against formulas that it does not use: a search
// over all angles, and the singular value decomposition of the plane (Kabsch) in closed form.
import assert from "node:assert/strict";
import { test } from "node:test";

import { chartFinder } from "../../client/figure.mjs";
import { alignedPlaces, cellsOf, chartsOf, cornersOf, placed, raised, scaleOf, turnTo, turnUpright } from "../../client/align.mjs";

/** Repeatable numbers in [0, 1). */
function numbers(seed) {
  let state = seed;
  return () => (state = (state * 1103515245 + 12345) % 2 ** 31) / 2 ** 31;
}

/** n x n quads, bent in space; their map is bent another way. */
function patch(n, seed) {
  const next = numbers(seed);
  const [bend, shear, ...waves] = Array.from({ length: 6 }, next);
  const corner = (x, y) => ({
    at: [x, y, bend * x * x - y * y],
    uv: [x + shear * y + 0.1 * Math.sin(waves[0] + 3 * y), 0.7 * y + 0.2 * waves[1] * x * x],
  });
  const corners = [];
  for (let i = 0; i < n; i += 1)
    for (let j = 0; j < n; j += 1)
      for (const [a, b] of [[0, 0], [1, 0], [1, 1], [0, 0], [1, 1], [0, 1]]) corners.push(corner((i + a) / n, (j + b) / n));
  return corners;
}

const turned = (corners, angle, scale = 1, [x, y] = [0, 0]) => {
  const [c, s] = [Math.cos(angle), Math.sin(angle)];
  return corners.map(({ at, uv }) => ({ at, uv: [scale * (c * uv[0] - s * uv[1]) + x, scale * (s * uv[0] + c * uv[1]) + y] }));
};

const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const areaAt = (corners, k) => {
  const [a, b, c] = [0, 1, 2].map((i) => corners[k - (k % 3) + i].at);
  return Math.hypot(...cross(b.map((x, i) => x - a[i]), c.map((x, i) => x - a[i]))) / 2;
};

/** Weighted and about its middle. */
function centred(corners) {
  const weight = corners.map((_, k) => areaAt(corners, k));
  const all = weight.reduce((a, b) => a + b);
  const middle = [0, 1].map((i) => corners.reduce((sum, { uv }, k) => sum + weight[k] * uv[i], 0) / all);
  return { weight, uv: corners.map(({ uv }) => uv.map((x, i) => x - middle[i])) };
}

function misfit(reference, map, angle) {
  const [r, m] = [centred(reference), centred(turned(map, angle))];
  return r.uv.reduce((sum, uv, k) => sum + r.weight[k] * ((uv[0] - m.uv[k][0]) ** 2 + (uv[1] - m.uv[k][1]) ** 2), 0);
}

const apart = (a, b) => Math.abs(Math.atan2(Math.sin(a - b), Math.cos(a - b)));

test("a map that was turned, scaled and moved is turned back", () => {
  for (let k = 0; k < 20; k += 1) {
    const [reference, angle] = [patch(5, k + 1), -Math.PI + 0.31 * k];
    assert.ok(apart(turnTo(reference, turned(reference, angle, 0.2 + k, [k, -3])), -angle) < 1e-9, `${angle}`);
  }
});

test("no other angle brings a map nearer, by a search over all of them", () => {
  for (let k = 0; k < 6; k += 1) {
    const [reference, map] = [patch(4, k + 1), turned(patch(4, k + 50), 1.1 * k)];
    const found = turnTo(reference, map);
    const least = misfit(reference, map, found);
    for (let step = 0; step < 720; step += 1) assert.ok(misfit(reference, map, (step * Math.PI) / 360) >= least - 1e-12);
    for (const near of [-1e-3, 1e-3]) assert.ok(misfit(reference, map, found + near) > least);
  }
});

/** Kabsch: of the covariance H = U S V^T the rotation is V diag(1, det) U^T. In the plane, by eigenvectors of H^T H. */
function byKabsch(reference, map) {
  const [r, m] = [centred(reference), centred(map)];
  const h = [[0, 0], [0, 0]];
  m.uv.forEach((uv, k) => uv.forEach((x, i) => r.uv[k].forEach((y, j) => (h[i][j] += r.weight[k] * x * y))));
  const [a, b, d] = [h[0][0] ** 2 + h[1][0] ** 2, h[0][0] * h[0][1] + h[1][0] * h[1][1], h[0][1] ** 2 + h[1][1] ** 2];
  const tilt = Math.atan2(2 * b, a - d) / 2;
  const v = [[Math.cos(tilt), Math.sin(tilt)], [-Math.sin(tilt), Math.cos(tilt)]]; // rows: right singular vectors
  const u = v.map((x) => [0, 1].map((i) => h[i][0] * x[0] + h[i][1] * x[1])).map((x) => x.map((y) => y / Math.hypot(...x)));
  const sign = Math.sign((v[0][0] * v[1][1] - v[0][1] * v[1][0]) * (u[0][0] * u[1][1] - u[0][1] * u[1][0]));
  const entry = (i, j) => v[0][i] * u[0][j] + sign * v[1][i] * u[1][j];
  return Math.atan2(entry(1, 0), entry(0, 0));
}

test("the rotation is that of Kabsch", () => {
  for (let k = 0; k < 40; k += 1) {
    const [reference, map] = [patch(4, k + 1), turned(patch(4, k + 100), 0.7 * k, 3)];
    assert.ok(apart(turnTo(reference, map), byKabsch(reference, map)) < 1e-9);
  }
});

test("what is higher on the mesh is higher on the page, and all maps have the surface's area", () => {
  for (let k = 0; k < 8; k += 1) {
    const map = turned(patch(5, k + 1), 0.9 * k, 0.1 + k);
    const upright = turned(map, turnUpright(map));
    const { weight, uv } = centred(upright);
    const all = weight.reduce((a, b) => a + b);
    const mean = upright.reduce((sum, { at }, i) => sum + weight[i] * at[1], 0) / all;
    const [across, along] = [0, 1].map((i) => uv.reduce((sum, p, c) => sum + weight[c] * p[i] * (upright[c].at[1] - mean), 0));
    assert.ok(along > 0 && Math.abs(across) < 1e-9 * along);
    const scaled = turned(map, 0, scaleOf(map));
    let [page, space] = [0, 0];
    for (let t = 0; t < scaled.length; t += 3) {
      const [a, b, c] = scaled.slice(t, t + 3).map(({ uv: own }) => own);
      page += Math.abs((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])) / 2;
      space += areaAt(scaled, t);
    }
    assert.ok(Math.abs(page / space - 1) < 1e-9);
  }
});

test("copies of a map lie on each other, whatever was done to them, and a map that failed has no place", () => {
  const map = patch(5, 7);
  const maps = [turned(map, 2, 3, [1, 1]), null, map, turned(map, -1, 0.1, [0, 5])];
  const { places, side } = alignedPlaces(maps, 2);
  assert.equal(places[1], null);
  map.forEach((_, k) => {
    const [a, b, c] = [0, 2, 3].map((m) => placed(places[m], maps[m][k].uv));
    assert.ok(Math.max(Math.hypot(a[0] - b[0], a[1] - b[1]), Math.hypot(c[0] - b[0], c[1] - b[1])) < 1e-9);
    assert.ok(Math.max(...b.map(Math.abs)) <= side / 2 + 1e-12);
  });
});

test("corners are read from an OBJ", () => {
  const obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0.5 0.25\nvt 1 0\nvt 0 1\nf 1/1 2/2 3/3\nf 3/3/1 2/2/1 1/1/1\n";
  const corners = cornersOf(obj);
  assert.deepEqual(corners[0], { at: [0, 0, 0], uv: [0.5, 0.25] });
  assert.deepEqual(corners.map(({ at }) => at.join()), ["0,0,0", "1,0,0", "0,1,0", "0,1,0", "1,0,0", "0,0,0"]);
  const polygon = cornersOf(`${obj}v 1 1 0\nf 1/1 2/2 4/3 3/3\n`).slice(6);
  assert.deepEqual(polygon.map(({ at }) => at.join()), ["0,0,0", "1,0,0", "1,1,0", "0,0,0", "1,1,0", "0,1,0"], "a polygon is a fan");
});

test("triangles that share texture coordinates are of one chart, named by its first", () => {
  const faces = [[1, 2, 3], [4, 5, 6], [2, 3, 7], [8, 9, 10], [6, 5, 11], [10, 12, 7], [13, 14, 15]];
  const obj = faces.map((face) => `f ${face.map((t) => `9/${t}/1`).join(" ")}`).join("\n");
  assert.deepEqual(chartsOf(obj), [0, 1, 0, 0, 1, 0, 6]);
  assert.deepEqual(chartsOf("f 1/1 2/2 3/3 4/4\nf 5/5 6/6 7/7\nf 1/4 2/2 8/8"), [0, 0, 1, 0], "a polygon has several triangles");
});

test("squares lie beside each other in a square that is little larger than they are", () => {
  for (let k = 1; k < 40; k += 1) {
    const next = numbers(k);
    const sides = Array.from({ length: 1 + (k % 13) }, () => 0.1 + next());
    const { middles, side } = cellsOf(sides);
    middles.forEach(([x, y], i) => {
      for (const c of [x, y]) assert.ok(Math.abs(c) + sides[i] / 2 < side / 2 + 1e-9, "none lies beyond");
      middles.slice(0, i).forEach(([u, v], j) =>
        assert.ok(Math.max(Math.abs(u - x), Math.abs(v - y)) > (sides[i] + sides[j]) / 2 - 1e-9, `${i} lies on ${j}`));
    });
    assert.ok(side * side < 3 * sides.reduce((sum, s) => sum + s * s, 0) + 1e-9, `${sides}`);
  }
});

test("a point of the layout is of the chart whose corner is the nearest", () => {
  const next = numbers(5);
  const corners = Array.from({ length: 600 }, () => ({ uv: [next(), next()] }));
  const charts = Array.from({ length: 200 }, (_, t) => t % 7);
  const chartAt = chartFinder({ corners, charts });
  for (let k = 0; k < 300; k += 1) {
    const at = [next(), next()].map((x) => Math.round(40_960 * x));
    const distances = corners.map(({ uv }) => Math.hypot(uv[0] * 40_960 - at[0], uv[1] * 40_960 - at[1]));
    assert.equal(chartAt(...at), charts[Math.floor(distances.indexOf(Math.min(...distances)) / 3)]);
  }
});

test("any axis of an OBJ is brought up by a rotation", () => {
  const axes = { x: [1, 0, 0], y: [0, 1, 0], z: [0, 0, 1] };
  for (const sign of ["", "-"])
    for (const [name, axis] of Object.entries(axes)) {
      const frame = [axis.map((c) => (sign ? -c : c)), [1, 2, 3], [4, -1, 0.5]];
      const text = `${frame.map((p) => `v ${p.join(" ")} 1 0 0`).join("\n")}\nvn 0 0 1\nvt 0 1\nf 1 2 3\n`;
      const lines = raised(text, sign + name).split("\n");
      assert.match(lines[0], /^v 0 1 0 1 0 0$/, "and colours stay");
      const turned = lines.slice(0, 3).map((line) => line.split(" ").slice(1, 4).map(Number));
      const volume = ([a, b, c]) => a[0] * cross(b, c)[0] + a[1] * cross(b, c)[1] + a[2] * cross(b, c)[2];
      assert.ok(Math.abs(volume(turned) - volume(frame)) < 1e-12, "no reflection");
      assert.deepEqual(lines.slice(4), ["vt 0 1", "f 1 2 3", ""]);
    }
  assert.throws(() => raised("v 0 0 0", "up"), /up is one of y/);
});
