// Everything has a hashed name beside the page; nothing is inlined, as the policy of the page wants.
import {fileURLToPath} from 'node:url';
import {defineConfig} from 'vite';

const root = fileURLToPath(new URL('.', import.meta.url));

/** The page names the decoder that it wants (files/draco.ts); those that DRACOLoader names are left out. */
const oneDecoder = {
  name: 'one-decoder',
  enforce: 'pre',
  transform: (code, id) => (/DRACOLoader\.js$/.test(id) ? code.replace(/new URL\(\s*'[^']*draco[^']*',\s*import\.meta\.url\s*\)/g, "''") : undefined),
};

export default defineConfig({
  plugins: [oneDecoder],
  root,
  base: './',
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
      output: {manualChunks: {three: ['three'], swagger: ['swagger-ui-dist/swagger-ui-es-bundle.js']}},
    },
  },
});
