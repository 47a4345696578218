// Maps of one mesh turned and scaled so that the eye can compare them: one scale for all, by which
// UV area is the surface's area; one map upright, the others turned to it by Procrustes.
//
// A map is a list of corners, three for each triangle, in the order of the mesh's faces:
// {at: [x, y, z], uv: [u, v]}. Corners count by the area of their triangle in space.

/** A polygon's corners as those of a fan of triangles. */
const fan = (corners) => corners.slice(2).flatMap((corner, k) => [corners[0], corners[k + 1], corner]);

/** The corners of an OBJ with texture coordinates; its polygons are cut into triangles. */
export function cornersOf(obj) {
  const [positions, uvs, corners] = [[], [], []];
  for (const line of obj.split("\n")) {
    const [word, ...rest] = line.trim().split(/\s+/);
    if (word === "v") positions.push(rest.slice(0, 3).map(Number));
    if (word === "vt") uvs.push(rest.slice(0, 2).map(Number));
    if (word !== "f") continue;
    const polygon = rest.map((corner) => corner.split("/").map(Number));
    corners.push(...fan(polygon.map(([v, t]) => ({ at: positions[v - 1], uv: uvs[t - 1] }))));
  }
  return corners;
}

/** The chart of each triangle of cornersOf(), named by its first face: faces that share texture coordinates are of one chart. */
export function chartsOf(obj) {
  const faces = [...obj.matchAll(/^f (.*)$/gm)].map(([, face]) => face.trim().split(/\s+/).map((corner) => Number(corner.split("/")[1])));
  const of = [];
  const rootOf = (t) => {
    while ((of[t] ?? t) !== t) t = of[t] = of[of[t]] ?? of[t];
    return t;
  };
  for (const [a, ...others] of faces) for (const b of others) of[rootOf(b)] = rootOf(a);
  const first = new Map();
  return faces.flatMap((face, f) => {
    const root = rootOf(face[0]);
    if (!first.has(root)) first.set(root, f);
    return Array(face.length - 2).fill(first.get(root));
  });
}

/** Rotations that bring an axis of a mesh up, to +Y. */
const RAISED = {
  y: ([x, y, z]) => [x, y, z], "-y": ([x, y, z]) => [-x, -y, z],
  x: ([x, y, z]) => [-y, x, z], "-x": ([x, y, z]) => [y, -x, z],
  z: ([x, y, z]) => [x, z, -y], "-z": ([x, y, z]) => [x, -z, y],
};

/** An OBJ turned so that this axis is up. Throws where there is no such axis. */
export function raised(obj, axis) {
  const turn = RAISED[axis];
  if (!turn) throw new Error(`up is one of ${Object.keys(RAISED).join(", ")}, not ${axis}`);
  return obj.replace(/^(\s*vn?)((?:\s+\S+){3})/gm, (_, word, numbers) => {
    const turned = turn(numbers.trim().split(/\s+/).map(Number));
    return `${word} ${turned.map((number) => number + 0).join(" ")}`;
  });
}

const minus = (a, b) => a.map((x, k) => x - b[k]);
const length = (a) => Math.hypot(...a);

function areaInSpace([a, b, c]) {
  const [p, q] = [minus(b.at, a.at), minus(c.at, a.at)];
  return length([p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0]]) / 2;
}

function areaOnPage([a, b, c]) {
  const [p, q] = [minus(b.uv, a.uv), minus(c.uv, a.uv)];
  return Math.abs(p[0] * q[1] - p[1] * q[0]) / 2;
}

/** The triangles' sum of what `of` says of each. */
function sumOver(corners, of) {
  let sum = 0;
  for (let t = 0; t < corners.length; t += 3) sum += of(corners.slice(t, t + 3));
  return sum;
}

const weightsOf = (corners) =>
  corners.map((_, k) => areaInSpace(corners.slice(k - (k % 3), k - (k % 3) + 3)));

