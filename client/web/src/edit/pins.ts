// Vertices that are held at places of the page: the option constraints.
import type {Vertex} from './vertices.js';

export interface Pin extends Vertex {
  uv: [number, number];
}

export class Pins {
  #pins: Pin[] = [];

  get all(): readonly Pin[] {
    return this.#pins;
  }

  /** The number of the pin of a vertex, which is made if there is none. */
  add(vertex: Vertex, uv: [number, number]): number {
    const found = this.#pins.findIndex((pin) => pin.mesh === vertex.mesh && pin.vertex === vertex.vertex);
    return found >= 0 ? found : this.#pins.push({...vertex, uv}) - 1;
  }

  move(number: number, uv: [number, number]): void {
    this.#pins[number]!.uv = uv;
  }

  remove(number: number): void {
    this.#pins.splice(number, 1);
  }

  clear(): void {
    this.#pins = [];
  }

  /** The pin nearest to a point of the page, within a distance along V; -1 for none. */
  near([u, v]: [number, number], within: number, aspect: number): number {
    const distances = this.#pins.map(({uv}) => Math.hypot((uv[0] - u) * aspect, uv[1] - v));
    const least = distances.indexOf(Math.min(...distances));
    return least >= 0 && distances[least]! <= within ? least : -1;
  }

  asOption(): object[] {
    return this.#pins.map(({mesh, vertex, uv}) => ({mesh, vertex, uv}));
  }
}
