// Archives: what is in them, and a mesh with its parts as one.
import {unzipSync, zipSync} from 'three/examples/jsm/libs/fflate.module.js';

import {lastOf} from '../base/words.js';
import type {Named} from './pick.js';

export async function unzipped(archive: Blob): Promise<Named[]> {
  const entries = unzipSync(new Uint8Array(await archive.arrayBuffer()));
  return Object.entries(entries)
    .filter(([name]) => !name.endsWith('/'))
    .map(([name, bytes]) => ({name, blob: new Blob([bytes as BlobPart])}));
}

/** Where a mesh asks for its parts: the references of a glTF; others lie beside it. */
async function references(mesh: Named): Promise<string[]> {
  if (!/\.gltf$/i.test(mesh.name)) return [];
  const {buffers = [], images = []} = JSON.parse(await mesh.blob.text());
  const uris = [...buffers, ...images].map(({uri}: {uri?: string}) => uri);
  return uris.filter((uri) => uri !== undefined && !uri.startsWith('data:')).map((uri) => decodeURIComponent(uri!));
}

/** The mesh and what belongs to it, each under the path by which the mesh asks for it. */
export async function zipped(files: Named[], mesh: Named): Promise<Blob> {
  const wanted = await references(mesh);
  const entries: Record<string, [Uint8Array, {level: 0}]> = {};
  for (const file of files) {
    const path = file === mesh ? lastOf(mesh.name) : wanted.find((uri) => lastOf(uri) === lastOf(file.name)) ?? lastOf(file.name);
    entries[path] = [new Uint8Array(await file.blob.arrayBuffer()), {level: 0}];
  }
  return new Blob([zipSync(entries) as BlobPart], {type: 'application/zip'});
}
