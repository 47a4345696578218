// Islands that are not packed when the layout is packed again: they are locked where they are, or were
// moved by hand. Each is known by its first face, which it keeps in all results.
import type {Mapped} from '../mesh/islands.js';
import type {Surface} from '../mesh/surface.js';
import {AT_REST, type Motion, isAtRest, place} from './motion.js';

/** An island as the option locked_islands wants it. */
export interface LockedIsland extends Partial<Motion> {
  mesh: number;
  face: number;
}

export class Locks {
  #locked = new Set<number>(); // by face
  #motions = new Map<number, Motion>(); // by face; none is at rest

  toggle(island: number, {island: of}: Mapped): void {
    const face = of.indexOf(island);
    if (!this.#locked.delete(face)) this.#locked.add(face);
  }

  isLocked(island: number, {island: of}: Mapped): boolean {
    return this.#locked.has(of.indexOf(island));
  }

  lockAll({island, islandCount}: Mapped): void {
    for (let k = 0; k < islandCount; k += 1) this.#locked.add(island.indexOf(k));
  }

  unlockAll(): void {
    this.#locked.clear();
  }

  motionOf(island: number, {island: of}: Mapped): Motion {
    return this.#motions.get(of.indexOf(island)) ?? AT_REST;
  }

  move(island: number, {island: of}: Mapped, motion: Motion): void {
    if (isAtRest(motion)) this.#motions.delete(of.indexOf(island));
    else this.#motions.set(of.indexOf(island), motion);
  }

  get lockedCount(): number {
    return this.#locked.size;
  }

  get movedCount(): number {
    return this.#motions.size;
  }

  /** Those that are not packed. */
  get faces(): number[] {
    return [...new Set([...this.#locked, ...this.#motions.keys()])].sort((a, b) => a - b);
  }

  /** Locks the islands of these faces where they are, and no others. */
  reset(faces: number[]): void {
    this.#locked = new Set(faces);
    this.#motions.clear();
  }

  islands({island}: Mapped): Set<number> {
    return new Set(this.faces.map((face) => island[face]!));
  }

  movedIslands({island}: Mapped): number[] {
    return [...this.#motions.keys()].map((face) => island[face]!);
  }

  /** The map with the islands where they were moved; itself where none was. */
  arranged(map: Mapped, aspect: number): Mapped {
    if (this.movedCount === 0) return map;
    const uv = map.uv.slice();
    const facesOf = new Map<number, number[]>(this.movedIslands(map).map((island) => [island, []]));
    map.island.forEach((island, f) => facesOf.get(island)?.push(f));
    for (const [face, motion] of this.#motions) place(facesOf.get(map.island[face]!)!, motion, aspect, map.uv, uv);
    return {...map, uv};
  }

  asOption({part, faceInPart}: Surface): LockedIsland[] {
    return this.faces.map((face) => ({mesh: part[face]!, face: faceInPart[face]!, ...this.#motions.get(face)}));
  }
}
