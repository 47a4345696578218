// The mesh and its layout beside each other, coloured alike; what is pointed at in one is shown in both.
import type {Texture} from 'three';

import {oncePerFrame} from '../base/dom.js';
import {FlatView, flat} from './flat.js';
import {borderOf, bothSides, frameOf, linesOf, trianglesOf} from './lines.js';
import {type Colouring, type Shown, paint} from './paint.js';
import type {Skin} from './skin.js';
import {SolidView} from './solid.js';
import type {Theme, Visible} from './stage.js';
import {checkerboard} from './textures.js';

const HOVER_FACES = 600_000; // beyond them a pointer that moves is not followed

export interface Picked {
  face: number;
  island: number | undefined;
}

export class Viewer {
  readonly solid: SolidView;
  readonly flat: FlatView;
  /** A face was picked (or none), by a click, a key or setIsland. */
  onPick?: (picked: Picked | undefined) => void;
  /** Takes a click on the mesh for itself. */
  onClick?: (view: 'solid' | 'flat', event: MouseEvent | undefined) => boolean;
  /** Another map is shown. */
  onShow?: () => void;
  readonly #checker: Texture = checkerboard();
  readonly #checkerFlat: Texture = checkerboard();
  /** An image of the person's own, for each view: a texture belongs to one. */
  #image: Texture | undefined;
  #imageFlat: Texture | undefined;
  #what: Shown | undefined;
  #colouring: Colouring = 'checker';
  #selected: Picked | undefined;
  #hovered = -1;

  constructor(solid: HTMLCanvasElement, layout: HTMLCanvasElement) {
    this.solid = new SolidView(solid);
    this.flat = new FlatView(layout);
    this.#listen(solid, (event) => this.solid.hit(event)?.face ?? -1, 'solid');
    this.#listen(layout, (event) => this.flat.hit(event), 'flat');
  }

  get what(): Shown | undefined {
    return this.#what;
  }

  get selected(): Picked | undefined {
    return this.#selected;
  }

  /** Islands that are locked; map: where they are dragged to just now. */
  showLocked(islands: ReadonlySet<number>, map = this.#what?.map): void {
    const {surface, aspect = 1} = this.#what ?? {};
    const faces = Array.from(map?.island ?? []).flatMap((island, f) => (islands.has(island) ? [f] : []));
    this.solid.setLocked(surface ? trianglesOf(faces, surface.positions, 3) : new Float32Array());
    this.flat.setLocked(map ? flat(trianglesOf(faces, map.uv, 2), aspect, 1) : new Float32Array());
  }

  show(what: Shown, keepsView = false): void {
    const isOther = this.#what?.surface !== what.surface || this.#what?.map !== what.map;
    this.#what = what;
    if (isOther) {
      this.solid.show(what.surface, what.map?.uv, keepsView);
      this.flat.show(what.map?.uv, what.aspect, what.pages);
      const {surface, map} = what;
      this.solid.setSeams(map ? linesOf(map.seams, surface.positions, 3) : new Float32Array());
      this.flat.setSeams(map ? flat(linesOf(bothSides(map, surface), map.uv, 2), what.aspect, 1) : new Float32Array());
      this.#showFaults(what);
      this.select(undefined);
    }
    this.colour(this.#colouring);
    this.onShow?.();
  }

  /** Triangles that overlap, and the worst chart. */
  #showFaults({surface, map, overlapping = new Uint32Array(), worst, aspect}: Shown): void {
    const none = new Float32Array();
    this.solid.setHatched(trianglesOf(overlapping, surface.positions, 3));
    this.flat.setHatched(map ? flat(trianglesOf(overlapping, map.uv, 2), aspect, 1) : none);
    this.solid.setFrame(map && worst !== undefined ? frameOf(worst, map, surface.positions, 3) : none);
    this.flat.setFrame(map && worst !== undefined ? flat(frameOf(worst, map, map.uv, 2, 0.006), aspect, 2) : none);
  }

