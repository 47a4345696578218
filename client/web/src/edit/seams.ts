// Seams that are marked by hand: paths along edges from click to click.
import type {Model} from '../mesh/model.js';
import type {Surface} from '../mesh/surface.js';
import {chained, creasesOf} from './creases.js';
import {EdgeGraph, type Onward} from './graph.js';
import {type SeamPath, cornersOf, vertexOf} from './vertices.js';

export class SeamMarks {
  readonly #surface: Surface;
  readonly #graph: EdgeGraph;
  readonly #corners: Uint32Array;
  #paths: number[][] = [];
  #last: number | undefined; // where the next path begins
  #steps: {paths: number[][]; last: number | undefined}[] = []; // to go back to

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
    if (path) this.#push(path);
    this.#last = point;
    return path !== undefined;
  }

  #push(...paths: number[][]): void {
    this.#steps.push({paths: this.#paths, last: this.#last});
    this.#paths = [...this.#paths, ...paths];
  }

  /** Lengthens the last edge to a ring. False if there is none. */
  ring(): boolean {
    return this.#lengthen({});
  }

  /** Lengthens the last edge along the crease that it lies on. False if it is no edge of one. */
  followCrease(degrees: number): boolean {
    const keyOf = (a: number, b: number) => `${Math.min(a, b)} ${Math.max(a, b)}`;
    const creases = new Set(creasesOf(this.#surface, degrees).map(([a, b]) => keyOf(a, b)));
    return this.#lengthen({least: -1, isAllowed: (a, b) => creases.has(keyOf(a, b))});
  }

  #lengthen(how: Onward): boolean {
    const [a, b] = this.#paths.at(-1)?.slice(-2) ?? [];
    if (a === undefined || b === undefined || how.isAllowed?.(a, b) === false) return false;
    this.#push(this.#graph.ring(a, b, how), this.#graph.ring(b, a, how));
    this.#last = undefined;
    return true;
  }

  /** Marks all creases. False if there are none. */
  markCreases(degrees: number): boolean {
    const paths = chained(creasesOf(this.#surface, degrees));
    if (paths.length > 0) this.#push(...paths);
    this.#last = undefined;
    return paths.length > 0;
  }

  /** The next click begins a new path. */
  lift(): void {
    this.#last = undefined;
  }

  undo(): void {
    const step = this.#steps.pop();
    this.#paths = step?.paths ?? [];
    this.#last = step?.last;
  }

  clear(): void {
    this.#paths = [];
    this.#steps = [];
    this.#last = undefined;
  }

  /** Edges that are marked, each counted once. */
  get edges(): number {
    const marked = this.#paths.flatMap((path) => path.slice(1).map((point, i) => `${Math.min(point, path[i]!)} ${Math.max(point, path[i]!)}`));
    return new Set(marked).size;
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

  /** As the options seam_edges and keep_edges want them. */
  asOption(model: Model): SeamPath[] {
    return this.#paths.map((path) => {
      const vertices = path.map((point) => vertexOf(this.#corners[point]!, this.#surface, model));
      return {mesh: vertices[0]!.mesh, vertices: vertices.map(({vertex}) => vertex)};
    });
  }
}
