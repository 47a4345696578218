// OBJ and OFF: text with a line for each vertex and face. Polygons become fans of triangles: as
// many as the server makes of them, and the same ones where a polygon is convex.
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

/** The numbers of a text, with comments behind #. */
class NumbersOfText {
  readonly #number = /(?:\s|#[^\r\n]*)*([^\s#]+)/y;
  readonly #restOfLine = /[^\r\n]*/y;

  constructor(private readonly text: string, at: number) {
    this.#number.lastIndex = at;
  }

  next(): number {
    const found = this.#number.exec(this.text);
    if (!found) throw new Error('it ends too early.');
    return Number(found[1]);
  }

  skipLine(): void {
    this.#restOfLine.lastIndex = this.#number.lastIndex;
    this.#restOfLine.exec(this.text);
    this.#number.lastIndex = this.#restOfLine.lastIndex;
  }
}

/** What follows the coordinates of a vertex, or the corners of a face, on its line is passed over. */
export function readOff(text: string): Model {
  const [begin, keyword] = /^(?:\s|#[^\r\n]*)*((?:ST)?C?N?OFF)?/.exec(text)!;
  const numbers = new NumbersOfText(text, begin.length);
  const [vertices, polygons] = [numbers.next(), numbers.next()];
  numbers.skipLine(); // edges
  const positions = new Numbers();
  const faces = new Numbers();
  for (let v = 0; v < vertices; v += 1) {
    for (let i = 0; i < 3; i += 1) positions.push(numbers.next());
    if (keyword?.endsWith('NOFF')) for (let i = 0; i < 3; i += 1) numbers.next();
    numbers.skipLine();
  }
  for (let f = 0; f < polygons; f += 1) {
    const corners = Array.from({length: numbers.next()}, () => numbers.next());
    for (let i = 2; i < corners.length; i += 1) for (const k of [0, i - 1, i]) faces.push(corners[k]!);
    numbers.skipLine();
  }
  return modelOf(positions.values, faces.values, []);
}
