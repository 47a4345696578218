// Lines and triangles of a surface, in space and on the page.
import type {Mapped} from '../mesh/islands.js';
import {type Surface, next} from '../mesh/surface.js';

/** The ends of half-edges, `size` numbers for each corner. */
export function linesOf(halfedges: ArrayLike<number>, values: Float32Array, size: 2 | 3): Float32Array {
  const lines = new Float32Array(halfedges.length * 2 * size);
  for (let i = 0; i < halfedges.length; i += 1)
    [halfedges[i]!, next(halfedges[i]!)].forEach((corner, end) => {
      for (let k = 0; k < size; k += 1) lines[(2 * i + end) * size + k] = values[corner * size + k]!;
    });
  return lines;
}

const BOX = [[0, 1], [2, 3], [4, 5], [6, 7], [0, 2], [1, 3], [4, 6], [5, 7], [0, 4], [1, 5], [2, 6], [3, 7]];

/** The edges of the box, or of the rectangle, around an island; values: `size` numbers for each corner. */
export function frameOf(which: number, {island}: Mapped, values: Float32Array, size: 2 | 3, margin = 0): Float32Array {
  const [low, high] = [new Array<number>(size).fill(Infinity), new Array<number>(size).fill(-Infinity)];
  for (let at = 0; at < values.length; at += 1) {
    if (island[Math.floor(at / (3 * size))] !== which) continue;
    low[at % size] = Math.min(low[at % size]!, values[at]! - margin);
    high[at % size] = Math.max(high[at % size]!, values[at]! + margin);
  }
  const point = (corner: number) => low.map((value, k) => ((corner >> k) & 1 ? high[k]! : value));
  const edges = BOX.filter((ends) => ends.every((corner) => corner < 2 ** size));
  return Float32Array.from(edges.flat().flatMap(point));
}

/** The corners of faces, `size` numbers for each. */
export function trianglesOf(faces: ArrayLike<number>, values: Float32Array, size: 2 | 3): Float32Array {
  const picked = new Float32Array(faces.length * 3 * size);
  for (let i = 0; i < faces.length; i += 1) picked.set(values.subarray(3 * size * faces[i]!, 3 * size * (faces[i]! + 1)), 3 * size * i);
  return picked;
}

/** Half-edges at which an island ends, on both sides of seams. */
export function borderOf(island: number, map: Mapped, {twins}: Surface): number[] {
  const border: number[] = [];
  for (const h of map.seams) {
    if (map.island[Math.floor(h / 3)] === island) border.push(h);
    const twin = twins[h]!;
    if (twin >= 0 && map.island[Math.floor(twin / 3)] === island) border.push(twin);
  }
  return border;
}

/** All half-edges at seams, with both sides: on the page these are two lines. */
export function bothSides({seams}: Mapped, {twins}: Surface): Uint32Array {
  return Uint32Array.from([...seams, ...Array.from(seams, (h) => twins[h]!).filter((twin) => twin >= 0)]);
}
