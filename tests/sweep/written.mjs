// What an answer's texture coordinates are worth, counted over every triangle of the file as it is
// written. Nothing here knows the program: OBJ and glTF are read by a few lines of their own. UVs are
// multiples of 2^-24 in [0, 1], so that in these units products of two differences stay below 2^53
// and every orientation is exact.
const STEP = 2 ** -24;
const THIN = 1e-5; // a triangle's height over its longest side, below which D is not taken of it
const FLAT = 2 ** -48; // a height below this share of the mesh's reach is none: rounding makes it

/**
 * Triangles {at: [x, y, z] * 3, uv: [u, v] * 3 in steps, V up} of an OBJ. Polygons are cut into fans
 * from their corner number `from`.
 */
export function trianglesOfObj(text, from = 0) {
  const points = [];
  const coordinates = [];
  const triangles = [];
  for (const line of text.split("\n")) {
    const [keyword, ...words] = line.trim().split(/\s+/);
    if (keyword === "v") points.push(words.slice(0, 3).map(Number));
    if (keyword === "vt") coordinates.push(words.slice(0, 2).map((word) => inSteps(Number(word))));
    if (keyword !== "f") continue;
    const corners = words.filter((word) => !word.startsWith("#")).map((word) => word.split("/"));
    const n = corners.length;
    const corner = (i) => corners[(i + from) % n];
    for (let i = 2; i < n; ++i) {
      const three = [corner(0), corner(i - 1), corner(i)];
      triangles.push({
        at: three.map(([v]) => points.at(v > 0 ? v - 1 : v)),
        uv: three.map(([, vt]) => coordinates[vt - 1]),
      });
    }
  }
  return triangles;
}

function inSteps(value) {
  const steps = value / STEP;
  if (!Number.isInteger(steps)) throw new Error(`${value} is no multiple of 2^-24`);
  return steps;
}

const COMPONENTS = {
  5120: [1, "getInt8", 127],
  5121: [1, "getUint8", 255],
  5122: [2, "getInt16", 32767],
  5123: [2, "getUint16", 65535],
  5125: [4, "getUint32", 1],
  5126: [4, "getFloat32", 1],
};
const SIZES = { SCALAR: 1, VEC2: 2, VEC3: 3, VEC4: 4 };

function openGltf(bytes) {
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  if (view.getUint32(0, true) !== 0x46546c67) {
    const json = JSON.parse(new TextDecoder().decode(bytes));
    const buffers = (json.buffers ?? []).map(({ uri }) => Buffer.from(uri.split(",")[1], "base64"));
    return { json, buffers };
  }
  const length = view.getUint32(12, true);
  const json = JSON.parse(new TextDecoder().decode(bytes.subarray(20, 20 + length)));
  return { json, buffers: [bytes.subarray(28 + length)] };
}

function rows({ json, buffers }, viewIndex, offset, count, type, componentType) {
  const [size, getter] = COMPONENTS[componentType];
  const view = json.bufferViews[viewIndex];
  const bytes = buffers[view.buffer];
  const data = new DataView(bytes.buffer, bytes.byteOffset + (view.byteOffset ?? 0) + offset);
  const width = SIZES[type];
  const stride = view.byteStride ?? width * size;
  return Array.from({ length: count }, (_, i) =>
    Array.from({ length: width }, (_, k) => data[getter](i * stride + k * size, true)),
  );
}

function elements(file, index) {
  const accessor = file.json.accessors[index];
  const { bufferView, byteOffset, count, type, componentType, sparse, normalized } = accessor;
  const values =
    bufferView === undefined
      ? Array.from({ length: count }, () => new Array(SIZES[type]).fill(0))
      : rows(file, bufferView, byteOffset ?? 0, count, type, componentType);
  if (sparse) {
    const { indices, values: news } = sparse;
    const part = ({ bufferView: view, byteOffset: offset = 0 }, width, component) =>
      rows(file, view, offset, sparse.count, width, component);
    const at = part(indices, "SCALAR", indices.componentType);
    const by = part(news, type, componentType);
    at.forEach(([i], k) => (values[i] = by[k]));
  }
  const largest = COMPONENTS[componentType][2];
  return normalized ? values.map((row) => row.map((x) => Math.max(x / largest, -1))) : values;
}

