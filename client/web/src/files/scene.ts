// The scene of a glTF: where its meshes stand.
import {Matrix4, Quaternion, Vector3} from 'three';

import {IDENTITY} from '../mesh/model.js';

interface Node {
  mesh?: number;
  skin?: number;
  children?: number[];
  matrix?: number[];
  translation?: [number, number, number];
  rotation?: [number, number, number, number];
  scale?: [number, number, number];
}

export interface Document {
  scene?: number;
  scenes?: {nodes?: number[]}[];
  nodes?: Node[];
  meshes?: {name?: string; primitives: {mode?: number; [name: string]: unknown}[]}[];
  [name: string]: unknown;
}

const GLB = 0x46546c67;

/** The JSON of a .gltf or .glb. */
export function documentOf(bytes: ArrayBuffer): Document {
  const view = new DataView(bytes);
  const isBinary = bytes.byteLength >= 20 && view.getUint32(0, true) === GLB;
  const text = isBinary ? new Uint8Array(bytes, 20, view.getUint32(12, true)) : new Uint8Array(bytes);
  return JSON.parse(new TextDecoder().decode(text));
}

function matrixOf({matrix, translation = [0, 0, 0], rotation = [0, 0, 0, 1], scale = [1, 1, 1]}: Node): Matrix4 {
  if (matrix) return new Matrix4().fromArray(matrix);
  return new Matrix4().compose(new Vector3(...translation), new Quaternion(...rotation), new Vector3(...scale));
}

/** Matrices of the nodes that show each mesh; meshes in no scene stand at the origin. */
export function placesOf(document: Document): number[][][] {
  const {nodes = [], scenes = [], scene = 0, meshes = []} = document;
  const places = meshes.map((): number[][] => []);
  const visit = (index: number, above: Matrix4, depth: number) => {
    const node = nodes[index];
    if (!node || depth > 256) return;
    const here = above.clone().multiply(matrixOf(node));
    if (node.mesh !== undefined) places[node.mesh]?.push(node.skin === undefined ? here.toArray() : IDENTITY);
    for (const child of node.children ?? []) visit(child, here, depth + 1);
  };
  for (const root of scenes[scene]?.nodes ?? []) visit(root, new Matrix4(), 0);
  return places.map((matrices) => (matrices.length > 0 ? matrices : [IDENTITY]));
}

/** Meshes with triangles, strips or fans: those that the server numbers, from 0 on. */
export function meshesWithTriangles({meshes = []}: Document): number[] {
  return [...meshes.keys()].filter((m) => meshes[m]!.primitives.some(({mode = 4}) => mode >= 4));
}
