// The charts of a layout as a list: the worst first, each a button that shows it in both views.
import {$, el} from '../base/dom.js';
import {count, fixed} from '../base/words.js';
import {deviations} from '../mesh/distortion.js';
import type {Shown} from '../view/paint.js';

const MOST = 100;

export interface Chart {
  island: number;
  faces: number;
  angle: number;
  area: number;
  flipped: number;
}

/** Charts, the most distorted first. */
export function chartsOf({map, figures}: Shown): Chart[] {
  if (!map || !figures) return [];
  const charts = deviations(figures, map.island, map.islandCount).map((figure, island) => ({island, faces: 0, flipped: 0, ...figure}));
  map.island.forEach((which, f) => {
    charts[which]!.faces += 1;
    charts[which]!.flipped += figures.flipped[f]!;
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
