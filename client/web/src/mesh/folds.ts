// Which faces of a map are folded over where a file's faces are wound against their neighbours.
import type {Stretches} from './distortion.js';
import {type Mapped, meets} from './islands.js';
import type {Surface} from './surface.js';

/** Of each face: 1 if it is wound against the first face of its island. */
function against(surface: Surface, uv: Float32Array): Uint8Array {
  const [result, isSeen] = [new Uint8Array(surface.faces), new Uint8Array(surface.faces)];
  for (let first = 0; first < surface.faces; first += 1) {
    if (isSeen[first]) continue;
    isSeen[first] = 1;
    const open = [first];
    for (let f = open.pop(); f !== undefined; f = open.pop()) {
      for (let h = 3 * f; h < 3 * f + 3; h += 1) {
        const twin = surface.twins[h]!;
        const across = Math.floor(twin / 3);
        if (twin < 0 || isSeen[across] || !meets(surface, uv, h, twin)) continue;
        isSeen[across] = 1;
        result[across] = result[f]! ^ Number(surface.points[h] === surface.points[twin]);
        open.push(across);
      }
    }
  }
  return result;
}

/**
 * Of each face: 1 if it would be flipped beside most of its island, were all faces wound alike. An
 * island that is mirrored as a whole has none.
 */
export function folds(surface: Surface, {uv, island, islandCount}: Mapped, {area, flipped}: Stretches): Uint8Array {
  const turned = against(surface, uv);
  const isLike = flipped.map((isFlipped, f) => Number(isFlipped === turned[f]));
  const areaOfLike = new Float64Array(islandCount); // less that of the others
  island.forEach((which, f) => (areaOfLike[which] = areaOfLike[which]! + (isLike[f] ? 1 : -1) * area[f]!));
  return isLike.map((like, f) => Number(area[f]! > 0 && like !== Number(areaOfLike[island[f]!]! >= 0)));
}
