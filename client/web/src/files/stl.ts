// STL, binary and text: triangles without connection. Corners at one place are one vertex, in the order
// in which they come.
import {IDENTITY, type Model} from '../mesh/model.js';
import {weld} from '../mesh/table.js';

const HEAD = 84;
const FACE = 50;

function binaryCorners(buffer: ArrayBuffer): Float32Array | undefined {
  const view = new DataView(buffer);
  const count = buffer.byteLength >= HEAD ? view.getUint32(80, true) : -1;
  if (HEAD + count * FACE !== buffer.byteLength) return undefined;
  const corners = new Float32Array(count * 9);
  for (let f = 0; f < count; f += 1)
    for (let i = 0; i < 9; i += 1) corners[9 * f + i] = view.getFloat32(HEAD + f * FACE + 12 + 4 * i, true);
  return corners;
}

function textCorners(buffer: ArrayBuffer): Float32Array {
  const lines = new TextDecoder().decode(buffer).matchAll(/vertex\s+(\S+)\s+(\S+)\s+(\S+)/gi);
  return Float32Array.from(Array.from(lines, ([, x, y, z]) => [Number(x), Number(y), Number(z)]).flat());
}

export function readStl(buffer: ArrayBuffer): Model {
  const corners = binaryCorners(buffer) ?? textCorners(buffer);
  const first = weld(corners);
  const numbers = new Map<number, number>();
  const faces = first.map((v) => {
    if (!numbers.has(v)) numbers.set(v, numbers.size);
    return numbers.get(v)!;
  });
  const positions = new Float32Array(numbers.size * 3);
  for (const [v, number] of numbers) positions.set(corners.subarray(3 * v, 3 * v + 3), 3 * number);
  return {parts: [{name: '', positions, faces, uvSets: [], places: [IDENTITY]}]};
}
