// Random requests, from a fixed seed. Whatever is sent, the answer is one that the contract has;
// and for options the schema is an oracle: what it allows is taken, what it does not is refused.
import fc from 'fast-check';

import {multipart, request} from './http.mjs';
import * as meshes from './meshes.mjs';
import {pathTo} from './run.mjs';

const kSeed = 20260131;
const kTiny = meshes.glb(1);
const kBusy = 429;  // allowed to any submission

async function check(run, name, property, numRuns) {
  const result = await fc.check(property, {seed: kSeed, numRuns, endOnFailure: false});
  const report = result.failed
    ? [`${JSON.stringify(result.counterexample)?.slice(0, 600)}`, String(result.errorInstance)]
    : [];
  run.expect(`fuzz: ${name}`, report);
}

/** Throws what the contract finds wrong with an answer, so that fast-check shrinks the request. */
function obey(run, id, answer) {
  const problems = run.contract.judge(id, answer);
  run.passed += problems.length === 0 ? 1 : 0;
  if (problems.length > 0) throw new Error(problems.join('; '));
  return answer;
}

const kLambda = fc.double({min: 0, max: 1e6, noNaN: true});

const kStop = fc.record({
  iterations: fc.option(fc.integer({min: 1, max: 30})),
  tolerance: fc.double({min: 1e-12, max: 0.1, noNaN: true}),
  max_iterations: fc.integer({min: 1, max: 60}),
}, {requiredKeys: []});

const kPoint = fc.double({min: -2, max: 2, noNaN: true});

const kConstraint = fc.tuple(
  fc.oneof(fc.record({vertex: fc.integer({min: 0, max: 5})}),
           fc.record({at: fc.array(kPoint, {minLength: 3, maxLength: 3})})),
  fc.record({uv: fc.array(kPoint, {minLength: 2, maxLength: 2}),
             weight: fc.option(fc.double({min: 1e-6, max: 1e6, noNaN: true})),
             mesh: fc.integer({min: 0, max: 1})}, {requiredKeys: ['uv']}))
  .map(([which, what]) => ({...which, ...what}));

const kLists = {materials: ['a'], primitives: ['/meshes/0/primitives/0'], seam_edges: [{vertices: [0, 1]}],
                keep_edges: [{vertices: [1, 0]}], locked_islands: [{face: 0}]};

const has = (schema, type) => [schema.type].flat().includes(type);

function validValue(name, schema) {
  if (schema.enum) return fc.constantFrom(...schema.enum);
  if (name === 'lambda') return fc.oneof(kLambda, fc.uniqueArray(kLambda, {minLength: 1, maxLength: 4}));
  if (name === 'stop') return kStop;
  if (name === 'constraints') return fc.array(kConstraint, {maxLength: 3});
  if (name in kLists) return fc.constantFrom([], kLists[name]);
  if (has(schema, 'boolean')) return fc.boolean();
  if (has(schema, 'string') && has(schema, 'null')) return fc.constantFrom('_PAINT', 'COLOR_0.r', null);
  const bounds = {min: schema.minimum, max: Math.min(schema.maximum, ['resolution', 'width', 'height'].includes(name) ? 4096 : 1e6)};
  const number = has(schema, 'integer') ? fc.integer(bounds) : fc.double({...bounds, noNaN: true});
  return has(schema, 'null') ? fc.option(number) : number;
}

const anyValue = fc.oneof(
  fc.string(), fc.integer(), fc.double(), fc.constantFrom('', 'auto', 'null', 'NaN', '1e9', '-1'),
  fc.boolean(), fc.constant(null), fc.array(fc.integer(), {maxLength: 2}));

/** A value on a bound of an option, or just beyond it. */
function boundaryOption(properties) {
  const bounded = Object.entries(properties).filter(([, schema]) => !schema.enum);
  const stops = [{iterations: 0}, {iterations: 1}, {iterations: 1.5}, {iterations: 10_001},
                 {max_iterations: 0}, {max_iterations: 10_001}, {tolerance: 0}, {tolerance: 0.2}];
  return fc.constantFrom(...stops.map((stop) => ({stop})),
    ...bounded.flatMap(([name, {minimum = 0, maximum = 1e6}]) =>
      [minimum - 1, minimum - 0.5, minimum, minimum + 0.5, maximum, maximum + 1]
        .map((value) => ({[name]: value}))));
}

function someOptions(properties) {
  const names = Object.keys(properties);
  const valid = fc.record(
    Object.fromEntries(names.map((name) => [name, validValue(name, properties[name])])),
    {requiredKeys: []});
  const anyName = fc.oneof(fc.constantFrom(...names), fc.string({minLength: 1}));
  const wild = fc.dictionary(anyName, anyValue, {maxKeys: 2, noNullPrototype: true});
  const bad = fc.oneof(wild, boundaryOption(properties));
  return fc.oneof(valid, fc.tuple(valid, bad).map((both) => Object.assign({}, ...both)));
}

