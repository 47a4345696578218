// Builds the page into C++: node build.mjs FOLDER. Installs the packages of package-lock.json if they
// are not there, bundles src/ by Vite into FOLDER/page, and writes FOLDER/page_files.cpp: the files,
// compressed by gzip and Brotli, as page.hpp declares them.
import {execFileSync} from 'node:child_process';
import {existsSync, mkdirSync, readFileSync, readdirSync, statSync, writeFileSync} from 'node:fs';
import {dirname, extname, join, resolve} from 'node:path';
import {fileURLToPath} from 'node:url';
import {brotliCompressSync, constants, gzipSync} from 'node:zlib';

const here = dirname(fileURLToPath(import.meta.url));
const folder = resolve(process.argv[2] ?? join(here, '../../build/page'));

const TYPES = {
  '.css': 'text/css; charset=utf-8',
  '.js': 'text/javascript; charset=utf-8',
  '.svg': 'image/svg+xml',
  '.wasm': 'application/wasm',
};

/** Installs the packages, unless those that are there are as new as the lock file. */
function install() {
  const installed = join(here, 'node_modules/.package-lock.json');
  const lock = join(here, 'package-lock.json');
  if (existsSync(installed) && statSync(installed).mtimeMs >= statSync(lock).mtimeMs) return;
  execFileSync('npm', ['ci', '--ignore-scripts', '--no-audit', '--no-fund', '--loglevel=error'], {cwd: here, stdio: 'inherit'});
}

/** Bytes as a literal of C++: octal, so that no digit after them is taken for theirs. */
function literal(bytes) {
  const octets = Array.from(bytes, (byte) => `\\${byte.toString(8).padStart(3, '0')}`);
  const lines = [];
  for (let at = 0; at < octets.length; at += 64) lines.push(`"${octets.slice(at, at + 64).join('')}"`);
  return `std::string_view(\n${lines.join('\n') || '""'},\n${bytes.length})`;
}

function brotli(bytes) {
  const {BROTLI_PARAM_QUALITY, BROTLI_MAX_QUALITY, BROTLI_PARAM_SIZE_HINT} = constants;
  const params = {[BROTLI_PARAM_QUALITY]: BROTLI_MAX_QUALITY, [BROTLI_PARAM_SIZE_HINT]: bytes.length};
  return brotliCompressSync(bytes, {params});
}

function entry(name) {
  const bytes = readFileSync(join(folder, 'page/assets', name));
  const type = TYPES[extname(name)];
  if (!type) throw new Error(`${name}: build.mjs has no media type for it`);
  return `{"${name}", "${type}", ${literal(gzipSync(bytes, {level: 9}))}, ${literal(brotli(bytes))}}`;
}

install();
mkdirSync(folder, {recursive: true});
const {build} = await import('vite');
await build({configFile: join(here, 'vite.config.mjs'), build: {outDir: join(folder, 'page')}});
const names = readdirSync(join(folder, 'page/assets')).sort();
writeFileSync(join(folder, 'page_files.cpp'), `#include "client/web/page.hpp"

#include <array>

namespace unwrapd::web {
namespace {

constexpr std::array<PageFile, ${names.length}> kFiles = {{
${names.map(entry).join(',\n')}}};

}  // namespace

std::string_view index_html() {
  return ${literal(readFileSync(join(folder, 'page/index.html')))};
}

std::string_view docs_html() {
  return ${literal(readFileSync(join(folder, 'page/docs.html')))};
}

std::span<const PageFile> page_files() { return kFiles; }

}  // namespace unwrapd::web
`);
