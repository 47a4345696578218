// A surface in its materials: runs of faces that look alike, and where their images lie on them.
import {DoubleSide, type Material, MeshBasicMaterial, MeshLambertMaterial, type Texture, type Wrapping, ClampToEdgeWrapping, MirroredRepeatWrapping, RepeatWrapping} from 'three';

import type {Look, Model, Part} from '../mesh/model.js';
import {imageTexture} from './textures.js';

export interface Skin {
  /** u, v of each corner in the image of its face. */
  uv: Float32Array;
  runs: {start: number; count: number; look: number}[];
  looks: Look[];
  textures: (Texture | undefined)[];
}

const WRAPS: Record<number, Wrapping> = {10497: RepeatWrapping, 33071: ClampToEdgeWrapping, 33648: MirroredRepeatWrapping};

function addPart({faces, uvSets, looks: own}: Part, looks: Look[], {uv, runs}: Skin, at: number): void {
  for (let f = 0; f < faces.length / 3; f += 1) {
    const number = own![f]!;
    const last = runs.at(-1);
    if (last?.look === number) last.count += 1;
    else runs.push({start: at + f, count: 1, look: number});
    const {set, transform: [a, b, c, d, e, g]} = looks[number]! as Look & {transform: [number, number, number, number, number, number]};
    const from = uvSets.find(({name}) => name === set)?.uv;
    for (let k = 6 * f; from && k < 6 * f + 6; k += 2) {
      uv[6 * at + k] = a * from[k]! + b * from[k + 1]! + c;
      uv[6 * at + k + 1] = d * from[k]! + e * from[k + 1]! + g;
    }
  }
}

/** Undefined for a model without materials. */
export async function skinOf({parts, looks}: Model): Promise<Skin | undefined> {
  if (!looks || parts.some(({looks: own}) => !own)) return undefined;
  const faces = parts.reduce((sum, part) => sum + (part.faces.length / 3) * part.places.length, 0);
  const textures = await Promise.all(looks.map(async ({image, wrap}) => {
    const texture = image && await imageTexture(image).catch(() => undefined); // a broken image shows its factor
    return texture && Object.assign(texture, {wrapS: WRAPS[wrap[0]], wrapT: WRAPS[wrap[1]]});
  }));
  const skin: Skin = {uv: new Float32Array(faces * 6), runs: [], looks, textures};
  let at = 0;
  for (const part of parts)
    for (const _ of part.places) {
      addPart(part, looks, skin, at);
      at += part.faces.length / 3;
    }
  return skin;
}

/** Materials of a view, lit or flat, one for each look. Textures belong to the view. */
export function materialsOf({looks, textures}: Skin, isLit: boolean): (Material & {map: Texture | null})[] {
  return looks.map(({factor}, i) => {
    const common = {side: DoubleSide, map: textures[i]?.clone() ?? null};
    const material = isLit ? new MeshLambertMaterial({...common, polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1}) : new MeshBasicMaterial(common);
    material.color.setRGB(...factor);
    return material;
  });
}
