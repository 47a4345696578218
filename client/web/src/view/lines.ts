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