function cornersOf(indices, mode) {
  const triples = [];
  for (let i = 0; i + 2 < indices.length; i += mode === 4 ? 3 : 1) {
    const [a, b, c] = indices.slice(i, i + 3);
    if (mode === 4) triples.push([a, b, c]);
    if (mode === 5) triples.push(i % 2 ? [a, c, b] : [a, b, c]);
    if (mode === 6) triples.push([b, c, indices[0]]);
  }
  return triples;
}

/** How large nodes show a mesh that they scale alike in all directions: the largest of all. */
function scaleInScene({ nodes = [] }, mesh) {
  const parent = new Map(nodes.flatMap(({ children = [] }, i) => children.map((child) => [child, i])));
  const own = ({ matrix, scale = [1, 1, 1] }) => (matrix ? Math.hypot(...matrix.slice(0, 3)) : scale[0]);
  const inScene = (i) => own(nodes[i]) * (parent.has(i) ? inScene(parent.get(i)) : 1);
  const scales = nodes.flatMap((node, i) => (node.mesh === mesh && node.skin === undefined ? [inScene(i)] : []));
  return Math.max(...scales.map(Math.abs).filter((scale) => scale > 0), 0) || 1;
}

/** The same of a GLB or glTF with nothing compressed, at the size at which nodes show it. */
export function trianglesOfGltf(bytes, texcoord = 0) {
  const set = `TEXCOORD_${texcoord}`;
  const file = openGltf(bytes);
  const triangles = [];
  for (const [mesh, { primitives }] of file.json.meshes.entries())
    for (const { attributes, indices, mode = 4 } of primitives) {
      if (mode < 4 || attributes[set] === undefined) continue;
      const scale = scaleInScene(file.json, mesh);
      const points = elements(file, attributes.POSITION).map((point) => point.map((x) => scale * x));
      const coordinates = elements(file, attributes[set]).map(([u, v]) => [u, 1 - v].map(inSteps));
      const inOrder = () => points.map((_, i) => i);
      const order = indices === undefined ? inOrder() : elements(file, indices).map(([i]) => i);
      for (const triple of cornersOf(order, mode))
        triangles.push({ at: triple.map((i) => points[i]), uv: triple.map((i) => coordinates[i]) });
    }
  return triangles;
}

const turn = ([ax, ay], [bx, by], [cx, cy]) => (bx - ax) * (cy - ay) - (by - ay) * (cx - ax);

/** A triangle that is there twice, at the same places of space and page, counts once. */
function distinct(triangles) {
  const seen = new Map();
  for (const triangle of triangles) {
    const corners = [0, 1, 2].map((i) => `${triangle.at[i]};${triangle.uv[i]}`);
    const low = corners.indexOf([...corners].sort()[0]);
    seen.set([0, 1, 2].map((i) => corners[(low + i) % 3]).join("|"), triangle);
  }
  return [...seen.values()];
}

const minus = (a, b) => a.map((x, k) => x - b[k]);
const dot = (a, b) => a.reduce((sum, x, k) => sum + x * b[k], 0);

function areaInSpace([a, b, c]) {
  const [u, v] = [minus(b, a), minus(c, a)];
  const cross = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
  return Math.hypot(...cross) / 2;
}

const longestSide = (at) => Math.max(...[0, 1, 2].map((i) => Math.hypot(...minus(at[i], at[(i + 1) % 3]))));

function isFlat(at, reach) {
  const longest = longestSide(at);
  return !(longest > 0) || (2 * areaInSpace(at)) / longest <= FLAT * reach;
}

const isThin = ({ at }) => !(2 * areaInSpace(at) >= THIN * longestSide(at) ** 2);

/** Whether the line of some edge of one has all of the other behind it (both are counter-clockwise). */
const isApart = (a, b) =>
  [0, 1, 2].some((i) => b.every((point) => turn(a[i], a[(i + 1) % 3], point) <= 0));

