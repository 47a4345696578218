// Texture coordinates for geometries of three.js.
import {BufferAttribute, BufferGeometry, type InterleavedBufferAttribute} from 'three';

import type {Call} from './job.js';
import {unwrapTriangles} from './triangles.js';
import type {Options, Report} from './types.js';

type Attribute = BufferAttribute | InterleavedBufferAttribute;

/** The vertices of an attribute, picked and repeated. */
function picked(attribute: Attribute, sources: Uint32Array): BufferAttribute {
  const {itemSize, normalized} = attribute;
  const Numbers = attribute.array.constructor as new (length: number) => BufferAttribute['array'];
  const to = new BufferAttribute(new Numbers(sources.length * itemSize), itemSize, normalized);
  sources.forEach((source, vertex) => {
    for (let c = 0; c < itemSize; c += 1) to.setComponent(vertex, c, attribute.getComponent(source, c));
  });
  return to;
}

function trianglesOf(geometry: BufferGeometry) {
  const position = geometry.getAttribute('position');
  const positions = new Float32Array(position.count * 3);
  for (let i = 0; i < positions.length; i += 1) positions[i] = position.getComponent(Math.floor(i / 3), i % 3);
  const indices = geometry.index
    ? Uint32Array.from(geometry.index.array)
    : Uint32Array.from({length: position.count}, (_, i) => i);
  return {positions, indices};
}

/**
 * A copy of the geometry with the attribute `uv`. Vertices are duplicated along seams, with all of
 * their attributes; the order of triangles stays, so that groups do. V points up, as three.js has it
 * for textures with `flipY`.
 */
export async function unwrapGeometry(geometry: BufferGeometry, options: Options = {}, settings: Call = {}):
    Promise<{geometry: BufferGeometry; report: Report}> {
  const {meshes, report} = await unwrapTriangles([trianglesOf(geometry)], options, settings);
  const {uv, indices, sources} = meshes[0]!;
  const copy = new BufferGeometry();
  copy.name = geometry.name;
  copy.userData = structuredClone(geometry.userData);
  for (const [name, attribute] of Object.entries(geometry.attributes)) copy.setAttribute(name, picked(attribute, sources));
  for (const [name, targets] of Object.entries(geometry.morphAttributes))
    copy.morphAttributes[name as 'position'] = targets!.map((target) => picked(target, sources));
  copy.morphTargetsRelative = geometry.morphTargetsRelative;
  for (const {start, count, materialIndex} of geometry.groups) copy.addGroup(start, count, materialIndex);
  copy.setAttribute('uv', new BufferAttribute(uv, 2));
  copy.setIndex(new BufferAttribute(indices, 1));
  return {geometry: copy, report};
}
