// The charts of a layout as a list: the worst first, each a button that shows it in both views.
import {$, el} from '../base/dom.js';
import {count, fixed} from '../base/words.js';
import {deviation} from '../mesh/distortion.js';
import type {Shown} from '../view/paint.js';

const MOST = 100;

export interface Chart {
  island: number;
  faces: number;
  angle: number;
  area: number;
  flipped: number;
}

function facesOf({map}: Shown): number[][] {
  const faces: number[][] = Array.from({length: map!.islandCount}, () => []);
  map!.island.forEach((island, f) => faces[island]!.push(f));
  return faces;
}

/** Charts, the most distorted first. */
export function chartsOf(what: Shown): Chart[] {
  if (!what.map || !what.figures) return [];
  const {large, small, area, flipped} = what.figures;
  const charts = facesOf(what).map((faces, island) => {
    const of = <T extends Float32Array | Uint8Array>(values: T) => values.constructor as unknown as {from(list: number[]): T};
    const picked = <T extends Float32Array | Uint8Array>(values: T): T => of(values).from(faces.map((f) => values[f]!));
    const own = {large: picked(large), small: picked(small), area: picked(area), flipped: picked(flipped)};
    return {island, faces: faces.length, ...deviation(own, () => true), flipped: own.flipped.reduce((sum, f) => sum + f, 0)};
  });
  return charts.sort((a, b) => b.angle + b.area - a.angle - a.area);
}

export function describe({faces, angle, area, flipped}: Chart): string {
  const flips = flipped > 0 ? `, ${count(flipped, 'flipped triangle')}` : '';
  return `${count(faces, 'triangle')}, angles ${fixed(angle, 3)}, areas ${fixed(area, 3)}${flips}`;
}

/** onShow: an island is to be shown. */
export function listCharts(charts: Chart[], onShow: (chart: Chart) => void): void {
  const items = charts.slice(0, MOST).map((chart, place) => {
    const button = el('button', {type: 'button'}, `Chart ${chart.island + 1}`);
    button.addEventListener('click', () => onShow(chart));
    return el('li', {}, button, ` ${describe(chart)}${place === 0 && charts.length > 1 ? ' (the worst)' : ''}`);
  });
  if (charts.length > MOST) items.push(el('li', {}, `… and ${count(charts.length - MOST, 'chart')} with less distortion.`));
  $('charts').replaceChildren(...items);
}
