// glTF and GLB by the loader of three, for its decoders: Draco and meshopt are loaded when a document
// asks for them. Materials and images are kept from it: looks.ts reads of them what the page shows.
import {BufferAttribute, type BufferGeometry, type InterleavedBufferAttribute, LoadingManager, type Mesh} from 'three';
import {GLTFLoader} from 'three/examples/jsm/loaders/GLTFLoader.js';

import {type Model, type Part, joinedNumbers, uvOfCorners} from '../mesh/model.js';
import {lastOf, list} from '../base/words.js';
import {UnreadableError} from './error.js';
import type {Named} from './pick.js';
import {looksOf} from './looks.js';
import {type Document, documentOf, meshesWithTriangles, placesOf} from './scene.js';

/** A document with nothing but geometry; its primitives do not share a material. */
function geometryOnly(document: Document): Document {
  const {materials: _1, textures: _2, images: _3, samplers: _4, animations: _5, skins: _6, cameras: _7, ...kept} = document;
  const meshes = (kept.meshes ?? []).map((mesh) => ({...mesh, primitives: mesh.primitives.map(({material: _, targets: __, ...rest}) => rest)}));
  return {...kept, meshes, nodes: (kept.nodes ?? []).map(({skin: _, ...node}) => ({...node, extensions: undefined}))} as Document;
}

/** A GLB with another document before the same bytes, or the document itself. */
function withDocument(bytes: ArrayBuffer, document: Document): ArrayBuffer | string {
  const text = JSON.stringify(document);
  const view = new DataView(bytes);
  if (view.getUint32(0, true) !== 0x46546c67) return text;
  const json = new TextEncoder().encode(text.padEnd(Math.ceil(text.length / 4) * 4));
  const padded = Math.ceil(json.length / 4) * 4;
  const rest = new Uint8Array(bytes, 20 + view.getUint32(12, true));
  const out = new Uint8Array(20 + padded + rest.length).fill(32);
  const head = new DataView(out.buffer);
  [0x46546c67, 2, out.length, padded, 0x4e4f534a].forEach((word, i) => head.setUint32(4 * i, word, true));
  out.set(json, 20);
  out.set(rest, 20 + padded);
  return out.buffer;
}

async function addDecoders(loader: GLTFLoader, document: Document): Promise<void> {
  const used = JSON.stringify(document['extensionsUsed'] ?? []);
  if (/KHR_draco/.test(used)) loader.setDRACOLoader(await (await import('./draco.js')).dracoLoader());
  if (/meshopt/.test(used)) loader.setMeshoptDecoder((await import('three/examples/jsm/libs/meshopt_decoder.module.js')).MeshoptDecoder);
}

function numbersOf(attribute: BufferAttribute | InterleavedBufferAttribute): Float32Array {
  const numbers = new Float32Array(attribute.count * attribute.itemSize);
  for (let v = 0; v < attribute.count; v += 1)
    for (let i = 0; i < attribute.itemSize; i += 1) numbers[v * attribute.itemSize + i] = attribute.getComponent(v, i);
  return numbers;
}

/** UVs of a geometry by the number of their set. three has V pointing down here, as glTF does. */
function uvSetsOf(geometry: BufferGeometry, faces: Uint32Array) {
  return ['uv', 'uv1', 'uv2', 'uv3'].flatMap((name, set) => {
    const attribute = geometry.getAttribute(name);
    if (!attribute) return [];
    const uv = numbersOf(attribute).map((value, i) => (i % 2 === 1 ? 1 - value : value));
    return [{name: `TEXCOORD_${set}`, uv: uvOfCorners(uv, faces)}];
  });
}

/** The faces of pieces whose vertices are put after each other. */
function joinedFaces(pieces: {positions: Float32Array; faces: Uint32Array}[]): Uint32Array {
  const all = new Uint32Array(pieces.reduce((sum, {faces}) => sum + faces.length, 0));
  let [at, base] = [0, 0];
  for (const {positions, faces} of pieces) {
    all.set(faces.map((v) => v + base), at);
    at += faces.length;
    base += positions.length / 3;
  }
  return all;
}

/** looks: of each geometry. */
function partOf(geometries: BufferGeometry[], looks: number[], name: string, places: number[][]): Part {
  const pieces = geometries.map((geometry) => {
    const positions = numbersOf(geometry.getAttribute('position'));
    const faces = Uint32Array.from(geometry.index?.array ?? Array.from({length: positions.length / 3}, (_, i) => i));
    return {positions, faces, uvSets: uvSetsOf(geometry, faces)};
  });
  const faces = joinedFaces(pieces);
  const sets = pieces[0]!.uvSets.map(({name: set}) => set)
    .filter((set) => pieces.every(({uvSets}) => uvSets.some((other) => other.name === set)));
  const uvSets = sets.map((set) => ({name: set, uv: joinedNumbers(pieces.map(({uvSets: own}) => own.find((other) => other.name === set)!.uv))}));
  const own = Uint16Array.from(pieces.flatMap((piece, i) => new Array<number>(piece.faces.length / 3).fill(looks[i]!)));
  return {name, positions: joinedNumbers(pieces.map((piece) => piece.positions)), faces, uvSets, places, looks: own};
}

/** Files that the document names and that were not opened with it. */
function missingFiles(document: Document, names: Set<string>): string[] {
  const buffers = (document['buffers'] ?? []) as {uri?: string}[];
  const uris = buffers.map(({uri}) => uri).filter((uri) => uri !== undefined && !uri.startsWith('data:')) as string[];
  return uris.map((uri) => lastOf(decodeURIComponent(uri))).filter((name) => !names.has(name));
}

export async function readGltf(bytes: ArrayBuffer, others: Named[]): Promise<Model> {
  const whole = documentOf(bytes);
  const document = geometryOnly(whole);
  const urls = new Map(others.map(({name, blob}) => [lastOf(name), URL.createObjectURL(blob)]));
  const absent = missingFiles(document, new Set(urls.keys()));
  if (absent.length > 0) throw new UnreadableError(`This glTF needs ${list(absent)}. Open it together with its parts.`);
  const manager = new LoadingManager();
  manager.setURLModifier((url) => (/^(data|blob):/.test(url) ? url : urls.get(lastOf(decodeURIComponent(url))) ?? url));
  const loader = new GLTFLoader(manager);
  await addDecoders(loader, document);
  try {
    const {parser} = await loader.parseAsync(withDocument(bytes, document) as ArrayBuffer, '');
    const places = placesOf(document);
    const parts = meshesWithTriangles(document).map(async (m) => {
      const primitives = document.meshes![m]!.primitives.filter(({mode = 4}) => mode >= 4).map(({mode: _, ...rest}) => rest);
      const object = await parser.getDependency('mesh', m);
      const meshes: Mesh[] = [];
      object.traverse((child: Mesh) => child.isMesh && meshes.push(child));
      const {name = '', primitives: all} = whole.meshes![m]!;
      const none = ((whole['materials'] ?? []) as object[]).length;
      const looks = all.filter(({mode = 4}) => mode >= 4).map(({material = none}) => material as number);
      return partOf(meshes.slice(0, primitives.length).map(({geometry}) => geometry), looks, name, places[m]!);
    });
    const view = (index: number) => parser.getDependency('bufferView', index) as Promise<ArrayBuffer>;
    const looks = whole['materials'] ? {looks: await looksOf(whole, {view, urlOf: (uri) => urls.get(lastOf(decodeURIComponent(uri)))})} : {};
    return {parts: await Promise.all(parts), ...looks};
  } finally {
    for (const url of urls.values()) URL.revokeObjectURL(url);
  }
}
