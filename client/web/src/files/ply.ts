// PLY, by the loader of three.
import {PLYLoader} from 'three/examples/jsm/loaders/PLYLoader.js';

import {IDENTITY, type Model, uvOfCorners} from '../mesh/model.js';

export function readPly(buffer: ArrayBuffer): Model {
  const geometry = new PLYLoader().parse(buffer);
  const positions = Float32Array.from(geometry.getAttribute('position').array);
  const faces = Uint32Array.from(geometry.index?.array ?? []);
  const uv = geometry.getAttribute('uv');
  const uvSets = uv && faces.length > 0 ? [{name: 'uv', uv: uvOfCorners(uv.array, faces)}] : [];
  return {parts: [{name: '', positions, faces, uvSets, places: [IDENTITY]}]};
}
