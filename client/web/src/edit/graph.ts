// Edges of a surface as a graph: shortest paths between two points, and rings that go straight on.
import {type Surface, next} from '../mesh/surface.js';

const STRAIGHT = 0.5; // cosine of the sharpest turn of a ring

export interface Onward {
  /** Cosine of the sharpest turn. */
  least?: number;
  /** Whether the way may take this edge. */
  isAllowed?: (a: number, b: number) => boolean;
}

/** A heap of points by distance. */
class Queue {
  readonly #items: [number, number][] = [];

  push(distance: number, point: number): void {
    const items = this.#items;
    let at = items.push([distance, point]) - 1;
    for (let up = (at - 1) >> 1; at > 0 && items[up]![0] > distance; up = (at - 1) >> 1) {
      [items[at], items[up]] = [items[up]!, items[at]!];
      at = up;
    }
  }

  pop(): [number, number] | undefined {
    const items = this.#items;
    const [first, last] = [items[0], items.pop()];
    if (items.length === 0 || !last) return first;
    items[0] = last;
    for (let at = 0; ;) {
      const [left, right] = [2 * at + 1, 2 * at + 2];
      let least = left < items.length && items[left]![0] < items[at]![0] ? left : at;
      if (right < items.length && items[right]![0] < items[least]![0]) least = right;
      if (least === at) return first;
      [items[at], items[least]] = [items[least]!, items[at]!];
      at = least;
    }
  }
}

export class EdgeGraph {
  /** Where the neighbours of each point begin in #ends. */
  readonly #starts: Uint32Array;
  readonly #ends: Uint32Array;
  readonly #places: Float32Array;

  constructor({points, positions, pointCount, twins}: Surface) {
    this.#places = new Float32Array(pointCount * 3);
    points.forEach((point, c) => this.#places.set(positions.subarray(3 * c, 3 * c + 3), 3 * point));
    const isOne = (h: number) => twins[h]! < h; // each edge once, or where three faces meet more often
    const counts = new Uint32Array(pointCount + 1);
    points.forEach((a, h) => {
      if (isOne(h)) for (const point of [a, points[next(h)]!]) counts[point + 1] = counts[point + 1]! + 1;
    });
    for (let i = 1; i < counts.length; i += 1) counts[i] = counts[i]! + counts[i - 1]!;
    this.#starts = counts;
    const at = this.#starts.slice();
    this.#ends = new Uint32Array(this.#starts[pointCount]!);
    points.forEach((a, h) => {
      const b = points[next(h)]!;
      if (!isOne(h)) return;
      for (const [from, to] of [[a, b], [b, a]] as const) {
        this.#ends[at[from]!] = to;
        at[from] = at[from]! + 1;
      }
    });
  }

  neighbours(point: number): Uint32Array {
    return this.#ends.subarray(this.#starts[point], this.#starts[point + 1]);
  }

  placeOf(point: number): Float32Array {
    return this.#places.subarray(3 * point, 3 * point + 3);
  }

  #direction(a: number, b: number): number[] {
    const [p, q] = [this.placeOf(a), this.placeOf(b)];
    const d = [q[0]! - p[0]!, q[1]! - p[1]!, q[2]! - p[2]!];
    const length = Math.hypot(...d) || 1;
    return [...d.map((value) => value / length), length];
  }

  /** The shortest way along edges, both ends included; undefined between separate pieces. */
  path(from: number, to: number): number[] | undefined {
    const distances = new Float64Array(this.#starts.length).fill(Infinity);
    const before = new Int32Array(this.#starts.length).fill(-1);
    const queue = new Queue();
    distances[from] = 0;
    queue.push(0, from);
    for (let item = queue.pop(); item; item = queue.pop()) {
      const [distance, point] = item;
      if (point === to) break;
      if (distance > distances[point]!) continue;
      for (const other of this.neighbours(point)) {
        const further = distance + this.#direction(point, other)[3]!;
        if (further >= distances[other]!) continue;
        distances[other] = further;
        before[other] = point;
        queue.push(further, other);
      }
    }
    if (distances[to] === Infinity) return undefined;
    const path = [to];
    while (path[0] !== from) path.unshift(before[path[0]!]!);
    return path;
  }

  /** On from an edge, as straight as it goes, until it closes, ends, or would turn more than `least` has it. */
  ring(a: number, b: number, {least = STRAIGHT, isAllowed = () => true}: Onward = {}): number[] {
    const path = [a, b];
    const passed = new Set(path);
    for (;;) {
      const [last, here] = [path.at(-2)!, path.at(-1)!];
      const along = this.#direction(last, here);
      const cosine = (point: number) => {
        const onward = this.#direction(here, point);
        return along[0]! * onward[0]! + along[1]! * onward[1]! + along[2]! * onward[2]!;
      };
      const others = [...this.neighbours(here)].filter((point) => point !== last && isAllowed(here, point));
      const best = others.reduce<number | undefined>((found, point) => (found === undefined || cosine(point) > cosine(found) ? point : found), undefined);
      if (best === undefined || cosine(best) < least) return path;
      path.push(best);
      if (passed.has(best)) return path;
      passed.add(best);
    }
  }
}
