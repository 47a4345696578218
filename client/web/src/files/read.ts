// Files that people open: one mesh and what belongs to it, as a model to look at and as the bytes to
// send.
import {extensionOf, lastOf} from '../base/words.js';
import type {Model} from '../mesh/model.js';
import {UnreadableError} from './error.js';
import {type Named, pickMesh} from './pick.js';

export interface Opened {
  /** The name of the mesh's file. */
  name: string;
  model: Model;
  /** What is sent: the file itself, or an archive of it and what belongs to it. */
  blob: Blob;
  mediaType: string;
  /** What was not used, in words. */
  remarks: string[];
}

const MEDIA_TYPES: Record<string, string> = {
  glb: 'model/gltf-binary', gltf: 'model/gltf+json', obj: 'model/obj', stl: 'model/stl', ply: 'model/ply', off: 'model/off',
  zip: 'application/zip',
};

async function modelOf(mesh: Named, others: Named[]): Promise<Model> {
  const extension = extensionOf(mesh.name);
  const bytes = () => mesh.blob.arrayBuffer();
  switch (extension) {
    case 'glb':
    case 'gltf':
      return (await import('./gltf.js')).readGltf(await bytes(), others);
    case 'obj':
      return (await import('./obj.js')).readObj(new Uint8Array(await bytes()));
    case 'off':
      return (await import('./obj.js')).readOff(await mesh.blob.text());
    case 'stl':
      return (await import('./stl.js')).readStl(await bytes());
    default:
      return (await import('./ply.js')).readPly(await bytes());
  }
}

function checked(model: Model, name: string): Model {
  const parts = model.parts.filter(({faces}) => faces.length > 0);
  if (parts.length === 0) throw new UnreadableError(`${name} has no triangles. Open a file with a mesh.`);
  return {...model, parts};
}

async function read(files: Named[], container: Named | undefined): Promise<Opened> {
  const {mesh, others, remarks} = pickMesh(files);
  const model = checked(await modelOf(mesh, others), mesh.name);
  const name = lastOf(mesh.name);
  if (container) return {name, model, blob: container.blob, mediaType: MEDIA_TYPES['zip']!, remarks};
  const belongs = ['gltf', 'obj'].includes(extensionOf(name)) ? others : [];
  const ignored = others.filter((file) => !belongs.includes(file)).map((file) => file.name);
  if (ignored.length > 0) remarks.push(`Not used: ${ignored.join(', ')}.`);
  if (belongs.length === 0) return {name, model, blob: mesh.blob, mediaType: MEDIA_TYPES[extensionOf(name)]!, remarks};
  const {zipped} = await import('./zip.js');
  return {name, model, blob: await zipped([mesh, ...belongs], mesh), mediaType: MEDIA_TYPES['zip']!, remarks};
}

/** Reads a mesh among files. Throws UnreadableError. */
export async function open(files: Named[]): Promise<Opened> {
  const archive = files.find(({name}) => extensionOf(name) === 'zip');
  try {
    if (!archive) return await read(files, undefined);
    const {unzipped} = await import('./zip.js');
    const opened = await read(await unzipped(archive.blob), archive);
    const ignored = files.filter((file) => file !== archive).map(({name}) => name);
    if (ignored.length > 0) opened.remarks.push(`Only ${archive.name} is open. Not used: ${ignored.join(', ')}.`);
    return opened;
  } catch (error) {
    if (error instanceof UnreadableError) throw error;
    const why = error instanceof Error ? error.message : String(error);
    throw new UnreadableError(`${files[0]!.name} cannot be shown here: ${why}`, {cause: error});
  }
}
