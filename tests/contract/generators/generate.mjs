// Runs the generators over openapi.yaml; each returns what it said while it worked.
import openapiTypescript, {astToString} from 'openapi-typescript';
import {createClient} from '@hey-api/openapi-ts';
import orval from 'orval';
import {mkdirSync, writeFileSync} from 'node:fs';
import {join} from 'node:path';
import ts from 'typescript';

/** Bodies that are not a form: of these calls orval then makes one function for forms. */
const kRaw = ['application/octet-stream', 'model/gltf-binary', 'model/gltf+json', 'model/obj',
              'model/stl', 'model/ply', 'model/off', 'application/zip'];
const kForms = ['createJob', 'createAndWatchJob', 'putJob', 'putAndWatchJob'];

/** Types alone. Bytes are Blob, where it would say string, and a member with a default may be left out. */
async function openapiTypes(contract, folder) {
  const blob = ts.factory.createTypeReferenceNode('Blob');
  const nodes = await openapiTypescript(contract, {
    defaultNonNullable: false,
    transform: (schema) => (schema.format === 'binary' ? blob : undefined),
  });
  mkdirSync(folder, {recursive: true});
  writeFileSync(join(folder, 'api.ts'), astToString(nodes));
}

function heyApi(contract, folder) {
  return createClient({
    input: contract.pathname, output: folder,
    plugins: ['@hey-api/client-fetch', '@hey-api/typescript', '@hey-api/sdk'],
  });
}

function orvalAxios(contract, folder) {
  return orval.generate({input: contract.pathname, output: {target: join(folder, 'api.ts'), client: 'axios'}});
}

function orvalFetch(contract, folder) {
  const forms = {contentType: {exclude: kRaw}};
  return orval.generate({
    input: contract.pathname,
    output: {
      target: join(folder, 'api.ts'), client: 'fetch',
      override: {
        mutator: {path: join(folder, '../../orval_call.ts'), name: 'call'},
        operations: Object.fromEntries(kForms.map((id) => [id, forms])),
      },
    },
  });
}

export const kGenerators = {
  'openapi-typescript': openapiTypes, 'hey-api': heyApi, 'orval-axios': orvalAxios, 'orval-fetch': orvalFetch,
};
