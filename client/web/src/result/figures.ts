// What the report measures, in figures with their words, and what it notes.
import {$, el} from '../base/dom.js';
import {count, fixed, integer} from '../base/words.js';
import type {Report} from '../job/run.js';

const were = (n: number) => (n === 1 ? 'was' : 'were');

const REPAIRS: Record<string, (n: number) => string> = {
  degenerate_faces_set_aside: (n) => `${count(n, 'triangle')} without area got no area on the page.`,
  duplicate_faces_set_aside: (n) => `${count(n, 'triangle')} repeated another and ${n === 1 ? 'shares' : 'share'} its place.`,
  non_manifold_edges_split: (n) => `The surface was split at ${count(n, 'edge')} with three or more faces.`,
  cut_to_disk: (n) => `${count(n, 'piece')} had to be cut open to become flat.`,
  segmented: (n) => `${count(n, 'piece')} ${were(n)} cut open, or split into charts of less distortion.`,
  vertices_welded_near: (n) => `${count(n, 'vertex', 'vertices')} that rounding had moved apart ${were(n)} welded.`,
  faces_turned: (n) => `${count(n, 'triangle')} ${were(n)} wound against the others and turned for the map. The file stays as it is.`,
  line_ends_replaced: (n) => `${count(n, 'line')} ended in CR alone; the result has LF.`,
  empty_indices_ignored: (n) => `${count(n, 'corner')} with an empty index in the OBJ ${were(n)} ignored.`,
  normals_replaced: (n) => `${count(n, 'normal')} without a direction in the OBJ ${were(n)} replaced.`,
  chunks_padded: (n) => `${count(n, 'chunk')} of the GLB with a wrong length ${were(n)} padded.`,
  shared_nodes_kept: (n) => `${count(n, 'node')} with several parents ${were(n)} kept.`,
};

function overlapsIn({overlaps, guarantee}: Report): string {
  if (overlaps === null) return 'not counted';
  return overlaps === 0 ? `none${guarantee === 'bijective' ? ', guaranteed' : ''}` : integer(overlaps);
}

function figuresOf(report: Report): [string, string, string][] {
  const {charts, distortion, fill, seam_ratio: seams, texel_density: density, pages, timings_ms: timings} = report;
  return [
    ['Charts', integer(charts.length), 'pieces that lie flat on the page'],
    ['Angles', fixed(distortion.angle, 4), '2 is ideal'],
    ['Areas', fixed(distortion.area, 4), '2 is ideal'],
    ['Flipped triangles', integer(distortion.flipped), ''],
    ['Overlapping pairs', overlapsIn(report), ''],
    ['Seams', fixed(seams, 2), 'length / √area'],
    ['Page filled', `${(100 * fill).toFixed(1)} %`, pages > 1 ? count(pages, 'page') : ''],
    ['Texels per unit', fixed(density, 1), 'of length'],
    ['Time', `${(timings.total / 1000).toFixed(2)} s`, 'on the server'],
  ];
}

export function showFigures(report: Report): void {
  $('figures').replaceChildren(...figuresOf(report).map(([name, value, help]) =>
    el('div', {}, el('dt', {}, name), el('dd', {}, value, help ? el('small', {}, help) : ''))));
  const lines = [
    ...report.notes.map(({text, code}) => el('li', {}, text, ' ', el('code', {}, code))),
    ...repairsOf(report).map((text) => el('li', {}, text)),
  ];
  $('notes').replaceChildren(...(lines.length > 0 ? lines : [el('li', {}, 'Nothing to note: the file was used as it is.')]));
}

/** Repairs of all surfaces together, one sentence for each kind. */
function repairsOf({repairs}: Report): string[] {
  const sums = new Map<string, number>();
  for (const {kind, count: n} of repairs) sums.set(kind, (sums.get(kind) ?? 0) + n);
  return Array.from(sums, ([kind, n]) => REPAIRS[kind]?.(n) ?? `${kind}: ${integer(n)}`);
}
