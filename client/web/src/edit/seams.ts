// Seams that are marked by hand: paths along edges from click to click.
import type {Model} from '../mesh/model.js';
import type {Surface} from '../mesh/surface.js';
import {EdgeGraph} from './graph.js';
import {type SeamPath, cornersOf, vertexOf} from './vertices.js';

export class SeamMarks {
  readonly #surface: Surface;
  readonly #graph: EdgeGraph;
  readonly #corners: Uint32Array;
  #paths: number[][] = [];
  #last: number | undefined; // where the next path begins

  constructor(surface: Surface) {
    this.#surface = surface;
    this.#graph = new EdgeGraph(surface);
    this.#corners = cornersOf(surface);
  }

  /** Goes on to a point. False if no way leads there. */
  add(point: number): boolean {
    if (this.#last === undefined || this.#last === point) {
      this.#last = point;
      return true;
    }
    const path = this.#graph.path(this.#last, point);
    if (path) this.#paths.push(path);
    this.#last = point;
    return path !== undefined;
  }

  /** Lengthens the last edge to a ring. False if there is none. */
  ring(): boolean {
    const path = this.#paths.at(-1);
    if (!path) return false;
    const [a, b] = [path.at(-2)!, path.at(-1)!];
    this.#paths.push(this.#graph.ring(a, b), this.#graph.ring(b, a));
    this.#last = undefined;
    return true;
  }

  /** The next click begins a new path. */
  lift(): void {
    this.#last = undefined;
  }

  undo(): void {
    const path = this.#paths.pop();
    this.#last = path?.[0];
  }

  clear(): void {
    this.#paths = [];
    this.#last = undefined;
  }

  get edges(): number {
    return this.#paths.reduce((sum, path) => sum + path.length - 1, 0);
  }

  get paths(): number {
    return this.#paths.length;
  }

  get isBegun(): boolean {
    return this.#last !== undefined;
  }

  /** Lines in space, two ends for each edge. */
  lines(): Float32Array {
    const ends = this.#paths.flatMap((path) => path.slice(1).flatMap((point, i) => [path[i]!, point]));
    return Float32Array.from(ends.flatMap((point) => Array.from(this.#graph.placeOf(point))));
  }

  /** The points of the paths, and the one where the next begins. */
  dots(): Float32Array {
    const points = [...this.#paths.flat(), ...(this.#last === undefined ? [] : [this.#last])];
    return Float32Array.from(points.flatMap((point) => Array.from(this.#graph.placeOf(point))));
  }

  /** As the option seam_edges wants them. */
  asOption(model: Model): SeamPath[] {
    return this.#paths.map((path) => {
      const vertices = path.map((point) => vertexOf(this.#corners[point]!, this.#surface, model));
      return {mesh: vertices[0]!.mesh, vertices: vertices.map(({vertex}) => vertex)};
    });
  }
}
