// What a stranger gets: every mesh of some folders, sent by `unwrap` without an option. One row a
// file, then what was asked of all: no flip, no overlap, D within the bound as a mean and below 2.1 on
// every chart, and a note wherever one of these fails. Files that are refused are listed with their code.
//
//   node defaults.mjs BIN_FOLDER OUT.json FILE|FOLDER...
import {execFile} from 'node:child_process';
import {mkdtempSync, readdirSync, rmSync, statSync, writeFileSync} from 'node:fs';
import {tmpdir} from 'node:os';
import {basename, extname, join} from 'node:path';
import {promisify} from 'node:util';

import {startServer} from '../contract/server.mjs';

const kMeshes = new Set(['.glb', '.gltf', '.obj']);
const kSlack = 0.001;  // of D, as the note `distorted` allows
const kBearable = 2.1;  // D of one chart
const run = promisify(execFile);

const [bin, out, ...places] = process.argv.slice(2);

/** All meshes at a path, in the order of their names. */
function meshesAt(path) {
  if (!statSync(path).isDirectory()) return [path];
  return readdirSync(path).sort().map((name) => join(path, name)).flatMap(meshesAt)
      .filter((file) => kMeshes.has(extname(file).toLowerCase()));
}

const worst = ({distortion}) => Math.max(distortion.angle, distortion.area);

/** The row of a file: figures of its report, or the code of the refusal. */
async function rowOf(base, file, scratch) {
  const result = join(scratch, `result${extname(file)}`);
  const call = ['--server', base, '-o', result, '--json', file];
  try {
    const {stdout} = await run(join(bin, 'unwrap'), call, {maxBuffer: 1 << 28});
    return {file, ...figuresOf(JSON.parse(stdout))};
  } catch (error) {
    const told = `${error.stderr ?? error.message}`.trim().split('\n').at(-1);
    return {file, refused: told};
  } finally {
    rmSync(result, {force: true});
  }
}

function figuresOf(report) {
  const codes = [...new Set(report.notes.map(({code}) => code))];
  return {
    faces: report.input.faces,
    charts: report.charts.length,
    angle: report.distortion.angle,
    area: report.distortion.area,
    worst: Math.max(2, ...report.charts.map(worst)),
    bound: report.options.max_distortion,
    flipped: report.distortion.flipped,
    overlaps: report.overlaps,
    seams: report.seam_ratio,
    fill: report.fill,
    seconds: report.timings_ms.total / 1000,
    notes: codes,
  };
}

/** The goals that a row misses, and those that it misses without a note. */
function missedBy(row) {
  const missed = [];
  if (row.flipped > 0) missed.push({goal: 'flipped', told: false});
  if (row.overlaps !== 0) missed.push({goal: 'overlaps', told: row.notes.includes('overlaps')});
  const isBeyond = row.bound && Math.max(row.angle, row.area) > row.bound + kSlack;
  if (isBeyond || row.worst > Math.max(kBearable, row.bound ?? 0) + kSlack)
    missed.push({goal: 'bound', told: row.notes.includes('distorted')});
  return missed;
}

const cell = (value, width) => `${value}`.padStart(width);

function print(row) {
  const name = basename(row.file).slice(0, 34).padEnd(34);
  if (row.refused) return console.log(`${name} refused: ${row.refused}`);
  console.log(name + cell(row.faces, 8) + cell(row.charts, 7) + cell(row.angle.toFixed(4), 9) +
    cell(row.area.toFixed(4), 9) + cell(row.worst.toFixed(4), 9) + cell(row.flipped, 5) +
    cell(row.overlaps ?? '-', 7) + cell(row.seams.toFixed(2), 8) + cell(row.fill.toFixed(3), 7) +
    cell(row.seconds.toFixed(2), 8) + `  ${row.notes.join(' ')}`);
}

const scratch = mkdtempSync(join(tmpdir(), 'unwrapd-defaults-'));
const server = await startServer(join(bin, 'unwrapd'), ['--log-level=off', '--admin-listen=off']);
const rows = [];
try {
  console.log('file'.padEnd(34) + '   faces charts  D_angle   D_area  worst D flip   over   seams' +
    '   fill       s  notes');
  for (const file of places.flatMap(meshesAt)) {
    rows.push(await rowOf(server.base, file, scratch));
    print(rows.at(-1));
  }
} finally {
  await server.stop();
  rmSync(scratch, {recursive: true, force: true});
}
const answered = rows.filter(({refused}) => !refused);
const missed = answered.flatMap((row) => missedBy(row).map((miss) => ({file: row.file, ...miss})));
for (const goal of ['flipped', 'overlaps', 'bound']) {
  const all = missed.filter((miss) => miss.goal === goal);
  console.log(`${goal}: missed by ${all.length} of ${answered.length} files, ` +
    `${all.filter(({told}) => !told).length} without a note`);
}
writeFileSync(out, `${JSON.stringify({rows, missed}, null, 2)}\n`);
