// Vertices as the API names them: a mesh and the index of a vertex in it, as in the input.
import type {Mapped} from '../mesh/islands.js';
import type {Model} from '../mesh/model.js';
import {type Surface, next} from '../mesh/surface.js';

export interface Vertex {
  mesh: number;
  vertex: number;
}

export function vertexOf(corner: number, {part, faceInPart}: Surface, model: Model): Vertex {
  const face = Math.floor(corner / 3);
  const {faces, sources} = model.parts[part[face]!]!;
  const vertex = faces[3 * faceInPart[face]! + (corner % 3)]!;
  return {mesh: part[face]!, vertex: sources?.[vertex] ?? vertex};
}

/** One corner of each point. */
export function cornersOf({points, pointCount}: Surface): Uint32Array {
  const corners = new Uint32Array(pointCount);
  points.forEach((point, c) => (corners[point] = c));
  return corners;
}

export interface SeamPath {
  mesh: number;
  vertices: number[];
}

/** The seams of a map within the surface, an edge each: with them the charts stay as they are. */
export function seamsOf({seams}: Mapped, surface: Surface, model: Model): SeamPath[] {
  return Array.from(seams).filter((h) => surface.twins[h]! >= 0).map((h) => {
    const [a, b] = [vertexOf(h, surface, model), vertexOf(next(h), surface, model)];
    return {mesh: a.mesh, vertices: [a.vertex, b.vertex]};
  });
}
