// Hash tables of numbers, which are many times faster here than a Map.

function capacityFor(count: number): number {
  return 2 ** Math.ceil(Math.log2(Math.max(count, 4) * 2));
}

/** Numbers from 0 on for keys, in the order in which they come. Keys are integers up to 2^53. */
export class Numbering {
  count = 0;
  readonly #keys: Float64Array;
  readonly #numbers: Int32Array;
  readonly #mask: number;

  constructor(most: number) {
    const capacity = capacityFor(most);
    this.#keys = new Float64Array(capacity);
    this.#numbers = new Int32Array(capacity).fill(-1);
    this.#mask = capacity - 1;
  }

  of(key: number): number {
    let at = (Math.imul(key % 4294967296, 0x9e3779b1) ^ Math.imul(key / 4294967296, 0x85ebca6b)) >>> 0;
    at = (at ^ (at >>> 15)) & this.#mask;
    while (this.#numbers[at]! >= 0 && this.#keys[at] !== key) at = (at + 1) & this.#mask;
    if (this.#numbers[at]! < 0) {
      this.#keys[at] = key;
      this.#numbers[at] = this.count++;
    }
    return this.#numbers[at]!;
  }
}

/** The number of the first vertex at the same place, for each vertex; -0 is 0. */
export function weld(positions: Float32Array): Uint32Array {
  const count = positions.length / 3;
  const mask = capacityFor(count) - 1;
  const bits = new Uint32Array(positions.map((value) => value + 0).buffer);
  const first = new Int32Array(mask + 1).fill(-1);
  const welded = new Uint32Array(count);
  for (let v = 0; v < count; v += 1) {
    const [x, y, z] = [bits[3 * v]!, bits[3 * v + 1]!, bits[3 * v + 2]!];
    let at = Math.imul(x, 0x9e3779b1) ^ Math.imul(y, 0x85ebca6b) ^ Math.imul(z, 0xc2b2ae35);
    at = (at ^ (at >>> 16)) & mask;
    for (let w = first[at]!; w >= 0; w = first[at]!) {
      if (bits[3 * w] === x && bits[3 * w + 1] === y && bits[3 * w + 2] === z) break;
      at = (at + 1) & mask;
    }
    if (first[at]! < 0) first[at] = v;
    welded[v] = first[at]!;
  }
  return welded;
}

/** Sets that are joined; each has the smallest member as its root. */
export class Groups {
  readonly #parents: Int32Array;

  constructor(count: number) {
    this.#parents = Int32Array.from({length: count}, (_, i) => i);
  }

  rootOf(member: number): number {
    const parents = this.#parents;
    while (parents[member] !== member) {
      parents[member] = parents[parents[member]!]!;
      member = parents[member]!;
    }
    return member;
  }

  join(a: number, b: number): void {
    const [p, q] = [this.rootOf(a), this.rootOf(b)];
    this.#parents[Math.max(p, q)] = Math.min(p, q);
  }

  /** A number from 0 on for the group of each member. */
  numbers(): {of: Uint32Array; count: number} {
    const of = new Uint32Array(this.#parents.length);
    let count = 0;
    for (let i = 0; i < of.length; i += 1) {
      const root = this.rootOf(i);
      of[i] = root === i ? count++ : of[root]!;
    }
    return {of, count};
  }
}
