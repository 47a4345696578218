// Every bench to its end, with inputs for half an hour in all, then one table of goals: what was asked,
// what was seen. A bench that fails or takes longer than its share is a goal missed.
//
//   node all.mjs DEV OUT_FOLDER DATA_FOLDER
import {spawn} from 'node:child_process';
import {existsSync, readFileSync, rmSync, writeFileSync} from 'node:fs';
import {join} from 'node:path';

const [dev, out, data] = process.argv.slice(2);
const file = (name) => join(data, name);

const goal = (name, relation, asked, seen) =>
  ({name, relation, asked, seen, met: relation === '>=' ? seen >= asked : seen <= asked});
const ofGoals = ({goals}) => goals.map((g) => goal(g.goal, g.relation, g.asked, g.measured));
const ofFigures = (figures) =>
  figures.filter(({limit}) => limit !== undefined).map((f) => goal(f.name, '<=', f.limit, f.value));
const ofDefaults = ({missed}) => ['flipped', 'overlaps', 'bound'].map((name) =>
  goal(`${name}, files without a note`, '<=', 0, missed.filter((m) => m.goal === name && !m.told).length));

/** Sums of columns of the table of atlases: triangles flipped, texels that overlap. */
function ofAtlases(printed) {
  const rows = printed.split('\n').map((line) => line.slice(23).trim().split(/\s+/).map(Number))
    .filter((row) => row.length >= 13 && row.slice(0, 13).every(Number.isFinite));
  const sum = (column) => rows.reduce((all, row) => all + row[column], 0);
  return [goal('flips', '<=', 0, sum(6)), goal('overlapping texels', '<=', 0, sum(7))];
}

