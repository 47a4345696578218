// How many seams come back along edges that are kept: node kept.mjs UNWRAP [--FLAG VALUE...] MESH.obj...
// Each mesh is unwrapped; the seams beyond the median of x are kept (once), then those of that result
// there, too (twice). Whether an edge is a seam is told from the result's file.
import {execFileSync} from 'node:child_process';
import {mkdtempSync, readFileSync, rmSync, writeFileSync} from 'node:fs';
import {tmpdir} from 'node:os';
import {basename, join} from 'node:path';

const [unwrap, ...words] = process.argv.slice(2);
const meshes = words.filter((word) => word.endsWith('.obj'));
const flags = words.filter((word) => !word.endsWith('.obj'));
const scratch = mkdtempSync(join(tmpdir(), 'unwrapd-kept-'));

/** The report, the positions, and the edges whose faces have different texture coordinates: [v, w], v < w. */
function unwrapped(mesh, kept) {
  const [out, report, edges] = ['out.obj', 'report.json', 'edges.json'].map((name) => join(scratch, name));
  writeFileSync(edges, JSON.stringify(kept.map((vertices) => ({vertices}))));
  const keep = kept.length > 0 ? ['--keep-edges', edges] : [];
  execFileSync(unwrap, [mesh, '--local', '-o', out, '--report', report, ...flags, ...keep], {stdio: 'ignore'});
  const x = [], sides = new Map(), seams = [];
  for (const line of readFileSync(out, 'utf8').split('\n')) {
    const [kind, ...rest] = line.split(/\s+/);
    if (kind === 'v') x.push(Number(rest[0]));
    if (kind !== 'f') continue;
    const corners = rest.filter(Boolean).map((corner) => corner.split('/').map(Number));
    corners.forEach(([v, u], k) => {
      const [w, t] = corners[(k + 1) % corners.length];
      const key = v < w ? `${v} ${w}` : `${w} ${v}`, own = v < w ? `${u} ${t}` : `${t} ${u}`;
      if (sides.has(key) && sides.get(key) !== own) seams.push(key.split(' ').map((one) => one - 1));
      sides.set(key, own);
    });
  }
  return {report: JSON.parse(readFileSync(report, 'utf8')), x, seams};
}

const cell = (text) => String(text).padStart(10);

try {
  console.log(`${'mesh'.padEnd(26)}${['kept', 'cut', 'charts', 'seam'].map(cell).join('')}`);
  for (const mesh of meshes) {
    let kept = [];
    for (let round = 0; round < 3; round += 1) {
      const {report, x, seams} = unwrapped(mesh, kept);
      const named = new Set(seams.map(String));
      const cut = kept.filter((edge) => named.has(String(edge))).length;
      const row = [kept.length, cut, report.charts.length, report.seam_ratio.toFixed(2)];
      console.log(`${basename(mesh, '.obj').padEnd(26)}${row.map(cell).join('')}`);
      const median = x.toSorted((a, b) => a - b)[x.length >> 1];
      const all = new Map([...kept, ...seams.filter(([v, w]) => (x[v] + x[w]) / 2 > median)].map((edge) => [String(edge), edge]));
      kept = [...all.values()];
    }
  }
} finally {
  rmSync(scratch, {recursive: true});
}
