// Meshes as the server numbers them: one part for each mesh of the asset, with its vertices and faces
// in the order of the file.

/** Texture coordinates u, v of all corners, three for each face; V points up. */
export interface UvSet {
  name: string;
  uv: Float32Array;
}

/** How faces look: the base colour of a material. */
export interface Look {
  /** Red, green and blue as light. */
  factor: [number, number, number];
  image?: Blob;
  /** The name of the UvSet by which the image lies on the faces. */
  set: string;
  /** Of the image, in the order of UvSet: 6 numbers that make u' = a u + b v + c, v' = d u + e v + f. */
  transform: number[];
  /** What lies beside the image, by the numbers of WebGL. */
  wrap: [number, number];
}

export interface Part {
  name: string;
  /** x, y, z of each vertex. */
  positions: Float32Array;
  /** Three vertices of each face. */
  faces: Uint32Array;
  uvSets: UvSet[];
  /** Where the mesh stands in the scene: matrices of 16 numbers, column by column. */
  places: number[][];
  /** For each vertex, the one of the input that it is or duplicates. */
  sources?: Uint32Array;
  /** For each face, its look in Model.looks. */
  looks?: Uint16Array;
}

export interface Model {
  parts: Part[];
  looks?: Look[];
}

export const IDENTITY = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1];

export function joinedNumbers(arrays: Float32Array[]): Float32Array {
  const all = new Float32Array(arrays.reduce((sum, {length}) => sum + length, 0));
  arrays.reduce((at, array) => (all.set(array, at), at + array.length), 0);
  return all;
}

/** UVs of vertices as those of corners. */
export function uvOfCorners(uv: ArrayLike<number>, faces: Uint32Array): Float32Array {
  const corners = new Float32Array(faces.length * 2);
  for (let c = 0; c < faces.length; c += 1) {
    corners[2 * c] = uv[2 * faces[c]!]!;
    corners[2 * c + 1] = uv[2 * faces[c]! + 1]!;
  }
  return corners;
}
