// A scene of many meshes, each a surface of its own: bodies of bumps, closed or with a hole, of a few
// hundred to a few thousand faces. The same for the same numbers.

/** A generator of numbers in [0, 1). */
function random(seed) {
  let state = seed >>> 0;
  return () => {
    state = (Math.imul(state, 1664525) + 1013904223) >>> 0;
    return state / 2 ** 32;
  };
}

/** A sphere of rings with bumps; every third one has no caps. */
function body(rings, seed) {
  const next = random(seed * 7919 + 17);
  for (let k = 0; k < 8; k++) next();
  const waves = Array.from({ length: 5 }, () => [1 + Math.floor(4 * next()), 1 + Math.floor(4 * next()), 6.28 * next(), 0.05 + 0.12 * next()]);
  const sides = 2 * rings;
  const open = seed % 3 === 2;
  const positions = [];
  const point = (theta, phi) => {
    let r = 1;
    for (const [m, n, shift, height] of waves) r += height * Math.sin(m * theta + shift) * Math.cos(n * phi + shift) * Math.sin(theta);
    positions.push(r * Math.sin(theta) * Math.cos(phi), r * Math.sin(theta) * Math.sin(phi), r * Math.cos(theta));
  };
  for (let i = 1; i < rings; i++) for (let k = 0; k < sides; k++) point((Math.PI * i) / rings, (2 * Math.PI * k) / sides);
  const faces = [];
  const at = (i, k) => (i - 1) * sides + (k % sides);
  for (let i = 1; i < rings - 1; i++)
    for (let k = 0; k < sides; k++) faces.push(at(i, k), at(i + 1, k), at(i + 1, k + 1), at(i, k), at(i + 1, k + 1), at(i, k + 1));
  if (!open) {
    const north = positions.length / 3;
    point(0, 0);
    point(Math.PI, 0);
    for (let k = 0; k < sides; k++) faces.push(north, at(1, k), at(1, k + 1), north + 1, at(rings - 1, k + 1), at(rings - 1, k));
  }
  return { positions, faces };
}

/** The bytes of a GLB with `count` meshes of 4 * rings * rings faces each, the rings in [least, most]. generator: what makes it another file. */
export function scene(count, least = 8, most = 16, generator = undefined) {
  const json = { asset: { version: "2.0", generator }, scenes: [{ nodes: [] }], scene: 0, nodes: [], meshes: [], accessors: [], bufferViews: [], buffers: [] };
  const pieces = [];
  let bytes = 0;
  const accessor = (array, type, componentType, count, more = {}) => {
    json.bufferViews.push({ buffer: 0, byteOffset: bytes, byteLength: array.byteLength });
    json.accessors.push({ bufferView: json.bufferViews.length - 1, componentType, count, type, ...more });
    pieces.push(Buffer.from(array.buffer, array.byteOffset, array.byteLength));
    bytes += array.byteLength;
    return json.accessors.length - 1;
  };
  const next = random(count);
  for (let k = 0; k < count; k++) {
    const { positions, faces } = body(least + Math.floor((most - least + 1) * next()), k);
    const points = Float32Array.from(positions);
    const [min, max] = [Math.min, Math.max].map((of) => [0, 1, 2].map((axis) => points.filter((_, i) => i % 3 === axis).reduce((a, b) => of(a, b))));
    const POSITION = accessor(points, "VEC3", 5126, points.length / 3, { min, max });
    const indices = accessor(Uint32Array.from(faces), "SCALAR", 5125, faces.length);
    json.meshes.push({ primitives: [{ attributes: { POSITION }, indices }] });
    json.nodes.push({ mesh: k, translation: [3 * (k % 20), 3 * Math.floor(k / 20), 0] });
    json.scenes[0].nodes.push(k);
  }
  json.buffers.push({ byteLength: bytes });
  const text = JSON.stringify(json);
  const head = Buffer.from(text.padEnd(Math.ceil(text.length / 4) * 4));
  const chunk = (data, kind) => {
    const words = Buffer.alloc(8);
    words.writeUInt32LE(data.length, 0);
    words.writeUInt32LE(kind, 4);
    return Buffer.concat([words, data]);
  };
  const body_ = Buffer.concat([chunk(head, 0x4e4f534a), chunk(Buffer.concat(pieces), 0x004e4942)]);
  const start = Buffer.alloc(12);
  [0x46546c67, 2, 12 + body_.length].forEach((word, k) => start.writeUInt32LE(word, 4 * k));
  return Buffer.concat([start, body_]);
}
