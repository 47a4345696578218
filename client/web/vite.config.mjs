// Everything has a hashed name beside the page; nothing is inlined, as the policy of the page wants.
import {existsSync, readFileSync} from 'node:fs';
import {fileURLToPath} from 'node:url';
import {defineConfig} from 'vite';

const root = fileURLToPath(new URL('.', import.meta.url));

/** The page names the decoder that it wants (files/draco.ts); those that DRACOLoader names are left out. */
const oneDecoder = {
  name: 'one-decoder',
  enforce: 'pre',
  transform: (code, id) => (/DRACOLoader\.js$/.test(id) ? code.replace(/new URL\(\s*'[^']*draco[^']*',\s*import\.meta\.url\s*\)/g, "''") : undefined),
};

/** What three brings along under licences of its own. */
const WITHIN_THREE = {
  'libs/draco/': 'Draco, Copyright 2017 The Draco Authors, Apache License 2.0, https://www.apache.org/licenses/LICENSE-2.0',
  'libs/fflate': 'fflate, Copyright (c) Arjun Barrett, MIT License',
  'libs/meshopt_decoder': 'meshoptimizer, Copyright (c) 2016-2026 Arseny Kapoulkine, MIT License',
};

/** A text for a comment. */
const read = (file) => readFileSync(file, 'utf8').trim().replaceAll('*/', '* /');

/** The licences of the packages in a file, which minifying would take away but for the exclamation mark. */
function licencesOf({moduleIds}) {
  const packages = new Set(moduleIds.map((id) => /\/.*\/node_modules\/(@[^/]+\/)?[^/]+\//.exec(id)?.[0]).filter(Boolean));
  const texts = [...packages].map((folder) => {
    const {name, version} = JSON.parse(readFileSync(`${folder}package.json`, 'utf8'));
    const files = ['LICENSE', 'LICENSE.md', 'NOTICE'].map((end) => folder + end).filter(existsSync);
    if (files.length === 0) throw new Error(`${name} has no licence that can be shipped with it`);
    return [`${name} ${version}`, ...files.map(read)].join('\n');
  });
  const within = Object.entries(WITHIN_THREE).filter(([part]) => moduleIds.some((id) => id.includes(part))).map(([, text]) => text);
  const bundled = moduleIds.map((id) => `${id.replace(/^\0|\?.*$/g, '')}.LICENSE.txt`).filter(existsSync); // of webpack
  const all = [...texts, ...within, ...new Set(bundled.map(read))];
  return all.length > 0 ? `/*!\n${all.join('\n\n')}\n*/` : '';
}

export default defineConfig({
  plugins: [oneDecoder],
  root,
  base: './',
  esbuild: {legalComments: 'inline'},
  logLevel: 'warn',
  worker: {format: 'es'},
  build: {
    target: 'es2022',
    assetsInlineLimit: 0,
    modulePreload: {polyfill: false},
    emptyOutDir: true,
    chunkSizeWarningLimit: 2048,
    reportCompressedSize: false,
    rollupOptions: {
      input: [`${root}index.html`, `${root}docs.html`],
      output: {manualChunks: {three: ['three'], swagger: ['swagger-ui-dist/swagger-ui-es-bundle.js']}, banner: licencesOf},
    },
  },
});
