// Where a map covers the page more than once: triangles of one island whose interiors meet. Exact for the
// coordinates that the server writes, which are multiples of 2^-24.
import type {Mapped} from './islands.js';

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

/** A grid over the page: the faces that reach into each cell. */
class Cells {
  readonly side: number;
  readonly starts: Uint32Array;
  readonly faces: Uint32Array;

  constructor(readonly uv: Float32Array) {
    const count = uv.length / 6;
    this.side = Math.min(Math.ceil(Math.sqrt(count)), 1024);
    this.starts = new Uint32Array(this.side ** 2 + 1);
    for (let f = 0; f < count; f += 1) this.#each(f, (cell) => (this.starts[cell + 1] = this.starts[cell + 1]! + 1));
    for (let c = 0; c < this.side ** 2; c += 1) this.starts[c + 1] = this.starts[c + 1]! + this.starts[c]!;
    this.faces = new Uint32Array(this.starts.at(-1)!);
    const at = this.starts.slice();
    for (let f = 0; f < count; f += 1)
      this.#each(f, (cell) => {
        this.faces[at[cell]!] = f;
        at[cell] = at[cell]! + 1;
      });
  }

  #each(f: number, visit: (cell: number) => void): void {
    const range = (axis: number) => {
      const values = [0, 2, 4].map((k) => this.uv[6 * f + k + axis]!);
      const cell = (value: number) => Math.min(Math.max(Math.floor(value * this.side), 0), this.side - 1);
      return [cell(Math.min(...values)), cell(Math.max(...values))] as const;
    };
    const [[left, right], [low, high]] = [range(0), range(1)];
    for (let y = low; y <= high; y += 1) for (let x = left; x <= right; x += 1) visit(y * this.side + x);
  }
}

/** The faces that overlap another face of their island. */
export function overlappingFaces({uv, island}: Mapped): Uint32Array {
  const {starts, faces} = new Cells(uv);
  const found = new Set<number>();
  const isFlat = (f: number) => turn(uv, 3 * f, 3 * f + 1, 3 * f + 2) === 0;
  for (let cell = 0; cell + 1 < starts.length; cell += 1)
    for (let i = starts[cell]!; i < starts[cell + 1]!; i += 1)
      for (let j = i + 1; j < starts[cell + 1]!; j += 1) {
        const [f, g] = [faces[i]!, faces[j]!];
        if (island[f] !== island[g] || (found.has(f) && found.has(g)) || isFlat(f) || isFlat(g) || parts(uv, f, g) || parts(uv, g, f)) continue;
        found.add(f).add(g);
      }
  return Uint32Array.from(found);
}
