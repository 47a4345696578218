// Real cases, listed by a real ctest.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { mkdtempSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { dirname, join } from 'node:path';
import { test } from 'node:test';
import { fileURLToPath } from 'node:url';

const program = process.env.ENDS_OF_CASES;
const runner = join(dirname(fileURLToPath(import.meta.url)), 'in_batches.mjs');

/** Runs in batches what ctest finds in a folder with these cases of the program, and other tests. */
function run(cases, others = [], except = undefined) {
  const folder = mkdtempSync(join(tmpdir(), 'batches-test-'));
  const lines = cases.map((name) => `add_test(Ends.${name} ${program} --gtest_filter=Ends.${name})`);
  lines.push(...others);
  for (const name of cases)
    lines.push(`set_tests_properties(Ends.${name} PROPERTIES ENVIRONMENT "WORD=of the environment")`);
  writeFileSync(join(folder, 'CTestTestfile.cmake'), lines.join('\n'));
  const list = join(folder, 'except.txt');
  if (except) writeFileSync(list, except);
  const { status, stdout } = spawnSync('node',
    [runner, folder, '2', ...(except ? ['--except', list] : [])], { encoding: 'utf8', timeout: 60_000 });
  rmSync(folder, { recursive: true });
  const all = stdout.trimEnd().split('\n');
  return { status, stdout, last: all.at(-1),
    failed: all.filter((line) => line.startsWith('FAILED: ')).map((line) => line.slice(8)) };
}

test('cases that pass need one process', () => {
  const { status, stdout, last } = run(['Well', 'WellToo']);
  assert.equal(last, '2 passed, 0 failed, 0 skipped');
  assert.match(stdout, /^1 processes for 2 tests$/m);
  assert.equal(status, 0);
});

test('a case that fails is told with its output, and its neighbours count', () => {
  const { status, stdout, last, failed } = run(['Well', 'InFailure', 'Skipped']);
  assert.equal(last, '1 passed, 1 failed, 1 skipped');
  assert.deepEqual(failed, ['Ends.InFailure']);
  assert.match(stdout, /as it should/);
  assert.equal(status, 1);
});

test('a crash fails its own case alone', () => {
  const { last, failed } = run(['Well', 'InACrash', 'BehindACrash']);
  assert.equal(last, '2 passed, 1 failed, 0 skipped');
  assert.deepEqual(failed, ['Ends.InACrash']);
});

test('a process that ends badly fails, though its cases passed', () => {
  const { last, failed } = run(['Well', 'InAStatus']);
  assert.equal(last, '1 passed, 1 failed, 0 skipped');
  assert.deepEqual(failed, ['Ends.InAStatus']);
});

test('other tests run by themselves, and a program that is missing fails', () => {
  const { last, failed } = run(['Well'], [
    'add_test(fine "true")', 'add_test(bad "false")', 'add_test(absent "/nowhere/program")']);
  assert.equal(last, '2 passed, 2 failed, 0 skipped');
  assert.deepEqual([...failed].sort(), ['absent', 'bad']);  // in the order of their ends
});

test('what a list names is left out, by the beginning of a name', () => {
  const { last, failed, stdout } = run(['Well', 'WellToo', 'InFailure', 'Skipped'], [],
    '# a remark\nEnds\\.(In|Sk)\nWell\n');
  assert.equal(last, '2 passed, 0 failed, 0 skipped');
  assert.match(stdout, /^2 tests are left out by .*except[.]txt$/m);
  assert.deepEqual(failed, []);
});

test('a list that leaves nothing to run is a failure', () => {
  assert.equal(run(['Well'], [], 'Ends\n').status, 2);
});

test('no test at all is a failure', () => {
  assert.equal(run([]).status, 2);
});

test('a test that takes too long is killed, whatever it leaves behind', () => {
  const { last, failed, stdout } = run([], ['add_test(endless "sh" "-c" "sleep 120 & sleep 300")',
    'set_tests_properties(endless PROPERTIES TIMEOUT 1)']);
  assert.equal(last, '0 passed, 1 failed, 0 skipped');
  assert.deepEqual(failed, ['endless']);
  assert.match(stdout, /killed: it ran longer than 1 s/);
});

test('dear tests begin first, and every tenth is told', () => {
  const { stdout } = run([], ['add_test(cheap "sleep" "1")', 'add_test(other "sleep" "1")', 'add_test(dear "false")',
    'set_tests_properties(dear PROPERTIES COST 9)']);
  assert.deepEqual(stdout.match(/^\d+ %: .*|^\*\* FAILED: \w+/gm),
    ['30 %: 1 of 3 tests, 1 failed', '** FAILED: dear', '60 %: 2 of 3 tests, 1 failed', '100 %: 3 of 3 tests, 1 failed']);
});
