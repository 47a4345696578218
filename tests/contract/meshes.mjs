// Small assets, made here: a square grid as GLB, as glTF with its buffer beside it and as OBJ, and
// the same things broken in one way each.

const kFloat = 5126;
const kUint32 = 5125;

/** Positions (Float32Array) and indices (Uint32Array) of n by n quads over the unit square. */
function grid(n) {
  const positions = new Float32Array(3 * (n + 1) * (n + 1));
  for (let y = 0; y <= n; ++y) {
    for (let x = 0; x <= n; ++x) {
      const height = 0.2 * Math.sin((3 * x) / n) * Math.cos((2 * y) / n);
      positions.set([x / n, y / n, height], 3 * (y * (n + 1) + x));
    }
  }
  const indices = new Uint32Array(6 * n * n);
  for (let y = 0; y < n; ++y) {
    for (let x = 0; x < n; ++x) {
      const a = y * (n + 1) + x;
      const b = a + n + 1;
      indices.set([a, a + 1, b + 1, a, b + 1, b], 6 * (y * n + x));
    }
  }
  return {positions, indices};
}

function bounds(positions) {
  const min = [Infinity, Infinity, Infinity];
  const max = [-Infinity, -Infinity, -Infinity];
  positions.forEach((value, i) => {
    min[i % 3] = Math.min(min[i % 3], value);
    max[i % 3] = Math.max(max[i % 3], value);
  });
  return {min, max};
}

/** The glTF document of a mesh whose only buffer holds indices, then positions. */
function document({positions, indices}, buffer) {
  const views = [indices, positions].map((array, i) => ({
    buffer: 0,
    byteOffset: i === 0 ? 0 : indices.byteLength,
    byteLength: array.byteLength,
  }));
  return {
    asset: {version: '2.0'},
    scene: 0,
    scenes: [{nodes: [0]}],
    nodes: [{mesh: 0}],
    meshes: [{primitives: [{attributes: {POSITION: 1}, indices: 0}]}],
    accessors: [
      {bufferView: 0, componentType: kUint32, count: indices.length, type: 'SCALAR'},
      {bufferView: 1, componentType: kFloat, count: positions.length / 3, type: 'VEC3',
       ...bounds(positions)},
    ],
    bufferViews: views,
    buffers: [{byteLength: indices.byteLength + positions.byteLength, ...buffer}],
  };
}

function binary({positions, indices}) {
  return Buffer.concat([indices, positions].map((a) => Buffer.from(a.buffer)));
}

function chunk(type, bytes, filler) {
  const padding = Buffer.alloc((4 - (bytes.length % 4)) % 4, filler);
  const head = Buffer.alloc(8);
  head.writeUInt32LE(bytes.length + padding.length, 0);
  head.write(type, 4, 'latin1');
  return Buffer.concat([head, bytes, padding]);
}

function container(json, bin) {
  const chunks = [chunk('JSON', Buffer.from(JSON.stringify(json)), ' ')];
  if (bin) chunks.push(chunk('BIN\0', bin, 0));
  const body = Buffer.concat(chunks);
  const head = Buffer.alloc(12);
  head.write('glTF', 0, 'latin1');
  head.writeUInt32LE(2, 4);
  head.writeUInt32LE(12 + body.length, 8);
  return Buffer.concat([head, body]);
}

/** mesh: {positions: Float32Array, indices: Uint32Array}. */
export function glbOf(mesh) {
  return container(document(mesh, {}), binary(mesh));
}

export function glb(n = 4) {
  return glbOf(grid(n));
}

/** A .gltf and the buffer that it names uri. */
export function gltf(uri = 'grid.bin', n = 4) {
  const mesh = grid(n);
  return {text: Buffer.from(JSON.stringify(document(mesh, {uri}))), buffer: binary(mesh)};
}

export function obj(n = 2) {
  const {positions, indices} = grid(n);
  const lines = [];
  for (let i = 0; i < positions.length; i += 3) {
    lines.push(`v ${positions[i]} ${positions[i + 1]} ${positions[i + 2]}`);
  }
  for (let i = 0; i < indices.length; i += 3) {
    lines.push(`f ${indices[i] + 1} ${indices[i + 1] + 1} ${indices[i + 2] + 1}`);
  }
  return Buffer.from(lines.join('\n') + '\n');
}