/** What the schema cannot say: which options go together. */
function goTogether(options) {
  const {padding = 2, resolution = 1024, method = 'arap', boundary = 'free',
         constraints = [], repack_only = false, measure_only = false,
         texels_per_unit = null, max_pages = 1,
         stack_identical = false, max_distortion = null, guarantee = null,
         rotation = 'any', group = 'scene', width = null, height = null,
         straighten = 'off', preset = 'texture', textures = 'keep',
         seam_edges = [], keep_edges = [], locked_islands = []} = options;
  const free = boundary === 'free';
  const kept = repack_only || measure_only;
  const unpacked = !kept && texels_per_unit === null && max_pages === 1 &&
      !stack_identical && rotation === 'any' && group === 'scene';
  const placed = ['asap', 'arap', 'hybrid'].includes(method);  // where it is told to lie
  const held = placed && free && unpacked;
  const loose = constraints.length === 0;
  const bijective = ['texture', 'lightmap'].includes(preset) && loose && (free || !placed);
  const apart = guarantee === null ? bijective : guarantee === 'bijective';
  const isSized = [options.resolution, width, height].some((side) => (side ?? null) !== null);
  const found = texels_per_unit !== null && textures === 'keep' && !isSized;
  const shorter = found ? 16_384 : Math.min(width ?? resolution, height ?? resolution);
  const around = repack_only && texels_per_unit === null && !stack_identical && group === 'scene';
  return (seam_edges.length === 0 || keep_edges.length === 0) && (locked_islands.length === 0 || around) &&
      4 * padding <= shorter && (max_pages === 1 || group === 'scene') &&
      (straighten === 'off' || (loose && (free || !placed) && !kept)) &&
      (loose || held) && (free || !kept) && !(repack_only && measure_only) &&
      (guarantee !== 'bijective' || !kept) &&
      (max_distortion === null || (loose && (free || !placed))) &&
      (textures === 'keep' || (!measure_only && (repack_only || apart) && loose && max_pages === 1 && group === 'scene' &&
          !stack_identical));
}

function expectVerdict(answer, allowed) {
  if (answer.status === kBusy) return;
  const refused = answer.status === 422;
  if (refused === allowed) {
    throw new Error(`${allowed ? 'allowed' : 'forbidden'} by the schema, but ${answer.status}: ` +
                    answer.body.subarray(0, 200));
  }
}

async function jsonOptions(run, base) {
  const property = fc.asyncProperty(someOptions(run.contract.options()), async (options) => {
    const text = JSON.stringify(options);
    const sent = JSON.parse(text);  // without what JSON cannot say
    const {headers, body} = multipart([
      {name: 'options', type: 'application/json', body: text},
      {name: 'mesh', type: 'model/gltf-binary', body: kTiny}]);
    const answer = await request(base, {
      method: 'POST', path: '/v1/jobs', headers: {...headers, Prefer: 'wait=20'}, body});
    obey(run, 'createJob', answer);
    const allowed = run.contract.checkNamed('Options', sent).length === 0 && goTogether(sent);
    expectVerdict(answer, allowed);
  });
  await check(run, 'options as JSON', property, 250);
}

/** The value that the text of a query stands for, as the schema sees it. */
function queryValue(schema, text) {
  if (has(schema, 'boolean')) return {true: true, false: false}[text] ?? text;
  const isNumber = !has(schema, 'string') || has(schema, 'integer');
  const pattern = has(schema, 'integer') ? /^-?\d+$/ : /^-?(\d+\.?\d*|\.\d+)(e[+-]?\d+)?$/i;
  return isNumber && pattern.test(text) ? Number(text) : text;
}

/** Options as the pairs of a query: members of stop by their path, lists of numbers with commas. */
function queryPairs(options) {
  const isGroup = ([name, value]) =>
    name === 'stop' && value !== null && typeof value === 'object' && !Array.isArray(value);
  const isJson = (name, value) =>
    name === 'constraints' || (name in kLists && typeof value === 'object');
  const text = (name, value) => isJson(name, value) ? JSON.stringify(value) : String(value);
  return Object.entries(options).flatMap(([name, value]) => isGroup([name, value])
    ? Object.entries(value).filter(([, v]) => v !== null).map(([m, v]) => [`stop.${m}`, String(v)])
    : [[name, text(name, value)]]);
}

/** Names parted by commas, or as JSON. */
function namesOf(text) {
  if (text.startsWith('[')) return jsonOf(text);
  const names = text.split(',');
  return names.at(-1) === '' ? names.slice(0, -1) : names;
}

function jsonOf(text) {
  try {
    return JSON.parse(text);
  } catch {
    return text;
  }
}

