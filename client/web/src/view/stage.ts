// What both views have in common: a canvas that draws when something has changed, with triangles,
// lines and marks in it.
import {
  BufferAttribute, BufferGeometry, type Camera, Color, DoubleSide, LineBasicMaterial, LineSegments, type Material, Mesh,
  MeshBasicMaterial, Points, PointsMaterial, Scene, Sphere, type Texture, WebGLRenderer,
} from 'three';

import {Hatching} from './hatching.js';
import {type Skin, materialsOf} from './skin.js';

/** What is shown beside the triangles. */
export interface Visible {
  seams: boolean;
  wire: boolean;
  worst: boolean;
  overlaps: boolean;
}

export interface Theme {
  background: string;
  line: string;
  seam: string;
  mark: string;
  pin: string;
  frame: string;
}

function geometryOf(positions: Float32Array): BufferGeometry {
  const geometry = new BufferGeometry().setAttribute('position', new BufferAttribute(positions, 3));
  geometry.boundingSphere = new Sphere(); // else it is computed to sort what is drawn, which has an order of its own
  return geometry;
}

/** None where the browser has no WebGL: it is off, or the graphics card is blocked. */
function rendererOf(canvas: HTMLCanvasElement): WebGLRenderer | undefined {
  const context = canvas.getContext('webgl2', {antialias: true});
  return context ? new WebGLRenderer({canvas, context}) : undefined;
}

export abstract class Stage {
  readonly scene = new Scene();
  readonly #renderer: WebGLRenderer | undefined;
  protected abstract readonly camera: Camera;
  protected abstract readonly isLit: boolean;
  readonly #seams = new LineSegments(new BufferGeometry(), new LineBasicMaterial());
  readonly #marks = new LineSegments(new BufferGeometry(), new LineBasicMaterial({depthTest: false, linewidth: 2}));
  readonly #hatched = new Mesh(new BufferGeometry(), new Hatching());
  readonly #worst = new LineSegments(new BufferGeometry(), new LineBasicMaterial());
  readonly #edits = new LineSegments(new BufferGeometry(), new LineBasicMaterial({depthTest: false}));
  readonly #picked = new Mesh(new BufferGeometry(), new MeshBasicMaterial({side: DoubleSide, transparent: true, opacity: 0.55, depthTest: false}));
  readonly #locked = new Mesh(new BufferGeometry(), new MeshBasicMaterial({side: DoubleSide, transparent: true, opacity: 0.25, depthWrite: false}));
  readonly #dots = new Points(new BufferGeometry(), new PointsMaterial({size: 7, sizeAttenuation: false, depthTest: false}));
  readonly #wire: Mesh<BufferGeometry, MeshBasicMaterial>;
  readonly #mesh: Mesh<BufferGeometry, Material | Material[]>;
  #materials: (Material & {map: Texture | null})[] = [];
  #uv: Float32Array = new Float32Array();
  #anyLocked = false;
  #asked = false;
  #size = '';

