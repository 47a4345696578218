// What a mesh is, before it is sent: counted here, since it is on the screen first. The server's own
// analysis, which repairs, counts.
import {mapped, uvOf} from '../mesh/islands.js';
import type {Model} from '../mesh/model.js';
import {type Surface, joined, next} from '../mesh/surface.js';
import {Groups} from '../mesh/table.js';

export interface Analysis {
  meshes: number;
  faces: number;
  vertices: number;
  components: number;
  /** Closed chains of edges with one face. */
  boundaries: number;
  /** Handles of all components; undefined where edges have three faces or more. */
  genus: number | undefined;
  /** Edges with three faces or more. */
  branching: number;
  /** Faces without area. */
  degenerate: number;
  uvSets: {name: string; islands: number}[];
}

function boundariesOf({twins, points, pointCount}: Surface): number {
  const ends = new Groups(pointCount);
  const on = new Set<number>();
  twins.forEach((twin, h) => {
    if (twin !== -1) return;
    ends.join(points[h]!, points[next(h)]!);
    on.add(points[h]!).add(points[next(h)]!);
  });
  return new Set(Array.from(on, (point) => ends.rootOf(point))).size;
}

function degenerateFaces({positions}: Surface): number {
  let found = 0;
  for (let at = 0; at < positions.length; at += 9) {
    const e = (i: number, j: number) => positions[at + 3 * j + i]! - positions[at + i]!;
    const cross = [e(1, 1) * e(2, 2) - e(2, 1) * e(1, 2), e(2, 1) * e(0, 2) - e(0, 1) * e(2, 2), e(0, 1) * e(1, 2) - e(1, 1) * e(0, 2)];
    if (cross.every((value) => value === 0)) found += 1;
  }
  return found;
}

export function analyse(model: Model, surface: Surface): Analysis {
  const {twins, points, faces} = surface;
  const components = joined(surface, () => true).count;
  const boundaries = boundariesOf(surface);
  const branching = twins.reduce((sum, twin) => sum + (twin === -2 ? 1 : 0), 0);
  const edges = twins.reduce((sum, twin, h) => sum + (twin === -1 || twin > h ? 1 : 0), 0);
  const used = new Set(points).size;
  const handles = components - (used - edges + faces + boundaries) / 2;
  const names = model.parts[0]?.uvSets.map(({name}) => name) ?? [];
  const uvSets = names.flatMap((name, set) => {
    const uv = uvOf(model, set);
    return uv ? [{name, islands: mapped(surface, uv).islandCount}] : [];
  });
  return {
    meshes: model.parts.length, faces, components, boundaries, branching, uvSets, vertices: used,
    genus: branching === 0 && Number.isInteger(handles) && handles >= 0 ? handles : undefined,
    degenerate: degenerateFaces(surface),
  };
}
