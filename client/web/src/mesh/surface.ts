// A model as one list of triangles in the space of its scene, with what lies beside what.
import type {Model, Part} from './model.js';
import {Groups, Numbering, weld} from './table.js';

export interface Surface {
  faces: number;
  /** x, y, z of each corner, nine for each face. */
  positions: Float32Array;
  /** The number of each corner's place: corners at one place share it. */
  points: Uint32Array;
  pointCount: number;
  /** For each half-edge (corner to the next), the one across it: -1 at borders, -2 where three meet. */
  twins: Int32Array;
  /** Part and face in it of each face. */
  part: Uint16Array;
  faceInPart: Uint32Array;
}

/** The half-edge after another one in its face; also the corner at its end. */
export const next = (h: number) => (h % 3 === 2 ? h - 2 : h + 1);

function transformed(part: Part, m: number[], out: Float32Array, at: number): void {
  const {positions: p, faces} = part;
  for (let c = 0; c < faces.length; c += 1) {
    const v = 3 * faces[c]!;
    const [x, y, z] = [p[v]!, p[v + 1]!, p[v + 2]!];
    for (let i = 0; i < 3; i += 1) out[at + 3 * c + i] = m[i]! * x + m[4 + i]! * y + m[8 + i]! * z + m[12 + i]!;
  }
}

/** Half-edges across each other: those of one edge, if there are two. */
function twinsOf(points: Uint32Array, pointCount: number): Int32Array {
  const edges = new Numbering(points.length);
  const twins = new Int32Array(points.length).fill(-1);
  const first = new Int32Array(points.length).fill(-1);
  for (let h = 0; h < points.length; h += 1) {
    const [a, b] = [points[h]!, points[next(h)]!];
    const edge = edges.of(Math.min(a, b) * pointCount + Math.max(a, b));
    const other = first[edge]!;
    if (other < 0) first[edge] = h;
    else if (twins[other] === -1) [twins[other], twins[h]] = [h, other];
    else {
      if (twins[other]! >= 0) twins[twins[other]!] = -2;
      twins[other] = twins[h] = -2;
    }
  }
  return twins;
}

/** Numbers without gaps for what weld() found. */
function compact(welded: Uint32Array): {points: Uint32Array; count: number} {
  const numbers = new Int32Array(welded.length).fill(-1);
  let count = 0;
  const points = welded.map((v) => (numbers[v]! >= 0 ? numbers[v]! : (numbers[v] = count++)));
  return {points, count};
}

export function surfaceOf(model: Model): Surface {
  const pieces = model.parts.flatMap((part, number) => part.places.map((place) => ({part, number, place})));
  const faces = pieces.reduce((sum, {part}) => sum + part.faces.length / 3, 0);
  const positions = new Float32Array(faces * 9);
  const points = new Uint32Array(faces * 3);
  const part = new Uint16Array(faces);
  const faceInPart = new Uint32Array(faces);
  let at = 0;
  let pointCount = 0;
  for (const piece of pieces) {
    const count = piece.part.faces.length / 3;
    transformed(piece.part, piece.place, positions, at * 9);
    const own = compact(weld(piece.part.positions));
    for (let c = 0; c < count * 3; c += 1) points[at * 3 + c] = pointCount + own.points[piece.part.faces[c]!]!;
    part.fill(piece.number, at, at + count);
    for (let f = 0; f < count; f += 1) faceInPart[at + f] = f;
    at += count;
    pointCount += own.count;
  }
  return {faces, positions, points, pointCount, twins: twinsOf(points, pointCount), part, faceInPart};
}

/** Faces that hang together, by a number for each. across: whether a half-edge with a twin joins. */
export function joined(surface: Surface, across: (h: number, twin: number) => boolean): {of: Uint32Array; count: number} {
  const groups = new Groups(surface.faces);
  surface.twins.forEach((twin, h) => {
    if (twin > h && across(h, twin)) groups.join(Math.floor(h / 3), Math.floor(twin / 3));
  });
  return groups.numbers();
}
