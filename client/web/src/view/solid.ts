// The mesh in space: orbit by pointer or arrow keys.
import {DirectionalLight, DoubleSide, HemisphereLight, MeshLambertMaterial, PerspectiveCamera, Vector3} from 'three';
import {OrbitControls} from 'three/examples/jsm/controls/OrbitControls.js';

import type {Surface} from '../mesh/surface.js';
import {normalsOf} from './normals.js';
import {boxesOf, faceAlong} from './pick.js';
import {Stage} from './stage.js';

const STEP = Math.PI / 16;

export interface Hit {
  face: number;
  point: number[];
}

function boxOf(positions: Float32Array): {centre: Vector3; radius: number} {
  const [low, high] = [new Vector3(Infinity, Infinity, Infinity), new Vector3(-Infinity, -Infinity, -Infinity)];
  const point = new Vector3();
  for (let at = 0; at < positions.length; at += 3) {
    point.fromArray(positions, at);
    low.min(point);
    high.max(point);
  }
  const centre = low.clone().add(high).multiplyScalar(0.5);
  let radius = 0;
  for (let at = 0; at < positions.length; at += 3) radius = Math.max(radius, centre.distanceTo(point.fromArray(positions, at)));
  return {centre, radius: radius || 1};
}

export class SolidView extends Stage {
  protected readonly isLit = true;
  protected readonly camera = new PerspectiveCamera(35, 1, 0.01, 100);
  readonly #controls: OrbitControls;
  readonly #lamp = new DirectionalLight(0xffffff, 2.2);
  #surface: Surface | undefined;
  #boxes: Float32Array = new Float32Array();
  #normals: Float32Array | undefined;
  #home = {centre: new Vector3(), radius: 1};

  constructor(canvas: HTMLCanvasElement) {
    super(canvas, new MeshLambertMaterial({vertexColors: true, side: DoubleSide, polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1}));
    this.#controls = new OrbitControls(this.camera, canvas);
    this.#controls.addEventListener('change', () => this.draw());
    this.scene.add(new HemisphereLight(0xffffff, 0x999999, 1.6), this.camera);
    this.camera.add(this.#lamp);
    this.#lamp.position.set(0.4, 0.7, 1);
    canvas.addEventListener('keydown', (event) => this.#key(event));
  }

  /** Shows a surface; keeps the view if it is the same mesh in another map. */
  show(surface: Surface, uv: Float32Array | undefined, keepsView = false): void {
    const isNew = this.#surface !== surface;
    this.#surface = surface;
    if (isNew) [this.#normals, this.#boxes] = [normalsOf(surface), boxesOf(surface.positions, 3)];
    if (isNew || !uv) this.setTriangles(surface.positions, this.#normals, uv);
    else this.setUv(uv);
    if (isNew && !keepsView) {
      this.#home = boxOf(surface.positions);
      this.fit();
    }
  }

  /** The whole mesh, from the front and a little above. */
  fit(): void {
    const {centre, radius} = this.#home;
    const distance = radius / Math.sin(((this.camera.fov / 2) * Math.PI) / 180) / Math.min(1, this.camera.aspect);
    this.camera.near = distance / 1000;
    this.camera.far = distance * 10;
    this.#controls.target.copy(centre);
    this.camera.position.copy(centre).addScaledVector(new Vector3(0.45, 0.35, 1).normalize(), distance * 1.02);
    this.#controls.update();
    this.draw();
  }

  protected shape(aspect: number): void {
    if (this.camera.aspect === aspect) return;
    this.camera.aspect = aspect;
    this.camera.updateProjectionMatrix();
  }

  /** What is under an event, or in the middle of the view. */
  hit(event?: {clientX: number; clientY: number}): Hit | undefined {
    if (!this.#surface) return undefined;
    const [x, y] = event ? this.at(event) : [0, 0];
    const origin = this.camera.position;
    const direction = new Vector3(x, y, 0.5).unproject(this.camera).sub(origin).normalize();
    const {face, distance} = faceAlong(this.#surface.positions, this.#boxes, origin.toArray(), direction.toArray());
    return face < 0 ? undefined : {face, point: origin.clone().addScaledVector(direction, distance).toArray()};
  }

  #turn(around: number, up: number): void {
    const offset = this.camera.position.clone().sub(this.#controls.target);
    const length = offset.length();
    const polar = Math.min(Math.max(Math.acos(offset.y / length) - up, 0.01), Math.PI - 0.01);
    const azimuth = Math.atan2(offset.x, offset.z) + around;
    this.camera.position.copy(this.#controls.target).add(new Vector3().setFromSphericalCoords(length, polar, azimuth));
    this.#controls.update();
  }

  #key(event: KeyboardEvent): void {
    const zoom = (by: number) => this.camera.position.sub(this.#controls.target).multiplyScalar(by).add(this.#controls.target);
    const actions: Record<string, () => void> = {
      ArrowLeft: () => this.#turn(-STEP, 0), ArrowRight: () => this.#turn(STEP, 0),
      ArrowUp: () => this.#turn(0, STEP), ArrowDown: () => this.#turn(0, -STEP),
      '+': () => zoom(0.85), '=': () => zoom(0.85), '-': () => zoom(1 / 0.85), 0: () => this.fit(),
    };
    const action = event.ctrlKey || event.metaKey || event.altKey ? undefined : actions[event.key];
    if (!action) return;
    event.preventDefault();
    action();
    this.#controls.update();
    this.draw();
  }
}