/** "... 1.19 (asked: 1.1) ... 5 % of the job (asked: 15 ..." of `bench`. */
const ofRequest = (printed) => [
  ['whole request, times the core', /ratio ([\d.]+) \(asked: ([\d.]+)/],
  ['reading and writing, % of the job', /writing ([\d.]+) % of the job \(asked: ([\d.]+)/],
].flatMap(([name, pattern]) => {
  const [, seen, asked] = pattern.exec(printed) ?? [];
  return seen ? [goal(name, '<=', Number(asked), Number(seen))] : [];
});

/** "time: median 1.041 (asked: 1.15), worst 2.10 (asked: 3)" of `bench bijective`. */
const ofBijective = (printed) => [...printed.matchAll(/^(time|rise): median ([\d.]+)(?: %)? \(asked: ([\d.]+)\), worst ([\d.]+)(?: %)? \(asked: ([\d.]+)\)/gm)]
  .flatMap(([, what, median, askedMedian, worst, askedWorst]) => [
    goal(`${what} of bijective, median`, '<=', Number(askedMedian), Number(median)),
    goal(`${what} of bijective, worst`, '<=', Number(askedWorst), Number(worst)),
  ]);

/** "cancel, farm   median   20.1   99 %   52.3" of `bench farm`. */
const ofFarm = (printed) => [...printed.matchAll(/^(submit|watch|cancel), farm +median +[\d.]+ +99 % +([\d.]+)/gm)]
  .map(([, what, late]) => goal(`${what} at other nodes, ms, 99 %`, '<=', 100, Number(late)));

/** The last column of the table of `bench scene`: speed-up, of its bound. */
const ofScene = (printed) => [...printed.matchAll(/^([24]) +(?:[\d.]+ +){5}([\d.]+)$/gm)]
  .map(([, workers, share]) => goal(`a scene on ${workers} workers, of its bound`, '>=', .9, Number(share)));

/** "sqlite   ... 1210 claimed in turn/s" of `bench store`. */
const ofStore = (printed) => [...printed.matchAll(/^(\w+) .* (\d+) claimed in turn\/s$/gm)]
  .map(([, engine, claims]) => goal(`claims a second for 1,000 owners, ${engine}`, '>=', 300, Number(claims)));

const kept = (name) => JSON.parse(readFileSync(join(out, name), 'utf8'));
// [name, arguments, minutes, goals of what it printed and wrote]
const benches = [
  ['goals', [join(out, 'goals.json')], 4, (printed) => [...ofGoals(kept('goals.json')), ...ofRequest(printed)]],
  ['table1', ['table1'], 0.5],
  ['engine', ['engine', '1e5'], 1],
  ['methods', ['methods'], 3],
  ['atlas', ['atlas', '--fast', file('closed/spot_control_mesh.obj'), 'noisy:5000', 'made:torus:1000:1'], 1, ofAtlases],
  ['bijective', ['bijective', '--pairs=1', file('paper'), 'made:opened:1000:1', 'made:hill:9000:1'], 1, ofBijective],
  ['painted', ['painted', 'made:torus:1000:1'], 0.5],
  ['kept', ['kept', '--effort', 'fast', file('closed/spot_control_mesh.obj')], 0.5],
  ['cancel-latency', ['cancel-latency', 'noisy:5000', 'disk:100000', 'boxes:100'], 1],
  ['load', ['load', '20'], 9, () => ofFigures(Object.values(kept('load.json').figures).flat())],
  ['isolation', ['isolation', '10'], 1, () => ofFigures(kept('isolation.json').figures)],
  ['frames', ['frames'], 1, () => ofFigures(kept('frames.json').figures)],
  ['store', ['store', '1000'], 1, ofStore],
  ['cost', ['cost', '1', file('closed/spot_control_mesh.obj')], 0.5],
  ['farm', ['farm', '100'], 1.5, ofFarm],
  ['scene', ['scene', '200', '1'], 3, ofScene],
  ['defaults', ['defaults', file('closed/spot_control_mesh.obj'), file('closed/torus.obj')], 0.5,
   () => ofDefaults(kept('defaults.json'))],
  ['converge', ['converge', file('paper/Isis_dABF.obj')], 0.5],
];

/** Runs a bench; resolves to all that it printed and whether it ended well in its time. */
function run(words, minutes) {
  return new Promise((resolve) => {
    const bench = spawn(dev, ['bench', ...words], {stdio: ['ignore', 'pipe', 'inherit'], detached: true});
    const end = setTimeout(() => process.kill(-bench.pid), 60_000 * minutes);
    let printed = '';
    bench.stdout.on('data', (bytes) => {
      process.stdout.write(bytes);
      printed += bytes;
    });
    bench.on('close', (status) => {
      clearTimeout(end);
      resolve({printed, ended: status === 0});
    });
  });
}

const rows = [];
for (const [name, words, minutes, goalsOf = () => []] of benches) {
  console.log(`== ./dev bench ${words.join(' ')}`);
  if (existsSync(join(out, `${name}.json`))) rmSync(join(out, `${name}.json`));  // of an older run
  const begin = performance.now();
  const {printed, ended} = await run(words, minutes);
  const took = Math.round((performance.now() - begin) / 6000) / 10;
  const own = [{name: 'minutes to its end', relation: '<=', asked: minutes, seen: took, met: ended}];
  try {
    own.push(...goalsOf(printed));
  } catch (error) {
    own.push({name: `figures: ${error.message}`, relation: '', asked: '', seen: '', met: false});
  }
  rows.push(...own.map((row) => ({bench: name, ...row})));
}
console.log(`\n${'bench'.padEnd(16)}${'goal'.padEnd(70)}${'asked'.padStart(10)}${'seen'.padStart(10)}`);
for (const {bench, name, relation, asked, seen, met} of rows)
  console.log(bench.padEnd(16) + name.padEnd(70) + `${relation} ${asked}`.padStart(10) +
    `${Number(Number(seen).toPrecision(3))}`.padStart(10) + (met ? '  met' : '  missed'));
console.log(`${rows.filter(({met}) => met).length} goals met, ${rows.filter(({met}) => !met).length} missed`);
writeFileSync(join(out, 'all.json'), `${JSON.stringify(rows, null, 2)}\n`);
process.exitCode = rows.some(({name, met}) => !met && /^(minutes|figures)/.test(name)) ? 1 : 0;