function middleOf(corners, weights) {
  const sum = [0, 0, 0];
  corners.forEach(({ uv }, k) => [uv[0], uv[1], 1].forEach((x, i) => (sum[i] += weights[k] * x)));
  return [sum[0] / sum[2], sum[1] / sum[2]];
}

/** By what UVs are multiplied so that their area is the surface's. */
export function scaleOf(corners) {
  return Math.sqrt(sumOver(corners, areaInSpace) / sumOver(corners, areaOnPage));
}

/**
 * The rotation in radians, counterclockwise, by which `map` comes nearest to `reference` in least
 * squares (orthogonal Procrustes in the plane, without reflection): of both maps about their middles,
 * the angle of sum w conj(z) r, z and r as complex numbers.
 */
export function turnTo(reference, map) {
  const weights = weightsOf(reference);
  const [a, b] = [middleOf(map, weights), middleOf(reference, weights)];
  let [along, across] = [0, 0];
  map.forEach(({ uv }, k) => {
    const [z, r] = [minus(uv, a), minus(reference[k].uv, b)];
    along += weights[k] * (z[0] * r[0] + z[1] * r[1]);
    across += weights[k] * (z[0] * r[1] - z[1] * r[0]);
  });
  return Math.atan2(across, along);
}

/** The rotation by which what is higher on the mesh is higher on the page: heights grow along V. */
export function turnUpright(map, heightOf = ([, y]) => y) {
  const weights = weightsOf(map);
  const middle = middleOf(map, weights);
  const all = weights.reduce((sum, w) => sum + w, 0);
  const mean = map.reduce((sum, { at }, k) => sum + weights[k] * heightOf(at), 0) / all;
  const rise = [0, 0];
  map.forEach(({ at, uv }, k) =>
    minus(uv, middle).forEach((x, i) => (rise[i] += weights[k] * (heightOf(at) - mean) * x)));
  return length(rise) > 0 ? Math.PI / 2 - Math.atan2(rise[1], rise[0]) : 0;
}

/** Where a map is drawn: p = scale * (rotation by turn) * (uv - middle). */
export function placeOf(map, turn) {
  return { turn, scale: scaleOf(map), middle: middleOf(map, weightsOf(map)) };
}

export function placed({ turn, scale, middle }, uv) {
  const [x, y] = minus(uv, middle);
  const [c, s] = [scale * Math.cos(turn), scale * Math.sin(turn)];
  return [c * x - s * y, s * x + c * y];
}

/** The middles of squares of these sides, beside each other in rows, and the side of the square around (0, 0) that holds all. */
export function cellsOf(sides) {
  const across = Math.max(...sides, Math.sqrt(sides.reduce((sum, side) => sum + side * side, 0)));
  const largestFirst = sides.map((_, k) => k).sort((a, b) => sides[b] - sides[a]);
  const [middles, height] = [[], { row: 0, all: 0 }];
  let x = 0;
  for (const k of largestFirst) {
    if (x > 0 && x + sides[k] > across * (1 + 1e-9)) [x, height.all, height.row] = [0, height.all + height.row, 0];
    if (x === 0) height.row = sides[k];
    middles[k] = [x + sides[k] / 2, height.all + sides[k] / 2];
    x += sides[k];
  }
  const side = Math.max(across, height.all + height.row);
  return { middles: middles.map(([a, b]) => [a - side / 2, side / 2 - b]), side };
}

/**
 * The places of maps that have corners (others are null), all turned to the map `upright`, which
 * stands upright; and the side of the square around (0, 0) that holds all of them.
 */
export function alignedPlaces(maps, upright) {
  const reference = maps[upright];
  const own = turnUpright(reference);
  const places = maps.map((map) => map && placeOf(map, turnTo(reference, map) + own));
  let half = 0;
  maps.forEach((map, k) => {
    for (const { uv } of map ?? [])
      for (const x of placed(places[k], uv)) half = Math.max(half, Math.abs(x));
  });
  return { places, side: 2 * half };
}
