// Creases of a surface: edges at which two faces meet at an angle.
import {type Surface, next} from '../mesh/surface.js';
import {faceNormals} from '../view/normals.js';

/** Edges at which the surface bends by at least so many degrees, each as its two points. */
export function creasesOf({positions, points, twins}: Surface, degrees: number): [number, number][] {
  const normals = faceNormals(positions);
  const most = Math.cos((degrees * Math.PI) / 180);
  const found: [number, number][] = [];
  twins.forEach((twin, h) => {
    if (twin < h) return; // no other face, or the other side of an edge
    const [f, g] = [3 * Math.floor(h / 3), 3 * Math.floor(twin / 3)];
    const dot = (a: number, b: number) => normals[a]! * normals[b]! + normals[a + 1]! * normals[b + 1]! + normals[a + 2]! * normals[b + 2]!;
    const both = Math.sqrt(dot(f, f) * dot(g, g));
    const cosine = points[h] === points[twin] ? -dot(f, g) : dot(f, g); // faces wound against each other
    if (both > 0 && cosine <= most * both) found.push([points[h]!, points[next(h)]!]);
  });
  return found;
}

/** Edges as paths, as long as they go on without a fork. */
export function chained(edges: [number, number][]): number[][] {
  const around = new Map<number, number[]>();
  for (const [a, b] of edges) for (const [from, to] of [[a, b], [b, a]] as const) around.set(from, [...(around.get(from) ?? []), to]);
  const take = (a: number, b: number) => {
    for (const [from, to] of [[a, b], [b, a]] as const) around.set(from, around.get(from)!.filter((point) => point !== to));
  };
  const forks = new Set([...around.keys()].filter((point) => around.get(point)!.length !== 2));
  const paths: number[][] = [];
  for (const start of [...forks, ...around.keys()])
    while (around.get(start)!.length > 0) {
      const path = [start];
      for (let here = start, onward = around.get(here)![0]; onward !== undefined; onward = forks.has(here) ? undefined : around.get(here)![0]) {
        take(here, onward);
        path.push((here = onward));
      }
      paths.push(path);
    }
  return paths;
}
