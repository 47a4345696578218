// Validates answers with the Khronos glTF validator: none may have an error that its input did not
// have. Usage: node validate.mjs LIST, where each line of LIST is "input<TAB>answer". External
// buffers and images of both are read beside the input. Prints what is new and exits with 1 if anything is.
import fs from 'node:fs';
import path from 'node:path';
import validator from 'gltf-validator';

const readBeside = (file) => async (uri) =>
  new Uint8Array(fs.readFileSync(path.join(path.dirname(file), decodeURIComponent(uri))));

/** No errors, but marks of something that a valid asset has lost. */
const lost = new Set(['MESH_PRIMITIVE_NO_TANGENT_SPACE']);

/** How often each error code occurs. */
async function errorsOf(file, home) {
  const bytes = new Uint8Array(fs.readFileSync(file));
  const options = {externalResourceFunction: readBeside(home), maxIssues: 0};
  const report = await validator.validateBytes(bytes, options);
  const errors = new Map();
  for (const {severity, code, message, pointer} of report.issues.messages) {
    if (severity > 0 && !lost.has(code)) continue;
    const known = errors.get(code) ?? {count: 0, message, pointer};
    errors.set(code, {...known, count: known.count + 1});
  }
  return errors;
}

const unreadable = (error) =>
  new Map([['UNREADABLE', {count: 1, message: String(error), pointer: ''}]]);

let bad = 0;
const pairs = fs.readFileSync(process.argv[2], 'utf8').trim().split('\n');
for (const [input, answer] of pairs.map((line) => line.split('\t'))) {
  const before = await errorsOf(input, input).catch(() => new Map());
  const after = await errorsOf(answer, input).catch(unreadable);
  for (const [code, {count, message, pointer}] of after) {
    if (count <= (before.get(code)?.count ?? 0)) continue;
    console.log(`${input}: ${count} new ${code} at ${pointer}: ${message}`);
    ++bad;
  }
}
console.log(`${pairs.length} answers validated, ${bad} new errors`);
process.exit(bad === 0 && pairs.length > 0 ? 0 : 1);