/** Pairs of triangles of the page whose interiors meet. */
function overlappingPairs(all) {
  const cells = Math.max(1, Math.floor(Math.sqrt(all.length)));
  const cell = (x) => Math.min(cells - 1, Math.max(0, Math.floor((x * STEP) * cells)));
  const range = (values) => [Math.min(...values), Math.max(...values)];
  const boxes = all.map((uv) => [0, 1].map((k) => range(uv.map((p) => p[k]))));
  const bins = new Map();
  let pairs = 0;
  all.forEach((uv, t) => {
    const [[left, right], [low, high]] = boxes[t];
    for (let x = cell(left); x <= cell(right); ++x)
      for (let y = cell(low); y <= cell(high); ++y) {
        const bin = bins.get(x * cells + y) ?? [];
        for (const s of bin) {
          const [[l], [b]] = boxes[s];
          if (x !== cell(Math.max(l, left)) || y !== cell(Math.max(b, low))) continue; // counted elsewhere
          if (!isApart(uv, all[s]) && !isApart(all[s], uv)) ++pairs;
        }
        bin.push(t);
        bins.set(x * cells + y, bin);
      }
  });
  return pairs;
}

/** Whether a triangle without area lies on one edge or point of those that have some. */
function liesOnAnEdge(uv, edges) {
  const points = [...new Set(uv.map(String))];
  return points.length === 1 || (points.length === 2 && edges.has([...points].sort().join(" ")));
}

/**
 * D_angle and D_area (Sec. 6 of the paper) from the Frobenius norm and |determinant| of each map;
 * stretch is the root mean square of the inverse singular values at equal areas.
 */
function distortionOf(triangles) {
  const sum = { area: 0, image: 0, inverse: 0, angle: 0, stretch: 0 };
  for (const { at, uv } of triangles) {
    const [u, v] = [minus(at[1], at[0]), minus(at[2], at[0])];
    const [p, q] = [minus(uv[1], uv[0]), minus(uv[2], uv[0])].map((d) => d.map((x) => x * STEP));
    const area = areaInSpace(at);
    const length = Math.hypot(...u);
    const [x, y] = [dot(u, v) / length, (2 * area) / length];
    const first = p.map((c) => c / length);
    const second = q.map((c, k) => (c - first[k] * x) / y);
    const det = Math.abs(first[0] * second[1] - first[1] * second[0]);
    sum.area += area;
    sum.image += area * det;
    sum.inverse += area / det;
    const norm = dot(first, first) + dot(second, second);
    sum.angle += (area * norm) / det;
    sum.stretch += (area * norm) / det ** 2 / 2;
  }
  return {
    angle: sum.angle / sum.area,
    area: 1 + (sum.image * sum.inverse) / sum.area ** 2,
    stretch: Math.sqrt(sum.image * sum.stretch) / sum.area,
  };
}

/** Of what has an area in space, the length on the page for one in space, by areas. */
function densityOf(triangles) {
  const total = (of) => triangles.reduce((sum, triangle) => sum + of(triangle), 0);
  return STEP * Math.sqrt(total(({ uv }) => Math.abs(turn(...uv)) / 2) / total(({ at }) => areaInSpace(at)));
}

/**
 * Counts over all triangles: flipped ones; `lost`, without area on the page though they have some in
 * space; `stray`, without area on the page but not on an edge or point of others; overlapping
 * pairs; the area that is covered; D and stretch; the density.
 */
export function measure(triangles) {
  const all = distinct(triangles);
  const reach = all.reduce((most, { at }) => Math.max(most, ...at.flat().map(Math.abs)), 0);
  const signs = all.map(({ uv }) => Math.sign(turn(...uv)));
  const up = all.filter((_, t) => signs[t] > 0);
  const empty = all.filter((_, t) => signs[t] === 0);
  const edgesOf = ({ uv }) => [0, 1, 2].map((i) => [uv[i], uv[(i + 1) % 3]].map(String).sort().join(" "));
  const edges = new Set(up.flatMap(edgesOf));
  return {
    triangles: all.length,
    flipped: signs.filter((sign) => sign < 0).length,
    lost: empty.filter(({ at }) => !isFlat(at, reach)).length,
    stray: empty.filter(({ uv }) => !liesOnAnEdge(uv, edges)).length,
    overlaps: overlappingPairs(up.map(({ uv }) => uv)),
    covered: up.reduce((sum, { uv }) => sum + turn(...uv), 0) * (STEP ** 2 / 2),
    distortion: distortionOf(all.filter((face, t) => signs[t] !== 0 && !isThin(face))),
    density: densityOf(all.filter(({ at }) => !isFlat(at, reach))),
  };
}
