// The contract test: the real unwrapd against api/openapi.yaml, both ways. Every status that the
// document has must be shown by the server, and the server may show none that it does not have.
//
//   node contract.mjs [path of unwrapd, else UNWRAPD_BIN]
import {readFileSync} from 'node:fs';
import {basename} from 'node:path';
import {fileURLToPath} from 'node:url';

import * as cases from './cases.mjs';
import {kProvokedElsewhere, kShownElsewhere} from './codes.mjs';
import {fuzz} from './fuzz.mjs';
import {calls} from './fuzz_calls.mjs';
import * as limits from './limits.mjs';
import * as refusals from './refusals.mjs';
import {Run} from './run.mjs';
import {startServer} from './server.mjs';
import {Contract, parseEvents} from './spec.mjs';

function examples(run) {
  for (const {file, schema} of run.contract.examples()) {
    const text = readFileSync(file, 'utf8');
    const problems = file.endsWith('.json')
      ? run.contract.check(schema, JSON.parse(text))
      : parseEvents(text).flatMap((event) => run.contract.checkNamed('JobEvent', event));
    run.expect(`example ${file}`, problems);
  }
  const shown = new Set(run.contract.examples().map(({file}) => basename(file, '.json')));
  run.expect('every code has an example',
             run.contract.errorCodes().filter((code) => !shown.has(`problem_${code}`)));
}

/** Every code is provoked, here or by the test that is named. */
function codes(run) {
  const {codes: provoked} = run.contract;
  const known = run.contract.errorCodes();
  const elsewhere = Object.entries(kProvokedElsewhere);
  run.expect('every code was provoked or is named',
             known.filter((code) => !provoked.has(code) && !(code in kProvokedElsewhere)));
  run.expect('only codes are named', elsewhere.map(([code]) => code).filter((code) => !known.includes(code)));
  const asks = (code, file) => new RegExp(`['"]${code}['"]`).test(
      readFileSync(new URL(`../../${file}`, import.meta.url), 'utf8'));
  run.expect('the tests that are named ask for them',
             elsewhere.filter(([code, file]) => !asks(code, file)).map(([code]) => code));
}

/** Every documented status is shown, here or by the test that is named. */
function statuses(run) {
  const unseen = run.contract.unseen();
  const elsewhere = Object.entries(kShownElsewhere);
  run.expect('every documented status was shown or is named', unseen.filter((pair) => !(pair in kShownElsewhere)));
  run.expect('only what was not shown is named', elsewhere.map(([pair]) => pair).filter((pair) => !unseen.includes(pair)));
  const judges = (pair, file) => new RegExp(`judge\\(['"]${pair.split(' ')[0]}['"]`).test(
      readFileSync(new URL(`../../${file}`, import.meta.url), 'utf8'));
  run.expect('the tests that are named judge them',
             elsewhere.filter(([pair, file]) => !judges(pair, file)).map(([pair]) => pair));
}

/** Runs one group; an exception is one failure and does not stop the others. */
async function group(run, name, action) {
  const before = run.passed;
  try {
    await action();
  } catch (error) {
    run.expect(`${name} came to its end`, [error.stack]);
  }
  console.log(`${name}: ${run.passed - before} passed`);
}

async function main() {
  const binary = process.argv[2] ?? process.env.UNWRAPD_BIN;
  if (!binary) throw new Error('Name the unwrapd to test as the argument or in UNWRAPD_BIN.');
  const contract = new URL('../../api/openapi.yaml', import.meta.url);
  const run = new Run(new Contract(fileURLToPath(contract)));
  await group(run, 'examples', () => examples(run));
  const server = await startServer(binary);
  for (const [name, action] of Object.entries({...cases, calls, fuzz})) {
    await group(run, name, () => action(run, server.base));
  }
  run.expectEqual('exit code after SIGTERM', await server.stop(), 0);
  for (const [name, action] of Object.entries({...limits, ...refusals})) {
    await group(run, name, () => action(run, binary));
  }
  statuses(run);
  codes(run);
  console.log(`${run.passed} passed, ${run.failed} failed`);
  process.exitCode = run.failed === 0 ? 0 : 1;
}

await main();