  colour(colouring: Colouring): void {
    this.#colouring = colouring;
    if (!this.#what) return;
    const colours = paint(colouring, this.#what);
    const [solid, layout] = this.#what.map ? this.#textures() : [];
    this.solid.setColours(colours, solid ?? null);
    this.flat.setColours(this.#what.map ? colours : new Float32Array(), layout ?? null);
    this.#wear(undefined);
    if (colouring === 'materials') void this.#dress(this.#what);
  }

  #wear(skin: Skin | undefined): void {
    this.solid.setSkin(skin);
    this.flat.setSkin(skin);
  }

  /** The materials, once they are there. */
  async #dress(what: Shown): Promise<void> {
    const skin = await what.skin?.();
    if (what === this.#what && this.#colouring === 'materials') this.#wear(skin);
  }

  #textures(): (Texture | undefined)[] {
    if (this.#colouring === 'checker') return [this.#checker, this.#checkerFlat];
    return this.#colouring === 'image' ? [this.#image, this.#imageFlat] : [];
  }

  showImage(image: Texture): void {
    const old = [this.#image, this.#imageFlat];
    [this.#image, this.#imageFlat] = [image, image.clone()];
    this.colour('image');
    for (const texture of old) texture?.dispose();
  }

  setTheme(theme: Theme): void {
    this.solid.setTheme(theme);
    this.flat.setTheme(theme);
  }

  setVisible(visible: Visible): void {
    this.solid.setVisible(visible);
    this.flat.setVisible({...visible, seams: true});
  }

  /** Picks a whole island, or none. */
  select(picked: Picked | undefined): void {
    this.#selected = picked;
    this.#highlight(picked);
    this.onPick?.(picked);
  }

  selectIsland(island: number): void {
    const face = this.#what?.map?.island.indexOf(island) ?? -1;
    if (face >= 0) this.select({face, island});
  }

  #pickedAt(face: number): Picked | undefined {
    return face < 0 ? undefined : {face, island: this.#what?.map?.island[face]};
  }

  /** The triangle under the pointer, and the border of its island. */
  #highlight(picked: Picked | undefined): void {
    const {surface, map, aspect = 1} = this.#what ?? {};
    const face = picked?.face;
    this.#hovered = face ?? -1;
    const border = map && surface && picked?.island !== undefined ? borderOf(picked.island, map, surface) : [];
    const triangle = surface && face !== undefined ? surface.positions.subarray(9 * face, 9 * face + 9) : new Float32Array();
    this.solid.setPicked(triangle.slice());
    this.solid.setMarks(surface ? linesOf(border, surface.positions, 3) : new Float32Array());
    this.flat.setPicked(map && face !== undefined ? flat(map.uv.subarray(6 * face, 6 * face + 6), aspect, 2) : new Float32Array());
    this.flat.setMarks(map ? flat(linesOf(border, map.uv, 2), aspect, 2) : new Float32Array());
  }

  #listen(canvas: HTMLCanvasElement, faceAt: (event?: MouseEvent) => number, view: 'solid' | 'flat'): void {
    let pressed = [0, 0];
    const hover = oncePerFrame((event: PointerEvent) => {
      if (event.buttons || (this.#what?.surface.faces ?? 0) > HOVER_FACES) return;
      const face = faceAt(event);
      if (face === this.#hovered) return;
      this.#highlight(face < 0 ? this.#selected : this.#pickedAt(face));
      this.#hovered = face;
    });
    canvas.addEventListener('pointermove', hover);
    canvas.addEventListener('pointerleave', () => requestAnimationFrame(() => this.#highlight(this.#selected)));
    canvas.addEventListener('pointerdown', (event) => (pressed = [event.clientX, event.clientY]));
    canvas.addEventListener('click', (event) => {
      if (Math.hypot(event.clientX - pressed[0]!, event.clientY - pressed[1]!) > 4) return;
      if (!this.onClick?.(view, event)) this.select(this.#pickedAt(faceAt(event)));
    });
    canvas.addEventListener('keydown', (event) => {
      if (event.key === 'Escape') this.select(undefined);
      if (event.key !== 'Enter' || event.defaultPrevented) return;
      event.preventDefault();
      if (!this.onClick?.(view, undefined)) this.select(this.#pickedAt(faceAt()));
    });
  }
}
