// OBJ and OFF: text with a line for each vertex and face. Polygons become fans of triangles, as the
// server makes them.
import type {Model} from '../mesh/model.js';
import {Numbers, modelOf} from './faces.js';

class ObjReader {
  readonly places = new Numbers();
  readonly uvs = new Numbers();
  readonly faces = new Numbers();
  readonly corners = new Numbers(); // the vt of each corner, -1 for none

  line(text: string): void {
    const words = text.trim().split(/\s+/);
    if (words[0] === 'v') for (let i = 1; i <= 3; i += 1) this.places.push(Number(words[i]));
    else if (words[0] === 'vt') for (let i = 1; i <= 2; i += 1) this.uvs.push(Number(words[i] ?? 0));
    else if (words[0] === 'f') this.#face(words);
  }

  #face(words: string[]): void {
    for (let i = 3; i < words.length; i += 1) for (const word of [words[1]!, words[i - 1]!, words[i]!]) this.#corner(word);
  }

  #corner(word: string): void {
    const [v, vt] = word.split('/');
    this.faces.push(this.#index(v!, this.places.length / 3));
    this.corners.push(vt ? this.#index(vt, this.uvs.length / 2) : -1);
  }

  #index(word: string, count: number): number {
    const index = Number(word);
    return index < 0 ? count + index : index - 1;
  }

  get uvSets() {
    const {corners, uvs} = this;
    if (uvs.length === 0 || corners.values.includes(-1)) return [];
    const uv = new Float32Array(corners.length * 2);
    for (let c = 0; c < corners.length; c += 1) for (let i = 0; i < 2; i += 1) uv[2 * c + i] = uvs.at(2 * corners.at(c) + i);
    return [{name: 'vt', uv}];
  }
}

/** Lines of a text, with \ at the end of one continued in the next. */
function* linesOf(bytes: Uint8Array): Generator<string> {
  const decoder = new TextDecoder();
  const piece = 1 << 22;
  let rest = '';
  for (let at = 0; at < bytes.length; at += piece) {
    const lines = (rest + decoder.decode(bytes.subarray(at, at + piece), {stream: true})).split(/\r\n|\r(?!$)|\n/);
    rest = lines.pop()!;
    for (const line of lines) yield line;
  }
  yield rest;
}

export function readObj(bytes: Uint8Array): Model {
  const reader = new ObjReader();
  let begun = '';
  for (const line of linesOf(bytes)) {
    if (line.endsWith('\\')) begun += `${line.slice(0, -1)} `;
    else {
      const [first, second] = [begun.charCodeAt(0) || line.charCodeAt(0), line.length];
      if (second > 0 && first !== 35) reader.line(begun + line);
      begun = '';
    }
  }
  return modelOf(reader.places.values, reader.faces.values, reader.uvSets);
}

export function readOff(text: string): Model {
  const words = text.replace(/#.*/g, '').split(/\s+/).filter(Boolean);
  let at = /OFF$/.test(words[0] ?? '') ? 1 : 0;
  const take = () => Number(words[at++]);
  const [vertices, polygons] = [take(), take()];
  take(); // edges
  const positions = Float64Array.from({length: 3 * vertices}, take);
  const faces = new Numbers();
  const lines = text.replace(/#.*/g, '').split(/\r\n|\r|\n/).filter((line) => line.trim());
  for (const line of lines.slice(lines.length - polygons)) {
    const [size = 0, ...corners] = line.trim().split(/\s+/).map(Number);
    for (let i = 2; i < size; i += 1) for (const corner of [corners[0]!, corners[i - 1]!, corners[i]!]) faces.push(corner);
  }
  return modelOf(positions, faces.values, []);
}
