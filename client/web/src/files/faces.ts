// What readers of text and of PLY share: lists that grow, and one part of vertices and faces.
import {IDENTITY, type Model, type UvSet} from '../mesh/model.js';

/** A list of numbers that grows. */
export class Numbers {
  length = 0;
  #array = new Float64Array(1024);

  push(value: number): void {
    if (this.length === this.#array.length) {
      const larger = new Float64Array(2 * this.length);
      larger.set(this.#array);
      this.#array = larger;
    }
    this.#array[this.length++] = value;
  }

  at(index: number): number {
    return this.#array[index]!;
  }

  get values(): Float64Array {
    return this.#array.subarray(0, this.length);
  }
}

/** Throws RangeError with the first corner that names no vertex. */
export function modelOf(positions: ArrayLike<number>, faces: Float64Array, uvSets: UvSet[]): Model {
  const wrong = faces.findIndex((v) => !(v >= 0 && v < positions.length / 3));
  if (wrong >= 0) throw new RangeError(`face ${Math.floor(wrong / 3) + 1} names vertex ${faces[wrong]! + 1}, which does not exist.`);
  return {parts: [{name: '', positions: Float32Array.from(positions), faces: Uint32Array.from(faces), uvSets, places: [IDENTITY]}]};
}
