// Islands that are not packed when the layout is packed again: they stay, or lie where they were put by
// hand. Each is known by its first face, which it keeps when it is read again from the file of the result.
import type {Mapped} from '../mesh/islands.js';
import type {Surface} from '../mesh/surface.js';
import {AT_REST, type Motion, isAtRest, place} from './motion.js';

/** An island as the option locked_islands wants it. */
export interface LockedIsland extends Partial<Motion> {
  mesh: number;
  face: number;
}

export class Locks {
  #motions = new Map<number, Motion>(); // by face

  /** An island that is unlocked is where it was. */
  toggle(island: number, {island: of}: Mapped): boolean {
    const face = of.indexOf(island);
    if (this.#motions.delete(face)) return false;
    this.#motions.set(face, AT_REST);
    return true;
  }

  lockAll({island, islandCount}: Mapped): void {
    for (let k = 0; k < islandCount; k += 1) {
      const face = island.indexOf(k);
      if (!this.#motions.has(face)) this.#motions.set(face, AT_REST);
    }
  }

  clear(): void {
    this.#motions.clear();
  }

  motionOf(island: number, {island: of}: Mapped): Motion {
    return this.#motions.get(of.indexOf(island)) ?? AT_REST;
  }

  /** Locks an island somewhere. */
  put(island: number, {island: of}: Mapped, motion: Motion): void {
    this.#motions.set(of.indexOf(island), motion);
  }

  get count(): number {
    return this.#motions.size;
  }

  get movedCount(): number {
    return [...this.#motions.values()].filter((motion) => !isAtRest(motion)).length;
  }

  /** The faces, to be locked again in the same islands elsewhere. */
  get faces(): number[] {
    return [...this.#motions.keys()];
  }

  set faces(faces: number[]) {
    this.#motions = new Map(faces.map((face) => [face, AT_REST]));
  }

  islands({island}: Mapped): Set<number> {
    return new Set(this.faces.map((face) => island[face]!));
  }

  /** The map with the islands where they were put; itself where none was moved. */
  arranged(map: Mapped, aspect: number): Mapped {
    if (this.movedCount === 0) return map;
    const uv = map.uv.slice();
    const facesOf = new Map<number, number[]>();
    for (const [face, motion] of this.#motions) if (!isAtRest(motion)) facesOf.set(map.island[face]!, []);
    map.island.forEach((island, f) => facesOf.get(island)?.push(f));
    for (const [face, motion] of this.#motions) {
      const faces = facesOf.get(map.island[face]!);
      if (faces) place(faces, motion, aspect, map.uv, uv);
    }
    return {...map, uv};
  }

  asOption({part, faceInPart}: Surface): LockedIsland[] {
    return this.faces.sort((a, b) => a - b).map((face) => {
      const motion = this.#motions.get(face)!;
      return {mesh: part[face]!, face: faceInPart[face]!, ...(isAtRest(motion) ? {} : motion)};
    });
  }
}
