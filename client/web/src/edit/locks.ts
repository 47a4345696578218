// Islands that stay where they are when the layout is packed again. Each is known by its first face,
// which it keeps when it is read again from the file of the result.
import type {Mapped} from '../mesh/islands.js';
import type {Surface} from '../mesh/surface.js';

/** An island as the option locked_islands wants it. */
export interface IslandAtFace {
  mesh: number;
  face: number;
}

export class Locks {
  #faces = new Set<number>();

  toggle(island: number, {island: of}: Mapped): boolean {
    const face = of.indexOf(island);
    if (this.#faces.delete(face)) return false;
    this.#faces.add(face);
    return true;
  }

  lockAll({island, islandCount}: Mapped): void {
    for (let k = 0; k < islandCount; k += 1) this.#faces.add(island.indexOf(k));
  }

  clear(): void {
    this.#faces.clear();
  }

  get count(): number {
    return this.#faces.size;
  }

  /** The faces, to be locked again in the same islands elsewhere. */
  get faces(): number[] {
    return [...this.#faces];
  }

  set faces(faces: number[]) {
    this.#faces = new Set(faces);
  }

  islands({island}: Mapped): Set<number> {
    return new Set(this.faces.map((face) => island[face]!));
  }

  asOption({part, faceInPart}: Surface): IslandAtFace[] {
    return this.faces.sort((a, b) => a - b).map((face) => ({mesh: part[face]!, face: faceInPart[face]!}));
  }
}
