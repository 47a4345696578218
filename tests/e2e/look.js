// Runs in the browser: window.compare(old, now) draws two GLBs in base64 from eight sides, and tells
// for each side how far their pixels differ that lie within the charts of the second one.
import * as THREE from "three";
import { GLTFLoader } from "three/addons/loaders/GLTFLoader.js";

const SIZE = 256;

const renderer = new THREE.WebGLRenderer({ antialias: false, preserveDrawingBuffer: true });
renderer.setSize(SIZE, SIZE, false);

function pixels() {
  const gl = renderer.getContext();
  const bytes = new Uint8Array(4 * SIZE * SIZE);
  gl.readPixels(0, 0, SIZE, SIZE, gl.RGBA, gl.UNSIGNED_BYTE, bytes);
  return bytes;
}

/** For each vertex the least number of a vertex that triangles connect it to. */
function chartsOf(geometry) {
  const parent = Array.from({ length: geometry.attributes.position.count }, (_, i) => i);
  const root = (i) => {
    while (parent[i] !== i) i = parent[i] = parent[parent[i]];
    return i;
  };
  const index = geometry.index.array;
  for (let i = 0; i < index.length; i += 3)
    for (const k of [1, 2]) {
      const [a, b] = [root(index[i]), root(index[i + k])];
      parent[Math.max(a, b)] = Math.min(a, b);
    }
  return parent.map((_, i) => root(i));
}

/** The model with a flat colour for each chart, from 1 on. */
function numbered(model) {
  let count = 0;
  const copy = model.clone();
  copy.traverse((mesh) => {
    if (!mesh.isMesh) return;
    const numbers = new Map();
    const colours = chartsOf(mesh.geometry).flatMap((chart) => {
      if (!numbers.has(chart)) numbers.set(chart, ++count);
      const number = numbers.get(chart);
      return [number & 255, number >> 8, 0].map((byte) => byte / 255);
    });
    mesh.geometry = mesh.geometry.clone();
    mesh.geometry.setAttribute("color", new THREE.BufferAttribute(new Float32Array(colours), 3));
    mesh.material = new THREE.ShaderMaterial({
      side: THREE.DoubleSide,
      vertexShader: "attribute vec3 color; varying vec3 c; void main() { c = color; gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0); }",
      fragmentShader: "varying vec3 c; void main() { gl_FragColor = vec4(c, 1.0); }",
    });
  });
  return copy;
}

function cameraAt(direction, sphere) {
  const camera = new THREE.OrthographicCamera(-sphere.radius, sphere.radius, sphere.radius, -sphere.radius, 0, 4 * sphere.radius);
  camera.position.copy(sphere.center).addScaledVector(direction, 2 * sphere.radius);
  camera.lookAt(sphere.center);
  return camera;
}

/** The pictures of an asset from eight sides, and for each pixel the chart that it shows, or 0. */
async function look(base64) {
  const bytes = Uint8Array.from(atob(base64), (c) => c.charCodeAt(0));
  const { scene: model } = await new GLTFLoader().parseAsync(bytes.buffer, "");
  const sphere = new THREE.Box3().setFromObject(model).getBoundingSphere(new THREE.Sphere());
  const drawn = new THREE.Scene().add(model, new THREE.AmbientLight(0xffffff, 1));
  const sun = new THREE.DirectionalLight(0xffffff, 2);
  sun.position.set(1, 2, 3);
  drawn.add(sun);
  const charts = new THREE.Scene().add(numbered(model));
  return Array.from({ length: 8 }, (_, i) => {
    const direction = new THREE.Vector3(i & 1 ? 1 : -1, i & 2 ? 0.8 : -0.8, i & 4 ? 1.2 : -1.2).normalize();
    const camera = cameraAt(direction, sphere);
    renderer.render(drawn, camera);
    const colours = pixels();
    renderer.render(charts, camera);
    const numbers = pixels();
    return { colours, charts: Array.from({ length: SIZE * SIZE }, (_, k) => numbers[4 * k] + 256 * numbers[4 * k + 1]) };
  });
}

/** Whether all pixels up to two away show the same chart. */
function isWithinChart(charts, i) {
  const [x, y] = [i % SIZE, Math.floor(i / SIZE)];
  if (charts[i] === 0 || Math.min(x, y) < 2 || Math.max(x, y) >= SIZE - 2) return false;
  for (let dy = -2; dy <= 2; ++dy)
    for (let dx = -2; dx <= 2; ++dx) if (charts[i + dy * SIZE + dx] !== charts[i]) return false;
  return true;
}

window.compare = async (old, now) => {
  const [before, after] = [await look(old), await look(now)];
  return after.map(({ colours, charts }, side) => {
    const within = [...charts.keys()].filter((i) => isWithinChart(charts, i));
    const differs = (i, c) => Math.abs(colours[4 * i + c] - before[side].colours[4 * i + c]);
    const sum = within.reduce((all, i) => all + differs(i, 0) + differs(i, 1) + differs(i, 2), 0);
    return { difference: sum / 3 / within.length, compared: within.length, shown: charts.filter((chart) => chart > 0).length };
  });
};
