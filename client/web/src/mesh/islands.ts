// A set of texture coordinates on a surface: its islands, its seams and how it distorts.
import {type Model, joinedNumbers} from './model.js';
import {type Surface, joined, next} from './surface.js';

export interface Mapped {
  /** u, v of each corner, six for each face. */
  uv: Float32Array;
  /** The island of each face. */
  island: Uint32Array;
  islandCount: number;
  /** Half-edges where islands end, one for each edge. */
  seams: Uint32Array;
}

/** The UVs of one set, for every face of the surface; undefined if a part lacks the set. */
export function uvOf(model: Model, set: number): Float32Array | undefined {
  const pieces = model.parts.flatMap((part) => part.places.map(() => part.uvSets[set]?.uv));
  const known = pieces.filter((uv) => uv !== undefined);
  return known.length === pieces.length && known.length > 0 ? joinedNumbers(known) : undefined;
}

/** Whether the faces on both sides have the same UVs at both ends of the edge. */
export function meets(surface: Surface, uv: Float32Array, h: number, twin: number): boolean {
  const same = (a: number, b: number) => uv[2 * a] === uv[2 * b] && uv[2 * a + 1] === uv[2 * b + 1];
  const isAlong = surface.points[h] === surface.points[twin]; // faces wound against each other
  return isAlong ? same(h, twin) && same(next(h), next(twin)) : same(h, next(twin)) && same(next(h), twin);
}

/** last: another map of the surface, whose islands are taken where the seams are the same. */
export function mapped(surface: Surface, uv: Float32Array, last?: Mapped): Mapped {
  const across = (h: number, twin: number) => meets(surface, uv, h, twin);
  const seams: number[] = [];
  surface.twins.forEach((twin, h) => {
    if (twin < 0 || (h < twin && !across(h, twin))) seams.push(h);
  });
  if (last?.seams.length === seams.length && seams.every((h, i) => h === last.seams[i])) return {...last, uv};
  const {of: island, count: islandCount} = joined(surface, across);
  return {uv, island, islandCount, seams: Uint32Array.from(seams)};
}
