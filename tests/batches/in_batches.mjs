// Runs what ctest lists, many GoogleTest cases in a process: a process takes longer to start and to end
// than most cases take to run.
//
//   node tests/batches/in_batches.mjs BUILD_FOLDER JOBS [--except FILE] [CTEST ARGUMENTS...]
//
// FILE has a regular expression a line: tests whose names begin with one are left out. (ctest's own
// expressions may have ten groups.) Tests with a COST begin first, the dearest before the others. What
// fails is told as it fails, with its output. Cases that a crash kept from running run in a process of
// their own. The slowest tests are told at the end. The last line counts: "N passed, N failed, N
// skipped". Exits with 1 where a test failed, and with 2 where there was none.
import { execFileSync, spawn } from 'node:child_process';
import { mkdtempSync, readFileSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';

const kCasesOfABatch = 12;
const kSecondsOfAProcess = 600;  // where a test has no TIMEOUT
const kMsUntilClosed = 5000;     // after which what a process has left behind may keep its output
const kSkippedExit = 77;
const kSlowestTold = 12;

const [folder, jobs, ...others] = process.argv.slice(2);
const [leftOut, ctestArguments] =
  others[0] === '--except' ? [expressionsIn(others[1]), others.slice(2)] : [[], others];
const scratch = mkdtempSync(join(tmpdir(), 'batches-'));
const counts = { passed: 0, failed: 0, skipped: 0 };
let leftOutCount = 0;
const failed = [];
const seconds = [];  // [seconds, name] of each

function expressionsIn(file) {
  return readFileSync(file, 'utf8').split('\n').filter((line) => line && !line.startsWith('#'))
    .map((line) => new RegExp(`^(?:${line})`));
}

/** What ctest would run: each with its command, and the name of its case where it is one case. */
function listedTests() {
  const listed = execFileSync(
    'ctest', ['--test-dir', folder, '--show-only=json-v1', ...ctestArguments],
    { encoding: 'utf8', maxBuffer: 1 << 28 });
  const all = JSON.parse(listed).tests;
  const kept = all.filter(({ name }) => !leftOut.some((expression) => expression.test(name)));
  leftOutCount = all.length - kept.length;
  return kept.map(({ name, command, properties }) => {
    const [program, ...rest] = command ?? [];
    const filter = rest.find((argument) => argument.startsWith('--gtest_filter='));
    const isOneCase = filter && !/[*?:]|=-/.test(filter);
    const property = (wanted) => properties.find((one) => one.name === wanted)?.value;
    return {
      name,
      command: command ?? [],
      cwd: property('WORKING_DIRECTORY') ?? folder,
      env: { ...process.env, ...Object.fromEntries((property('ENVIRONMENT') ?? []).map(
        (line) => [line.slice(0, line.indexOf('=')), line.slice(line.indexOf('=') + 1)])) },
      timeout: property('TIMEOUT') ?? kSecondsOfAProcess,
      cost: property('COST') ?? 0,
      program,
      testCase: isOneCase ? filter.slice('--gtest_filter='.length) : undefined,
    };
  });
}

/** Neighbours in ctest's list, of one program each. */
function batchesOf(tests) {
  const batches = [];
  for (const test of tests) {
    const last = batches.at(-1);
    const fits = last && test.testCase && last[0].testCase && last[0].program === test.program;
    if (fits && last.length < kCasesOfABatch) last.push(test);
    else batches.push([test]);
  }
  return batches;
}

function run(command, { cwd, env, timeout }) {
  return new Promise((resolve) => {
    let output = '';
    const child = spawn(command[0], command.slice(1),
      { cwd, env, stdio: ['ignore', 'pipe', 'pipe'] });
    const timer = setTimeout(() => {
      output += `\nkilled: it ran longer than ${timeout} s\n`;
      child.kill('SIGKILL');
    }, timeout * 1000);
    const end = (status) => {
      clearTimeout(timer);
      resolve({ status, output });
    };
    for (const stream of [child.stdout, child.stderr])
      stream.setEncoding('utf8').on('data', (text) => { output += text; });
    child.on('error', (error) => {
      output += `${error.message}\n`;
      end(-1);
    });
    child.on('exit', () => setTimeout(() => {
      child.stdout.destroy();
      child.stderr.destroy();
    }, kMsUntilClosed).unref());
    child.on('close', end);
  });
}

/** A line for each tenth of all tests. */
function tellShare() {
  const ended = counts.passed + counts.failed + counts.skipped;
  const tenths = Math.floor((10 * ended) / tests.length);
  if (tenths === Math.floor((10 * (ended - 1)) / tests.length)) return;
  const failures = counts.failed ? `, ${counts.failed} failed` : '';
  console.log(`${10 * tenths} %: ${ended} of ${tests.length} tests${failures}`);
}

function end(test, outcome, output = '') {
  counts[outcome] += 1;
  tellShare();
  if (outcome !== 'failed') return;
  failed.push(test.name);
  process.stdout.write(`${output}\n** FAILED: ${test.name}\n`);
}

async function runAlone(test) {
  if (test.command.length === 0) return end(test, 'failed', 'its program is not built');
  const begin = Date.now();
  const { status, output } = await run(test.command, test);
  seconds.push([(Date.now() - begin) / 1000, test.name]);
  if (status === kSkippedExit || (status === 0 && output.includes('[  SKIPPED ]')))
    end(test, 'skipped');
  else end(test, status === 0 ? 'passed' : 'failed', output);
}

/** What GoogleTest wrote of each case, {outcome, time}, by its name; nothing after a crash. */
function resultsIn(file) {
  try {
    const results = new Map();
    for (const suite of JSON.parse(readFileSync(file, 'utf8')).testsuites)
      for (const one of suite.testsuite)
        results.set(`${suite.name}.${one.name}`, {
          outcome: one.failures ? 'failed' : one.result === 'SKIPPED' ? 'skipped' : 'passed',
          time: parseFloat(one.time),
        });
    return results;
  } catch {
    return undefined;
  }
}

/** The cases whose end the output tells, as above: those before a crash. */
function endedIn(output) {
  const ended = new Map();
  const words = { '[       OK ]': 'passed', '[  FAILED  ]': 'failed', '[  SKIPPED ]': 'skipped' };
  for (const [, word, name] of output.matchAll(/^(\[.{10}\]) (\S+) \(\d+ ms\)$/gm))
    if (words[word]) ended.set(name, { outcome: words[word], time: 0 });
  return ended;
}

async function runBatch(batch, number) {
  if (batch.length === 1) return runAlone(batch[0]);
  const file = join(scratch, `${number}.json`);
  const filter = batch.map((test) => test.testCase).join(':');
  const command = [batch[0].program, `--gtest_filter=${filter}`, `--gtest_output=json:${file}`,
    '--gtest_also_run_disabled_tests'];
  const { status, output } = await run(command, batch[0]);
  const results = resultsIn(file);
  const known = results ?? endedIn(output);
  const blamed = [...known.values()].some(({ outcome }) => outcome === 'failed');
  if (status !== 0 && !blamed) process.stdout.write(`${output}\n`);  // a crash, or a leak at the end
  const isLeak = results && status !== 0 && !blamed;
  let told = output;  // once
  for (const test of batch) {
    const result = known.get(test.testCase);
    if (!result || isLeak) {
      await runAlone(test);
      continue;
    }
    seconds.push([result.time, test.name]);
    end(test, result.outcome, told);
    if (result.outcome === 'failed') told = '';
  }
  if (isLeak && !batch.some((test) => failed.includes(test.name)))
    end(batch[0], 'failed', `the process of these cases ended with ${status}: ${filter}`);
}

const tests = listedTests();
const batches = batchesOf(tests).sort(([a], [b]) => b.cost - a.cost);
let next = 0;
const worker = async () => {
  while (next < batches.length) {
    const number = next++;
    await runBatch(batches[number], number);
  }
};
await Promise.all(Array.from({ length: Number(jobs) }, worker));
rmSync(scratch, { recursive: true });
console.log(`${batches.length} processes for ${tests.length} tests`);
if (leftOutCount > 0) console.log(`${leftOutCount} tests are left out by ${others[1]}`);
for (const [time, name] of seconds.sort(([a], [b]) => b - a).slice(0, kSlowestTold))
  console.log(`${time.toFixed(1)} s: ${name}`);
for (const name of failed) console.log(`FAILED: ${name}`);
console.log(`${counts.passed} passed, ${counts.failed} failed, ${counts.skipped} skipped`);
process.exitCode = counts.failed > 0 ? 1 : tests.length === 0 ? 2 : 0;