  constructor(readonly canvas: HTMLCanvasElement, protected readonly material: Material & {map: Texture | null}) {
    this.#renderer = rendererOf(canvas);
    this.#mesh = new Mesh(new BufferGeometry(), material);
    const wire = new MeshBasicMaterial({wireframe: true, transparent: true, opacity: 0.35, polygonOffset: true, polygonOffsetFactor: -1});
    this.#wire = new Mesh(this.#mesh.geometry, wire);
    this.#wire.visible = false;
    [this.#mesh, this.#wire, this.#hatched, this.#seams, this.#worst, this.#marks, this.#locked, this.#edits, this.#picked, this.#dots].forEach((object, order) => {
      object.frustumCulled = false;
      object.renderOrder = order;
      this.scene.add(object);
    });
    new ResizeObserver(() => this.draw()).observe(canvas);
  }

  /** Whether nothing that is shown is ever seen. */
  get isBlank(): boolean {
    return !this.#renderer;
  }

  protected setTriangles(positions: Float32Array, normals: Float32Array | undefined, uv: Float32Array | undefined): void {
    this.#mesh.geometry.dispose();
    const geometry = geometryOf(positions);
    if (normals) geometry.setAttribute('normal', new BufferAttribute(normals, 3));
    this.#uv = uv ?? new Float32Array((positions.length / 3) * 2);
    geometry.setAttribute('uv', new BufferAttribute(this.#uv.slice(), 2));
    geometry.setAttribute('color', new BufferAttribute(new Float32Array(positions.length).fill(0.5), 3));
    this.#mesh.geometry = this.#wire.geometry = geometry;
    this.draw();
  }

  /** Other texture coordinates for the same triangles. */
  protected setUv(uv: Float32Array): void {
    this.#uv = uv;
    const attribute = this.#mesh.geometry.getAttribute('uv') as BufferAttribute;
    attribute.copyArray(uv);
    attribute.needsUpdate = true;
    this.draw();
  }

  setColours(colours: Float32Array, map: Texture | null): void {
    const attribute = this.#mesh.geometry.getAttribute('color') as BufferAttribute;
    attribute.copyArray(colours); // in place: the buffer of a replaced attribute is never freed
    attribute.needsUpdate = true;
    if (Boolean(this.material.map) !== Boolean(map)) this.material.needsUpdate = true;
    this.material.map = map;
    this.draw();
  }

  /** Shows the triangles in their materials, or without a skin by colours again. */
  setSkin(skin: Skin | undefined): void {
    if (!skin && this.#materials.length === 0) return;
    const {geometry} = this.#mesh;
    for (const material of this.#materials) {
      material.map?.dispose();
      material.dispose();
    }
    this.#materials = skin ? materialsOf(skin, this.isLit) : [];
    geometry.clearGroups();
    for (const {start, count, look} of skin?.runs ?? []) geometry.addGroup(3 * start, 3 * count, look);
    this.#mesh.material = skin ? this.#materials : this.material;
    const uv = geometry.getAttribute('uv') as BufferAttribute;
    uv.copyArray(skin && uv.count > 0 ? skin.uv : this.#uv);
    uv.needsUpdate = true;
    this.#showLocked();
    this.draw();
  }

  setSeams(lines: Float32Array): void {
    this.#replace(this.#seams, lines);
  }

  /** Lines over everything: the island that is picked, paths that are marked. */
  setMarks(lines: Float32Array): void {
    this.#replace(this.#marks, lines);
  }

  /** Lines that were marked by hand. */
  setEdits(lines: Float32Array): void {
    this.#replace(this.#edits, lines);
  }

  /** Islands that stay where they are. */
  setLocked(triangles: Float32Array): void {
    this.#replace(this.#locked, triangles);
    this.#anyLocked = triangles.length > 0;
    this.#showLocked();
  }

  /** No tint lies over materials, whose colours it would change. */
  #showLocked(): void {
    this.#locked.visible = this.#anyLocked && !(this.isLit && this.#materials.length > 0);
  }

  setPicked(triangles: Float32Array): void {
    this.#replace(this.#picked, triangles);
  }

  setDots(points: Float32Array): void {
    this.#replace(this.#dots, points);
  }

  /** Triangles that overlap others. */
  setHatched(triangles: Float32Array): void {
    this.#replace(this.#hatched, triangles);
  }

  /** The frame of the worst chart. */
  setFrame(lines: Float32Array): void {
    this.#replace(this.#worst, lines);
  }

  setVisible({seams, wire, worst, overlaps}: Visible): void {
    this.#seams.visible = seams;
    this.#wire.visible = wire;
    this.#worst.visible = worst;
    this.#hatched.visible = overlaps;
    this.draw();
  }

  setTheme(theme: Theme): void {
    this.scene.background = new Color(theme.background);
    this.#seams.material.color.set(theme.seam);
    this.#wire.material.color.set(theme.line);
    this.#hatched.material.color.set(theme.seam);
    this.#worst.material.color.set(theme.frame);
    this.#marks.material.color.set(theme.mark);
    this.#picked.material.color.set(theme.mark);
    this.#edits.material.color.set(theme.pin);
    this.#locked.material.color.set(theme.pin);
    this.#dots.material.color.set(theme.pin);
    this.draw();
  }

  #replace(object: Mesh<BufferGeometry> | LineSegments<BufferGeometry> | Points<BufferGeometry>, positions: Float32Array): void {
    object.geometry.dispose();
    object.geometry = geometryOf(positions);
    object.visible = positions.length > 0;
    this.draw();
  }

  /** Asks for a picture. */
  draw(): void {
    if (this.#asked) return;
    this.#asked = true;
    requestAnimationFrame(() => {
      this.#asked = false;
      const {clientWidth: width, clientHeight: height} = this.canvas;
      if (width === 0 || height === 0) return;
      this.shape(width / height);
      this.#resize(width, height, Math.min(devicePixelRatio, 2));
      this.#renderer?.render(this.scene, this.camera);
    });
  }

  /** Only where the size is another: a canvas that is given its own size gets a new buffer all the same. */
  #resize(width: number, height: number, ratio: number): void {
    const size = `${width} ${height} ${ratio}`;
    if (size === this.#size) return;
    this.#size = size;
    this.#renderer?.setPixelRatio(ratio);
    this.#renderer?.setSize(width, height, false);
  }

  /** Fits the camera to the shape of the canvas. */
  protected abstract shape(aspect: number): void;

  /** Where an event is on the canvas, from -1 to 1. */
  protected at(event: {clientX: number; clientY: number}): [number, number] {
    const box = this.canvas.getBoundingClientRect();
    return [(2 * (event.clientX - box.left)) / box.width - 1, 1 - (2 * (event.clientY - box.top)) / box.height];
  }
}
