// Which of several files is the mesh.
import {UnreadableError} from './error.js';

/** A file by its name, perhaps with a path. */
export interface Named {
  name: string;
  blob: Blob;
}

const MESH = /\.(glb|gltf|obj|stl|ply|off)$/i;

/** The mesh and what may belong to it. Other meshes are named in a remark. */
export function pickMesh(files: Named[]): {mesh: Named; others: Named[]; remarks: string[]} {
  const meshes = files.filter(({name}) => MESH.test(name) && !/(^|\/)(__MACOSX|\.)/.test(name));
  const [mesh, ...further] = meshes;
  if (!mesh) {
    const names = files.map(({name}) => name).join(', ');
    throw new UnreadableError(`There is no mesh among these files: ${names}. Open a .glb, .gltf, .obj, .stl, .ply, .off or .zip.`);
  }
  const remarks = further.length > 0
    ? [`Only ${mesh.name} is open, not ${further.map(({name}) => name).join(', ')}: open one mesh at a time.`]
    : [];
  return {mesh, others: files.filter((file) => !meshes.includes(file)), remarks};
}

async function filesOfEntry(entry: FileSystemEntry): Promise<Named[]> {
  if (entry.isFile) {
    const file = await new Promise<File>((resolve, reject) => (entry as FileSystemFileEntry).file(resolve, reject));
    return [{name: entry.fullPath.replace(/^\//, ''), blob: file}];
  }
  const reader = (entry as FileSystemDirectoryEntry).createReader();
  const entries: FileSystemEntry[] = [];
  for (;;) {
    const some = await new Promise<FileSystemEntry[]>((resolve, reject) => reader.readEntries(resolve, reject));
    if (some.length === 0) break;
    entries.push(...some);
  }
  return (await Promise.all(entries.map(filesOfEntry))).flat();
}

export const named = (files: Iterable<File>): Named[] => Array.from(files, (file) => ({name: file.name, blob: file}));

/** The files that were dropped, those of folders too. */
export async function dropped(data: DataTransfer): Promise<Named[]> {
  const files = named(data.files); // before anything is awaited: the list is emptied after the event
  const entries = Array.from(data.items, (item) => item.webkitGetAsEntry?.()).filter((entry) => entry !== null && entry !== undefined);
  if (!entries.some((entry) => entry.isDirectory)) return files;
  return (await Promise.all(entries.map(filesOfEntry))).flat();
}
