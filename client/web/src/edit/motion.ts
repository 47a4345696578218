// An island that is turned about the middle of its box and then moved, as the option locked_islands wants it.

/** turn: degrees counterclockwise, with V upwards; move: along U and V. */
export interface Motion {
  turn: number;
  move: [number, number];
}

export const AT_REST: Motion = {turn: 0, move: [0, 0]};
const SLACK = 1e-6;
const STEP = 2 ** -24; // the server writes multiples of it

export const isAtRest = ({turn, move: [u, v]}: Motion) => turn === 0 && u === 0 && v === 0;

interface Box {
  low: [number, number];
  high: [number, number];
}

export function boxOf(faces: readonly number[], uv: Float32Array): Box {
  const {low, high}: Box = {low: [Infinity, Infinity], high: [-Infinity, -Infinity]};
  for (const f of faces)
    for (let at = 6 * f; at < 6 * f + 6; at += 1) {
      low[at % 2] = Math.min(low[at % 2]!, uv[at]!);
      high[at % 2] = Math.max(high[at % 2]!, uv[at]!);
    }
  return {low, high};
}

/** The middle of the box around faces. */
export function middleOf(faces: readonly number[], uv: Float32Array): [number, number] {
  const {low, high} = boxOf(faces, uv);
  return [(low[0] + high[0]) / 2, (low[1] + high[1]) / 2];
}

/** Whether a box lies on one of the pages, but for the rounding of UVs that the server, too, lets pass. */
export function isOnPage({low, high}: Box, pages: number): boolean {
  const page = Math.floor((low[0] + high[0]) / 2);
  return page >= 0 && page < pages && low[0] >= page - SLACK && high[0] <= page + 1 + SLACK && low[1] >= -SLACK && high[1] <= 1 + SLACK;
}

/** Moves faces of `to` from where they are in `from`. aspect: of the page, whose shape turning keeps. */
export function place(faces: readonly number[], {turn, move}: Motion, aspect: number, from: Float32Array, to: Float32Array): void {
  const [u, v] = middleOf(faces, from);
  const [cos, sin] = [Math.cos((turn / 180) * Math.PI), Math.sin((turn / 180) * Math.PI)];
  for (const f of faces)
    for (let at = 6 * f; at < 6 * f + 6; at += 2) {
      const [x, y] = [(from[at]! - u) * aspect, from[at + 1]! - v];
      to[at] = Math.round(((cos * x - sin * y) / aspect + u + move[0]) / STEP) * STEP;
      to[at + 1] = Math.round((sin * x + cos * y + v + move[1]) / STEP) * STEP;
    }
}
