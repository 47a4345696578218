// What colours show, for every corner of a surface.
import type {Mapped} from '../mesh/islands.js';
import {type Stretches, stretches} from '../mesh/distortion.js';
import {folds} from '../mesh/folds.js';
import type {Surface} from '../mesh/surface.js';
import type {Skin} from './skin.js';
import {AREA_SCALE, type Rgb, type Scale, WORSE_SCALE, chartColour, rgb} from './colours.js';

export type Colouring = 'plain' | 'checker' | 'image' | 'materials' | 'stretch' | 'angle' | 'area' | 'charts';

/** A surface with what one set of texture coordinates makes of it. */
export interface Shown {
  surface: Surface;
  /** Absent for a mesh without texture coordinates. */
  map?: Mapped | undefined;
  figures?: Stretches | undefined;
  /** Faces that overlap others of their island. */
  overlapping?: Uint32Array | undefined;
  /** Its materials, which take a while to load; undefined where there are none. */
  skin?: (() => Promise<Skin | undefined>) | undefined;
  /** The most distorted island of several. */
  worst?: number | undefined;
  /** Width / height of the texture. */
  aspect: number;
  /** Pages side by side along U. */
  pages: number;
}

/** isTurned: faces of the file that are wound against others were turned before they were mapped. */
export function shown(surface: Surface, map: Mapped | undefined, aspect = 1, pages = 1, isTurned = false): Shown {
  const figures = map && stretches(surface.positions, map.uv, aspect);
  if (isTurned) figures!.flipped = folds(surface, map!, figures!);
  return {surface, map, figures, aspect, pages};
}

export const SCALES: Partial<Record<Colouring, Scale>> = {stretch: WORSE_SCALE, angle: WORSE_SCALE, area: AREA_SCALE};
const PLAIN = rgb('c9c7d0');
const WHITE: Rgb = [1, 1, 1];
const FLIPPED = rgb('e0245e');

function valueOf(colouring: Colouring, {large, small}: Stretches, f: number): number {
  const [s, t] = [large[f]!, small[f]!];
  if (colouring === 'stretch') return Math.max(s, 1 / t);
  return colouring === 'angle' ? s / t : s * t;
}

function colourOf(colouring: Colouring, {map, figures}: Shown): (f: number) => Rgb {
  if (colouring === 'checker' || colouring === 'image') return map ? () => WHITE : () => PLAIN;
  if (!map || !figures || colouring === 'plain' || colouring === 'materials') return () => PLAIN;
  if (colouring === 'charts') {
    const colours = Array.from({length: map.islandCount}, (_, i) => chartColour(i));
    return (f) => colours[map.island[f]!]!;
  }
  const scale = SCALES[colouring]!;
  return (f) => (figures.flipped[f] ? FLIPPED : scale.of(valueOf(colouring, figures, f)));
}

/** Red, green and blue of each corner. */
export function paint(colouring: Colouring, what: Shown): Float32Array {
  const colours = new Float32Array(what.surface.faces * 9);
  const of = colourOf(colouring, what);
  for (let f = 0; f < what.surface.faces; f += 1) {
    const colour = of(f);
    for (let i = 0; i < 9; i += 1) colours[9 * f + i] = colour[i % 3]!;
  }
  return colours;
}
