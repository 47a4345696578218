// PLY, as text and binary: vertices with texture coordinates, polygons, which become fans of
// triangles, and strips of triangles. The loader of three knows faces of 3 and 4 corners only.
import {type Model, uvOfCorners} from '../mesh/model.js';
import {Numbers, modelOf} from './faces.js';

interface Property {
  name: string;
  type: string;
  /** The type of the length of a list. */
  count?: string;
}

interface Element {
  name: string;
  count: number;
  properties: Property[];
}

/** Reads the next value. */
type Next = (type: string) => number;

const BINARY: Record<string, [number, (view: DataView, at: number, little: boolean) => number]> = {
  int8: [1, (view, at) => view.getInt8(at)],
  uint8: [1, (view, at) => view.getUint8(at)],
  int16: [2, (view, at, little) => view.getInt16(at, little)],
  uint16: [2, (view, at, little) => view.getUint16(at, little)],
  int32: [4, (view, at, little) => view.getInt32(at, little)],
  uint32: [4, (view, at, little) => view.getUint32(at, little)],
  float32: [4, (view, at, little) => view.getFloat32(at, little)],
  float64: [8, (view, at, little) => view.getFloat64(at, little)],
};
const OLD_NAMES: Record<string, string> = {
  char: 'int8', uchar: 'uint8', short: 'int16', ushort: 'uint16', int: 'int32', uint: 'uint32', float: 'float32', double: 'float64',
};
const LONGEST_HEAD = 1 << 16;

interface Head {
  format: string;
  elements: Element[];
  /** Bytes before the first value. */
  size: number;
}

function headOf(buffer: ArrayBuffer): Head {
  const text = new TextDecoder('latin1').decode(buffer.slice(0, LONGEST_HEAD));
  const end = /(?:^|[\r\n])end_header[ \t]*/.exec(text);
  if (!text.startsWith('ply') || !end) throw new Error('its head has no end.');
  const after = end.index + end[0].length;
  const head: Head = {format: '', elements: [], size: after + (text.startsWith('ply\r\n') ? 2 : 1)};
  const type = (word = '') => {
    const name = OLD_NAMES[word] ?? word;
    if (!(name in BINARY)) throw new Error(`"${word}" is no type of numbers.`);
    return name;
  };
  for (const line of text.slice(0, end.index).split(/[\r\n]+/)) {
    const [word, ...rest] = line.trim().split(/\s+/);
    const properties = head.elements.at(-1)?.properties;
    if (word === 'format') head.format = rest[0]!;
    else if (word === 'element') head.elements.push({name: rest[0]!, count: Number(rest[1]), properties: []});
    else if (word === 'property' && rest[0] === 'list') properties?.push({count: type(rest[1]), type: type(rest[2]), name: rest[3]!});
    else if (word === 'property') properties?.push({type: type(rest[0]), name: rest[1]!});
  }
  return head;
}

function valuesOf(buffer: ArrayBuffer, {format, size}: Head): Next {
  if (format === 'ascii') {
    const text = new TextDecoder().decode(new Uint8Array(buffer, size)), words = /\S+/g;
    return () => {
      const word = words.exec(text);
      if (!word) throw new Error('it ends too early.');
      return Number(word[0]);
    };
  }
  const view = new DataView(buffer), little = format === 'binary_little_endian';
  let at = size;
  return (type) => {
    const [bytes, read] = BINARY[type]!;
    at += bytes;
    return read(view, at - bytes, little);
  };
}

/** Triangles of a polygon. */
function addFan(corners: number[], faces: Numbers): void {
  for (let i = 2; i < corners.length; i += 1) for (const k of [0, i - 1, i]) faces.push(corners[k]!);
}

/** Triangles of strips with -1 between them, every second one the other way round. */
function addStrips(corners: number[], faces: Numbers): void {
  for (let i = 0, begin = 0; i < corners.length; i += 1) {
    if (corners[i] === -1) begin = i + 1;
    const [a, b, c] = [corners[i - 2]!, corners[i - 1]!, corners[i]!];
    if (i < begin + 2 || a === b || b === c || c === a) continue;
    for (const v of (i - begin) % 2 === 0 ? [a, b, c] : [b, a, c]) faces.push(v);
  }
}

class PlyReader {
  readonly positions = new Numbers();
  readonly uv = new Numbers();
  readonly faces = new Numbers();

  constructor(private readonly next: Next) {}

  read(element: Element): void {
    const add = {face: addFan, tristrips: addStrips}[element.name];
    if (element.properties.length === 0) return;
    const isVertex = element.name === 'vertex' && this.positions.length === 0;
    for (let i = 0; i < element.count; i += 1) {
      const row: Record<string, number> = {};
      for (const property of element.properties) {
        if (property.count === undefined) row[property.name] = this.next(property.type);
        else {
          const list = this.#list(property);
          if (add && /^vertex_ind(ices|ex)$/.test(property.name)) add(list, this.faces);
        }
      }
      if (isVertex) this.#take(row);
    }
  }

  #list({count, type}: Property): number[] {
    const list = [];
    for (let left = this.next(count!); left > 0; left -= 1) list.push(this.next(type));
    return list;
  }

  #take(row: Record<string, number>): void {
    for (const axis of ['x', 'y', 'z']) this.positions.push(row[axis]!);
    const u = row['s'] ?? row['u'] ?? row['texture_u'] ?? row['texture_s'];
    const v = row['t'] ?? row['v'] ?? row['texture_v'] ?? row['texture_t'];
    if (u === undefined || v === undefined) return;
    this.uv.push(u);
    this.uv.push(v);
  }
}

export function readPly(buffer: ArrayBuffer): Model {
  const head = headOf(buffer);
  const reader = new PlyReader(valuesOf(buffer, head));
  for (const element of head.elements) reader.read(element);
  const faces = reader.faces.values;
  const uvSets = reader.uv.length > 0 ? [{name: 'uv', uv: uvOfCorners(reader.uv.values, Uint32Array.from(faces))}] : [];
  return modelOf(reader.positions.values, faces, uvSets);
}
