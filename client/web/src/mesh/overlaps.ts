// Where a map covers the page more than once: triangles whose interiors meet. Exact for the
// coordinates that the server writes, which are multiples of 2^-24.
import type {Mapped} from './islands.js';

const MOST_CELLS = 1024; // along each side
const REACH = 12; // cells of a face, on average
const MOST_PAIRS = 2e7; // that are compared: about a second

/** Twice the area of a triangle of corners a, b and of the corner c; above 0 if they turn left. */
function turn(uv: Float32Array, a: number, b: number, c: number): number {
  return (uv[2 * b]! - uv[2 * a]!) * (uv[2 * c + 1]! - uv[2 * a + 1]!) - (uv[2 * b + 1]! - uv[2 * a + 1]!) * (uv[2 * c]! - uv[2 * a]!);
}

/** Whether a side of face f has all of face g beyond it. */
function parts(uv: Float32Array, f: number, g: number): boolean {
  const sign = Math.sign(turn(uv, 3 * f, 3 * f + 1, 3 * f + 2));
  const corners = [3 * f, 3 * f + 1, 3 * f + 2, 3 * f];
  return [0, 1, 2].some((i) => [0, 1, 2].every((k) => sign * turn(uv, corners[i]!, corners[i + 1]!, 3 * g + k) <= 0));
}

/** The range of the coordinates along U (0) or V (1). */
function rangeOf(uv: Float32Array, axis: 0 | 1): [number, number] {
  let [low, high] = [Infinity, -Infinity];
  for (let at = axis; at < uv.length; at += 2) {
    low = Math.min(low, uv[at]!);
    high = Math.max(high, uv[at]!);
  }
  return [low, high];
}

/** A grid over all faces: those that reach into each cell. It is coarser where faces are large. */
class Cells {
  readonly starts: Uint32Array;
  readonly faces: Uint32Array;
  readonly #uv: Float32Array;
  readonly #ranges: [number, number][];

  constructor(uv: Float32Array) {
    this.#uv = uv;
    this.#ranges = [rangeOf(uv, 0), rangeOf(uv, 1)];
    const count = uv.length / 6;
    let side = Math.min(Math.ceil(Math.sqrt(count)), MOST_CELLS);
    while (side > 1 && this.#reach(side) > REACH * count) side = Math.ceil(side / 2);
    this.starts = new Uint32Array(side ** 2 + 1);
    for (let f = 0; f < count; f += 1) this.#each(f, side, (cell) => (this.starts[cell + 1] = this.starts[cell + 1]! + 1));
    for (let c = 0; c < side ** 2; c += 1) this.starts[c + 1] = this.starts[c + 1]! + this.starts[c]!;
    this.faces = new Uint32Array(this.starts.at(-1)!);
    const at = this.starts.slice();
    for (let f = 0; f < count; f += 1)
      this.#each(f, side, (cell) => {
        this.faces[at[cell]!] = f;
        at[cell] = at[cell]! + 1;
      });
  }

  /** The first and the last column, or row, of a face. */
  #span(f: number, axis: 0 | 1, side: number): [number, number] {
    const [low, high] = this.#ranges[axis]!;
    const [a, b, c] = [this.#uv[6 * f + axis]!, this.#uv[6 * f + 2 + axis]!, this.#uv[6 * f + 4 + axis]!];
    const cell = (value: number) => Math.min(Math.floor(((value - low) / (high - low || 1)) * side), side - 1);
    return [cell(Math.min(a, b, c)), cell(Math.max(a, b, c))];
  }

  #each(f: number, side: number, visit: (cell: number) => void): void {
    const [[left, right], [low, high]] = [this.#span(f, 0, side), this.#span(f, 1, side)];
    for (let y = low; y <= high; y += 1) for (let x = left; x <= right; x += 1) visit(y * side + x);
  }

  /** The cells of all faces together. */
  #reach(side: number): number {
    let sum = 0;
    for (let f = 0; f < this.#uv.length / 6; f += 1) {
      const [[left, right], [low, high]] = [this.#span(f, 0, side), this.#span(f, 1, side)];
      sum += (right - left + 1) * (high - low + 1);
    }
    return sum;
  }
}

/** The faces that overlap another face of their island, or of any; undefined where looking for them takes too long. */
export function overlappingFaces({uv, island}: Mapped, ofAny = false): Uint32Array | undefined {
  const {starts, faces} = new Cells(uv);
  const found = new Set<number>();
  const isFlat = (f: number) => turn(uv, 3 * f, 3 * f + 1, 3 * f + 2) === 0;
  let pairs = 0;
  for (let cell = 0; cell + 1 < starts.length; cell += 1) {
    pairs += (starts[cell + 1]! - starts[cell]!) ** 2 / 2;
    if (pairs > MOST_PAIRS) return undefined;
    for (let i = starts[cell]!; i < starts[cell + 1]!; i += 1)
      for (let j = i + 1; j < starts[cell + 1]!; j += 1) {
        const [f, g] = [faces[i]!, faces[j]!];
        if ((!ofAny && island[f] !== island[g]) || (found.has(f) && found.has(g)) || isFlat(f) || isFlat(g) || parts(uv, f, g) || parts(uv, g, f)) continue;
        found.add(f).add(g);
      }
  }
  return Uint32Array.from(found);
}