/** The options that the pairs of a query stand for. */
function meantBy(pairs, options, {Stop, Lambda}) {
  const meant = {};
  for (const [name, text] of pairs) {
    const [group, member] = name.split('.');
    if (group === 'stop' && member in Stop.properties) {
      meant.stop = {...meant.stop, [member]: queryValue(Stop.properties[member], text)};
    } else if (name === 'lambda') {
      const numbers = text.split(',').map((part) => queryValue(Lambda, part));
      meant.lambda = numbers.length > 1 ? numbers : numbers[0];
    } else if (['materials', 'primitives'].includes(name)) {
      meant[name] = namesOf(text);
    } else if (['constraints', 'seam_edges', 'keep_edges', 'locked_islands'].includes(name)) {
      meant[name] = jsonOf(text);
    } else {
      meant[name] = queryValue(options[name] ?? {}, text);
    }
  }
  return meant;
}

async function queryOptions(run, base) {
  const {schemas} = run.contract.document.components;
  const all = run.contract.options();
  const property = fc.asyncProperty(someOptions(all), async (options) => {
    const pairs = queryPairs(options);
    const meant = meantBy(pairs, all, schemas);
    const answer = await request(base, {
      method: 'POST', path: `/v1/jobs?${new URLSearchParams(pairs)}`, body: kTiny,
      headers: {'Content-Type': 'model/gltf-binary', Prefer: 'wait=20'}});
    obey(run, 'createJob', answer);
    const known = run.contract.checkNamed('Options', meant).length === 0;
    expectVerdict(answer, known && goTogether(meant));
  });
  await check(run, 'options as a query', property, 250);
}

/** A good asset with some bytes changed, cut or put in. */
const brokenAsset = fc.tuple(
  fc.constantFrom(meshes.glb(2), meshes.obj(2), meshes.gltf().text),
  fc.array(fc.tuple(fc.nat(), fc.integer({min: 0, max: 255})), {maxLength: 8}),
  fc.option(fc.nat(), {nil: undefined}))
  .map(([asset, changes, cut]) => {
    const bytes = Buffer.from(asset);
    for (const [at, value] of changes) bytes[at % bytes.length] = value;
    return cut === undefined ? bytes : bytes.subarray(0, cut % bytes.length);
  });

const anyBody = fc.oneof(brokenAsset, fc.uint8Array({maxLength: 300}).map((a) => Buffer.from(a)),
                         fc.string({maxLength: 300}).map((text) => Buffer.from(text)));

const anyType = fc.constantFrom(
  'model/gltf-binary', 'model/gltf+json', 'model/obj', 'application/octet-stream',
  'multipart/form-data', 'multipart/form-data; boundary=', 'multipart/form-data; boundary=x',
  'text/plain', '', 'model/*', 'application/json; charset=utf-8');

const anyAccept = fc.constantFrom(
  '*/*', 'model/*', 'application/json', 'model/obj;q=0', 'text/html', ',', ';q=x', '*/*;q=0.0');

async function bodies(run, base) {
  const property = fc.asyncProperty(anyBody, anyType, anyAccept, async (body, type, accept) => {
    const headers = {'Content-Type': type, Accept: accept};
    obey(run, 'unwrap', await request(base, {method: 'POST', path: '/v1/unwrap', headers, body}));
  });
  await check(run, 'bodies to /v1/unwrap', property, 300);
  const anyWish = fc.string({maxLength: 12});
  const jobs = fc.asyncProperty(anyBody, anyType, anyWish, async (body, type, wish) => {
    const Prefer = `wait=${wish.replace(/[^ -~]/g, '')}`;
    const headers = {'Content-Type': type, Prefer};
    obey(run, 'createJob', await request(base, {method: 'POST', path: '/v1/jobs', headers, body}));
  });
  await check(run, 'bodies to /v1/jobs', jobs, 150);
}

async function paths(run, base) {
  const ids = fc.oneof(fc.string({minLength: 1, maxLength: 40}),
                       fc.constantFrom('..', '.', '%00', '%'),
                       fc.stringMatching(/^j_[0-9a-f]{32}$/));
  const operations = run.contract.operations().filter(
    ({path, method}) => path.includes('{') && ['GET', 'DELETE'].includes(method));  // others need a body
  const property = fc.asyncProperty(fc.constantFrom(...operations), ids, async (operation, id) => {
    const segment = encodeURIComponent(id).replaceAll('.', '%2e');
    const path = pathTo(operation.path, segment, segment);
    const answer = await request(base, {method: operation.method, path});
    obey(run, operation.id, answer);
    // URLs lose a segment that is a dot, which can make the path of another call.
    const isOther = ['.', '..'].includes(id) && answer.status === 405;
    if (answer.status !== 404 && !isOther) throw new Error(`status ${answer.status} for an unknown job`);
  });
  await check(run, 'ids', property, 300);
}

export async function fuzz(run, base) {
  await jsonOptions(run, base);
  await queryOptions(run, base);
  await bodies(run, base);
  await paths(run, base);
  await run.call(base, 'getHealth', {status: 200, name: 'alive after the fuzz'});
}
