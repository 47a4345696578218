// The layout: triangles where their texture coordinates are. Pan by pointer or arrow keys, zoom by
// wheel, pinch or + and -.
import {DoubleSide, LineBasicMaterial, LineSegments, BufferAttribute, BufferGeometry, MeshBasicMaterial, OrthographicCamera} from 'three';

import {boxesOf, faceAround} from './pick.js';
import {Stage, type Theme} from './stage.js';

const MARGIN = 1.06;

/** Points of the page as points of the scene: U counts the width of a texture that is not square. */
export function flat(uv: ArrayLike<number>, aspect: number, height = 0): Float32Array {
  const positions = new Float32Array((uv.length / 2) * 3);
  for (let c = 0; c < uv.length / 2; c += 1) {
    positions[3 * c] = uv[2 * c]! * aspect;
    positions[3 * c + 1] = uv[2 * c + 1]!;
    positions[3 * c + 2] = height;
  }
  return positions;
}

export class FlatView extends Stage {
  protected readonly isLit = false;
  protected readonly camera = new OrthographicCamera(-1, 1, 1, -1, -10, 10);
  /** Takes a gesture for itself: dragging begins at a point of the page. */
  onGrab?: (event: PointerEvent) => boolean;
  onDrag?: (u: number, v: number, ends: boolean) => void;
  readonly #frame = new LineSegments(new BufferGeometry(), new LineBasicMaterial());
  readonly #pointers = new Map<number, PointerEvent>();
  #uv: Float32Array | undefined;
  #boxes: Float32Array = new Float32Array();
  #aspect = 1;
  #pages = 1;
  #middle = [0.5, 0.5];
  #height = MARGIN; // of the page in the view
  #shape = 1;
  #drags = false;

  constructor(canvas: HTMLCanvasElement) {
    super(canvas, new MeshBasicMaterial({vertexColors: true, side: DoubleSide}));
    this.scene.add(this.#frame);
    canvas.addEventListener('wheel', (event) => this.#wheel(event), {passive: false});
    canvas.addEventListener('pointerdown', (event) => this.#down(event));
    canvas.addEventListener('pointermove', (event) => this.#move(event));
    for (const kind of ['pointerup', 'pointercancel'] as const) canvas.addEventListener(kind, (event) => this.#up(event));
    canvas.addEventListener('keydown', (event) => this.#key(event));
  }

  show(uv: Float32Array | undefined, aspect: number, pages: number): void {
    const isOther = this.#aspect !== aspect || this.#pages !== pages || !this.#uv;
    [this.#uv, this.#aspect, this.#pages] = [uv, aspect, pages];
    this.#boxes = boxesOf(uv ?? new Float32Array(), 2);
    this.setTriangles(flat(uv ?? [], aspect), undefined, uv);
    const corners = Array.from({length: pages}, (_, p) => [p, 0, p + 1, 0, p + 1, 0, p + 1, 1, p + 1, 1, p, 1, p, 1, p, 0]).flat();
    this.#frame.geometry.dispose();
    this.#frame.geometry = new BufferGeometry().setAttribute('position', new BufferAttribute(flat(corners, aspect), 3));
    if (isOther) this.fit();
  }

  override setTheme(theme: Theme): void {
    this.#frame.material.color.set(theme.line);
    super.setTheme(theme);
  }

  /** All pages. */
  fit(): void {
    const width = this.#aspect * this.#pages;
    this.#middle = [width / 2, 0.5];
    this.#height = Math.max(1, width / this.#shape) * MARGIN;
    this.draw();
  }

  protected shape(aspect: number): void {
    this.#shape = aspect;
    const [x, y] = this.#middle as [number, number];
    Object.assign(this.camera, {left: x - (this.#height * aspect) / 2, right: x + (this.#height * aspect) / 2,
      bottom: y - this.#height / 2, top: y + this.#height / 2});
    this.camera.updateProjectionMatrix();
  }

  /** The point of the page at an event, or in the middle of the view. */
  uvAt(event?: {clientX: number; clientY: number}): [number, number] {
    const [x, y] = event ? this.at(event) : [0, 0];
    return [(this.#middle[0]! + (x * this.#height * this.#shape) / 2) / this.#aspect, this.#middle[1]! + (y * this.#height) / 2];
  }

  /** The length of so many pixels on the page, along V. */
  lengthOf(pixels: number): number {
    return (pixels * this.#height) / this.canvas.clientHeight;
  }

  hit(event?: {clientX: number; clientY: number}): number {
    return this.#uv ? faceAround(this.#uv, this.#boxes, ...this.uvAt(event)) : -1;
  }

  #zoom(by: number, event?: {clientX: number; clientY: number}): void {
    const before = this.uvAt(event);
    this.#height = Math.min(Math.max(this.#height * by, 0.002), 20);
    const after = this.uvAt(event);
    this.#pan((before[0] - after[0]) * this.#aspect, before[1] - after[1]);
  }

  #pan(x: number, y: number): void {
    this.#middle = [this.#middle[0]! + x, this.#middle[1]! + y];
    this.draw();
  }

  #wheel(event: WheelEvent): void {
    event.preventDefault();
    this.#zoom(Math.exp(Math.sign(event.deltaY) * Math.min(Math.abs(event.deltaY), 60) * 0.003), event);
  }

  #down(event: PointerEvent): void {
    this.#pointers.set(event.pointerId, event);
    this.canvas.setPointerCapture(event.pointerId);
    this.#drags = this.#pointers.size === 1 && (this.onGrab?.(event) ?? false);
  }

  #move(event: PointerEvent): void {
    const before = this.#pointers.get(event.pointerId);
    if (!before) return;
    if (this.#drags) this.onDrag?.(...this.uvAt(event), false);
    else if (this.#pointers.size === 1) this.#panBy(before, event);
    else this.#pinch(before, event);
    this.#pointers.set(event.pointerId, event);
  }

  #panBy(before: PointerEvent, event: PointerEvent): void {
    this.#pan(this.lengthOf(before.clientX - event.clientX), this.lengthOf(event.clientY - before.clientY));
  }

  #pinch(before: PointerEvent, event: PointerEvent): void {
    const other = [...this.#pointers.values()].find(({pointerId}) => pointerId !== event.pointerId)!;
    const distance = (one: PointerEvent) => Math.hypot(one.clientX - other.clientX, one.clientY - other.clientY) || 1;
    this.#zoom(distance(before) / distance(event), other);
  }

  #up(event: PointerEvent): void {
    this.#pointers.delete(event.pointerId);
    if (this.#drags) this.onDrag?.(...this.uvAt(event), true);
    this.#drags = false;
  }

  #key(event: KeyboardEvent): void {
    const step = this.#height / 12;
    const actions: Record<string, () => void> = {
      ArrowLeft: () => this.#pan(-step, 0), ArrowRight: () => this.#pan(step, 0), ArrowUp: () => this.#pan(0, step),
      ArrowDown: () => this.#pan(0, -step), '+': () => this.#zoom(0.8), '=': () => this.#zoom(0.8), '-': () => this.#zoom(1.25), 0: () => this.fit(),
    };
    const action = event.ctrlKey || event.metaKey || event.altKey || event.defaultPrevented ? undefined : actions[event.key];
    if (!action) return;
    event.preventDefault();
    action();
  }
}