/** A GLB of a small grid after change(document, mesh) has been at it. */
function changed(change) {
  const mesh = grid(2);
  const json = document(mesh, {});
  change(json, mesh);
  return container(json, binary(mesh));
}

/** A strip of quads closed with half a turn: a surface with one side. */
function moebius(n = 12) {
  const lines = [];
  for (let i = 0; i < n; ++i) {
    const turn = (2 * Math.PI * i) / n;
    for (const side of [-0.3, 0.3]) {
      const radius = 1 + side * Math.cos(turn / 2);
      lines.push(`v ${radius * Math.cos(turn)} ${radius * Math.sin(turn)} ` +
                 `${side * Math.sin(turn / 2)}`);
    }
  }
  for (let i = 0; i < n; ++i) {
    const [a, b] = [2 * i + 1, 2 * i + 2];
    const [c, d] = i + 1 < n ? [a + 2, b + 2] : [2, 1];
    lines.push(`f ${a} ${c} ${b}`, `f ${b} ${c} ${d}`);
  }
  return Buffer.from(lines.join('\n') + '\n');
}

function compressedBy(extension, place) {
  return changed((json) => {
    json.extensionsUsed = [extension];
    json.extensionsRequired = [extension];
    place(json);
  });
}

/** The grid with an image on it, which its UVs sample. */
const pictured = (image) => changed((json) => {
  json.images = [{uri: `data:image/png;base64,${image.toString('base64')}`}];
  json.textures = [{source: 0}];
  json.materials = [{emissiveTexture: {index: 0}}];
  const [primitive] = json.meshes[0].primitives;
  primitive.material = 0;
  json.accessors.push({componentType: kFloat, type: 'VEC2',
                       count: json.accessors[primitive.attributes.POSITION].count});
  primitive.attributes.TEXCOORD_0 = json.accessors.length - 1;
});

/** Assets whose textures cannot be transferred, likewise. */
export const kRefusedTextures = {
  malformed_image: pictured(Buffer.from('\x89PNG\r\n\x1a\n', 'latin1')),
  unsupported_image: pictured(Buffer.from('\xabKTX 20\xbb\r\n\x1a\n', 'latin1')),
};

/** Assets that cannot be done, by the code of the problem that they are to get. */
export const kRefused = {
  unknown_format: Buffer.from([0, 1, 2, 3, 4, 5, 6, 7]),
  malformed_glb: glb().subarray(0, 100),
  malformed_json: Buffer.from('{"asset":{"version":"2.0"},"meshes":[}'),
  malformed_gltf: changed((json) => (json.accessors[1].bufferView = 7)),
  malformed_obj: Buffer.from('v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n'),
  malformed_mesh: Buffer.from('OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 9\n'),
  malformed_draco: compressedBy('KHR_draco_mesh_compression', (json) => {
    json.meshes[0].primitives[0].extensions = {
      KHR_draco_mesh_compression: {bufferView: 0, attributes: {POSITION: 0}}};
  }),
  malformed_meshopt: compressedBy('EXT_meshopt_compression', (json) => {
    const {byteLength} = json.bufferViews[1];
    json.bufferViews[1].extensions = {EXT_meshopt_compression: {
      buffer: 0, byteLength: 50, byteStride: 12, count: byteLength / 12, mode: 'ATTRIBUTES'}};
  }),
  missing_buffer: gltf('elsewhere.bin').text,
  external_uri: gltf('https://example.org/grid.bin').text,
  unsupported_extension: compressedBy('KHR_unheard_of', () => {}),
  no_triangles: changed((json) => (json.meshes[0].primitives[0].mode = 0)),
  zero_area: changed((json, mesh) => mesh.positions.fill(0)),
  non_finite_position: changed((json, mesh) => (mesh.positions[4] = NaN)),
  not_orientable: moebius(),
};
