// Builds the package into a folder: node build.mjs FOLDER. The types of the contract are generated,
// and everything is compiled, with the packages of tests/node_modules.
import {execFileSync} from 'node:child_process';
import {cpSync, mkdirSync, rmSync, symlinkSync} from 'node:fs';
import {dirname, join, resolve} from 'node:path';
import {fileURLToPath} from 'node:url';

const here = dirname(fileURLToPath(import.meta.url));
const root = join(here, '../..');
const tools = join(root, 'tests/node_modules');

/** Runs the program of a package. */
function run(program, ...words) {
  execFileSync(process.execPath, [join(tools, program), ...words], {stdio: 'inherit'});
}

const folder = resolve(process.argv[2] ?? join(root, 'build/clients/js'));
rmSync(folder, {recursive: true, force: true});
mkdirSync(folder, {recursive: true});
for (const name of ['src', 'examples', 'package.json', 'README.md', 'tsconfig.json'])
  cpSync(join(here, name), join(folder, name), {recursive: true});
cpSync(join(root, 'LICENSE'), join(folder, 'LICENSE'));
symlinkSync(tools, join(folder, 'node_modules'));
// A member with a default may be left out.
run('openapi-typescript/bin/cli.js', join(root, 'api/openapi.yaml'), '--default-non-nullable', 'false',
    '--output', join(folder, 'src/contract.ts'));
run('typescript/bin/tsc', '-p', folder);
