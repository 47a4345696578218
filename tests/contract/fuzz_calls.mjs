// Every call of the contract with parameters and header fields made from it, valid and not: whatever
// is sent, the answer is one that the contract has, and a server's mistake is none of them.
import fc from 'fast-check';

import {request} from './http.mjs';
import * as meshes from './meshes.mjs';
import {pathTo} from './run.mjs';

const kSeed = 20260131;
const kRuns = 400;
const kMistake = 500;

const junk = fc.oneof(
  fc.string({maxLength: 20}), fc.integer().map(String), fc.double().map(String),
  fc.constantFrom('', '0', '-1', 'null', '1e400', '%', '%00', '../..', '{}', '[]', 'ä', '\u0000'));

/** The text of a value that a parameter's schema allows. */
function valid(schema) {
  if (schema.const !== undefined) return fc.constant(String(schema.const));
  if (schema.enum) return fc.constantFrom(...schema.enum.map(String));
  if ([schema.type].flat().includes('integer')) {
    return fc.integer({min: schema.minimum ?? 0, max: Math.min(schema.maximum ?? 4096, 4096)}).map(String);
  }
  return junk;
}

const kFields = {
  Accept: fc.constantFrom('*/*', 'model/*;q=0.5', 'text/html', ',;q=', 'model/obj'),
  Range: fc.constantFrom('bytes=0-3', 'bytes=-5', 'bytes=9999999999-', 'bytes=5-2', 'bytes=0-0,2-3', 'lines=1'),
  'If-None-Match': fc.constantFrom('*', '"x"', 'W/"x"', ',', '"'),
  'If-Range': fc.constantFrom('"x"', 'Sat, 21 Nov 2026 00:00:00 GMT', ''),
  'Last-Event-ID': fc.constantFrom('0', '1000000002', '-1', '99999999999999999999', 'x', ''),
  Prefer: fc.constantFrom('wait=1', 'wait=-1', 'wait', 'wait=99999999999', 'respond-async, wait=0', '=;,'),
  'Content-Type': fc.constantFrom('model/obj', 'application/json', 'multipart/form-data; boundary="', ''),
  'Idempotency-Key': fc.constantFrom('a', '"a"', '', 'x'.repeat(300)),
  Origin: fc.constantFrom('https://example.org', 'null', ''),
  traceparent: fc.constantFrom('00-0af7651916cd43dd8448eb211c80319c-b7ad6b7169203331-01', '00-0-0-0', 'x'),
  Priority: fc.constantFrom('u=0', 'u=9', 'u', 'i, u=-1'),
};

/** The query parameters of an operation: {name: schema}. */
function parametersOf(contract, operation) {
  const {parameters = []} = contract.locate(operation.pointer).value;
  const found = parameters
    .map((_, i) => contract.locate(`${operation.pointer}/parameters/${i}`))
    .filter(({value}) => value.in === 'query');
  return Object.fromEntries(found.map(({pointer, value}) =>
    [value.name, contract.locate(`${pointer}/schema`).value ?? {}]));
}

function someCall(contract, operation, job) {
  const known = Object.entries(parametersOf(contract, operation))
    .map(([name, schema]) => fc.tuple(fc.constant(name), fc.oneof(valid(schema), junk)));
  const stranger = fc.tuple(fc.string({maxLength: 8}), junk);
  const query = fc.array(known.length ? fc.oneof(...known, stranger) : stranger, {maxLength: 3});
  const headers = fc.record(kFields, {requiredKeys: []});
  const hasBody = ['POST', 'PUT'].includes(operation.method);
  return fc.record({query, headers, body: fc.constant(hasBody ? meshes.obj(1) : undefined)})
    .map((call) => ({...call, operation, path: pathTo(operation.path, job)}));
}

/** After a job has been done and one is removed again and again. */
export async function calls(run, base) {
  const {contract} = run;
  const headers = {'Content-Type': 'model/obj', Prefer: 'wait=30'};
  const {id} = await run.json(base, 'createJob', {headers, body: meshes.obj(), status: 200});
  const gone = `j_${'f'.repeat(32)}`;
  const some = contract.operations().map((operation) =>
    someCall(contract, operation, operation.method === 'DELETE' ? gone : id));
  const property = fc.asyncProperty(fc.oneof(...some), async ({operation, query, path, ...rest}) => {
    const search = query.length ? `?${new URLSearchParams(query)}` : '';
    const answer = await request(base, {method: operation.method, path: path + search, ...rest});
    const problems = contract.judge(operation.id, answer);
    if (answer.status === kMistake) problems.push(`a mistake: ${answer.body}`);
    if (problems.length > 0) throw new Error(problems.join('; '));
    run.passed += 1;
  });
  const result = await fc.check(property, {seed: kSeed, numRuns: kRuns});
  run.expect('fuzz: calls', result.failed
    ? [JSON.stringify(result.counterexample)?.slice(0, 600), String(result.errorInstance)] : []);
}
