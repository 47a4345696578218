// A transform of glTF-Transform, in place of its unwrap().
import type {Accessor, Document, Primitive, Transform} from '@gltf-transform/core';

import type {Call} from './job.js';
import {type MappedTriangles, type Triangles, unwrapTriangles} from './triangles.js';
import type {Options} from './types.js';

export interface UnwrapdOptions extends Call {
  /** The set of texture coordinates to write. Default: 0. */
  texcoord?: number;
  /** Replaces texture coordinates that are there. Default: false; such primitives stay as they are. */
  overwrite?: boolean;
  /** What shares one page. Default: mesh. */
  groupBy?: 'primitive' | 'mesh' | 'scene';
  /** Options of the jobs. */
  options?: Omit<Options, 'texcoord' | 'materials' | 'primitives' | 'output' | 'compression' | 'draco_bits'>;
}

const TRIANGLES = 4; // the modes of a glTF's primitives
const TRIANGLE_STRIP = 5;
const TRIANGLE_FAN = 6;

/** The vertices of a primitive's triangles, whatever its mode. */
function indicesOf(primitive: Primitive): Uint32Array<ArrayBuffer> {
  const listed = primitive.getIndices();
  const count = listed?.getCount() ?? primitive.getAttribute('POSITION')!.getCount();
  const at = (i: number) => (listed ? listed.getScalar(i) : i);
  if (primitive.getMode() === TRIANGLES) return Uint32Array.from({length: count - (count % 3)}, (_, i) => at(i));
  const triangles: number[] = [];
  for (let i = 0; i + 2 < count; i += 1) {
    const isOdd = i % 2;
    if (primitive.getMode() === TRIANGLE_FAN) triangles.push(at(0), at(i + 1), at(i + 2));
    else triangles.push(at(i + isOdd), at(i + 1 - isOdd), at(i + 2));
  }
  return Uint32Array.from(triangles);
}

function trianglesOf(primitive: Primitive): Triangles {
  const position = primitive.getAttribute('POSITION')!;
  const positions = new Float32Array(position.getCount() * 3);
  for (let i = 0; i < position.getCount(); i += 1) positions.set(position.getElement(i, []), 3 * i);
  return {positions, indices: indicesOf(primitive)};
}

/** An accessor with the vertices of another, picked and repeated. */
function picked(from: Accessor, sources: Uint32Array): Accessor {
  const size = from.getElementSize();
  const values = from.getArray()!;
  const Numbers = values.constructor as new (length: number) => typeof values;
  const array = new Numbers(sources.length * size);
  sources.forEach((source, i) => array.set(values.subarray(source * size, (source + 1) * size), i * size));
  return from.clone().setArray(array);
}

/** Removes accessors that nothing uses any more. */
function release(accessors: (Accessor | null)[]): void {
  for (const accessor of new Set(accessors))
    if (accessor?.listParents().every(({propertyType}) => propertyType === 'Root')) accessor.dispose();
}

function apply(document: Document, primitive: Primitive, {uv, indices, sources}: MappedTriangles, semantic: string): void {
  const buffer = primitive.getAttribute('POSITION')!.getBuffer();
  const parts = [primitive, ...primitive.listTargets()];
  const replaced = [primitive.getIndices(), ...parts.flatMap((part) => part.listAttributes())];
  for (const part of parts)
    for (const name of part.listSemantics())
      if (part !== primitive || name !== semantic) part.setAttribute(name, picked(part.getAttribute(name)!, sources));
  const down = uv.map((value, i) => (i % 2 === 1 ? 1 - value : value)); // V of a glTF
  primitive
    .setMode(TRIANGLES)
    .setIndices(document.createAccessor().setType('SCALAR').setArray(indices).setBuffer(buffer))
    .setAttribute(semantic, document.createAccessor().setType('VEC2').setArray(down).setBuffer(buffer));
  release(replaced);
}

/** The primitives to unwrap, those that share a page together. */
function groupsOf(document: Document, {groupBy = 'mesh', overwrite = false}: UnwrapdOptions, semantic: string): Primitive[][] {
  const isOurs = (primitive: Primitive) =>
    [TRIANGLES, TRIANGLE_STRIP, TRIANGLE_FAN].includes(primitive.getMode()) && primitive.getAttribute('POSITION') &&
    (overwrite || !primitive.getAttribute(semantic)) && indicesOf(primitive).length > 0;
  const meshes = document.getRoot().listMeshes().map((mesh) => mesh.listPrimitives().filter(isOurs));
  const groups = {primitive: () => meshes.flat().map((one) => [one]), mesh: () => meshes, scene: () => [meshes.flat()]};
  return groups[groupBy]().filter((group) => group.length > 0);
}

/** Writes texture coordinates, computed by a server, into a document. */
export function unwrapd(settings: UnwrapdOptions = {}): Transform {
  return async function unwrapd(document: Document): Promise<void> {
    const semantic = `TEXCOORD_${settings.texcoord ?? 0}`;
    for (const group of groupsOf(document, settings, semantic)) {
      const {meshes} = await unwrapTriangles(group.map(trianglesOf), settings.options ?? {}, settings);
      group.forEach((primitive, i) => apply(document, primitive, meshes[i]!, semantic));
    }
  };
}
