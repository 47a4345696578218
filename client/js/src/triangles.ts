// Plain triangles as a GLB for the server, and its answer as plain triangles.
import {jsonOf} from './connection.js';
import {type Call, download, runJob} from './job.js';
import type {Options, Report, Result} from './types.js';

export interface Triangles {
  /** x, y, z of each vertex. */
  positions: Float32Array<ArrayBuffer>;
  /** Three vertices of each triangle. */
  indices: Uint32Array<ArrayBuffer>;
}

/** Triangles whose vertices are duplicated along seams. */
export interface MappedTriangles {
  /** u, v of each vertex; V points up. */
  uv: Float32Array<ArrayBuffer>;
  indices: Uint32Array<ArrayBuffer>;
  /** For each vertex, the one of the input that it is or duplicates. */
  sources: Uint32Array<ArrayBuffer>;
}

const FLOAT = 5126;
const UNSIGNED_INT = 5125;

function extent(positions: Float32Array): {min: number[]; max: number[]} {
  const min = [Infinity, Infinity, Infinity];
  const max = [-Infinity, -Infinity, -Infinity];
  positions.forEach((value, i) => {
    min[i % 3] = Math.min(min[i % 3]!, value);
    max[i % 3] = Math.max(max[i % 3]!, value);
  });
  return {min, max};
}

/** A GLB with one mesh for each of these. */
export function glbOf(meshes: Triangles[]): Blob {
  const bytes: BlobPart[] = [];
  let byteLength = 0;
  const bufferViews: object[] = [];
  const accessors: object[] = [];
  const add = (array: Float32Array<ArrayBuffer> | Uint32Array<ArrayBuffer>, accessor: object) => {
    bufferViews.push({buffer: 0, byteOffset: byteLength, byteLength: array.byteLength});
    byteLength += array.byteLength;
    bytes.push(array);
    return accessors.push({bufferView: bufferViews.length - 1, ...accessor}) - 1;
  };
  const described = meshes.map(({positions, indices}) => {
    const POSITION = add(positions, {componentType: FLOAT, type: 'VEC3', count: positions.length / 3, ...extent(positions)});
    const index = add(indices, {componentType: UNSIGNED_INT, type: 'SCALAR', count: indices.length});
    return {primitives: [{attributes: {POSITION}, indices: index}]};
  });
  const document = {asset: {version: '2.0'}, buffers: [{byteLength}], bufferViews, accessors, meshes: described};
  return container(JSON.stringify(document), bytes, byteLength);
}

function container(json: string, bytes: BlobPart[], byteLength: number): Blob {
  const text = new TextEncoder().encode(json);
  const padding = ' '.repeat((4 - (text.length % 4)) % 4);
  const words = (...values: number[]) => {
    const view = new DataView(new ArrayBuffer(4 * values.length));
    values.forEach((value, i) => view.setUint32(4 * i, value, true));
    return view;
  };
  const textLength = text.length + padding.length;
  const head = words(0x46546c67, 2, 28 + textLength + byteLength, textLength, 0x4e4f534a);
  return new Blob([head, text, padding, words(byteLength, 0x004e4942), ...bytes], {type: 'model/gltf-binary'});
}

/** Unwraps meshes onto one page. */
export async function unwrapTriangles(meshes: Triangles[], options: Options, settings: Call):
    Promise<{meshes: MappedTriangles[]; report: Report}> {
  const job = await runJob(glbOf(meshes), options, settings);
  const asJson = {Accept: 'application/json'}; // of the link itself, which may be signed
  const result = await download(job.links.result, settings, (answer) => jsonOf<Result>(settings, answer), asJson);
  const mapped = result.meshes.map(({uv, faces, vertex_map}) => ({
    uv: Float32Array.from(uv), indices: Uint32Array.from(faces), sources: Uint32Array.from(vertex_map),
  }));
  return {meshes: mapped, report: result.report};
}
