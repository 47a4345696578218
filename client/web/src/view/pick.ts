// What lies under a pointer: the first triangle along a ray, or the one around a point of the page.

const RUN = 64; // faces

/** Boxes around runs of faces, the low corner of each and then the high one. size: numbers for each corner. */
export function boxesOf(corners: Float32Array, size: number): Float32Array {
  const run = 3 * size * RUN;
  const boxes = new Float32Array(Math.ceil(corners.length / run) * 2 * size);
  for (let box = 0, begin = 0; begin < corners.length; box += 2 * size, begin += run) {
    boxes.fill(Infinity, box, box + size).fill(-Infinity, box + size, box + 2 * size);
    for (let at = begin, i = 0; at < Math.min(begin + run, corners.length); at += 1, i = (i + 1) % size) {
      boxes[box + i] = Math.min(boxes[box + i]!, corners[at]!);
      boxes[box + size + i] = Math.max(boxes[box + size + i]!, corners[at]!);
    }
  }
  return boxes;
}

/** Whether a line that begins in `o` goes through a box; a side that it runs along counts. */
function meets(boxes: Float32Array, box: number, o: number[], d: number[]): boolean {
  let [from, to] = [0, Infinity];
  for (let i = 0; i < 3; i += 1) {
    const [low, high] = [boxes[box + i]! - o[i]!, boxes[box + 3 + i]! - o[i]!];
    if (d[i] === 0) {
      if (low > 0 || high < 0) return false;
      continue;
    }
    const [a, b] = [low / d[i]!, high / d[i]!];
    from = Math.max(from, Math.min(a, b));
    to = Math.min(to, Math.max(a, b));
  }
  return !(from > to * (1 + 1e-6)); // what is not a number meets all
}

/** The nearest face along origin + t direction, and its distance; -1 for none. boxes: of the positions. */
export function faceAlong(positions: Float32Array, boxes: Float32Array, o: number[], d: number[]): {face: number; distance: number} {
  let best = {face: -1, distance: Infinity};
  for (let box = 0; box < boxes.length; box += 6) {
    if (!meets(boxes, box, o, d)) continue;
    const begin = (box / 6) * RUN * 9;
    best = nearer(best, positions, begin, Math.min(begin + RUN * 9, positions.length), o, d);
  }
  return best;
}

function nearer(best: {face: number; distance: number}, positions: Float32Array, begin: number, end: number, o: number[], d: number[]) {
  let {face, distance} = best;
  const [ox, oy, oz, dx, dy, dz] = [o[0]!, o[1]!, o[2]!, d[0]!, d[1]!, d[2]!];
  for (let at = begin, f = begin / 9; at < end; at += 9, f += 1) {
    const [ax, ay, az] = [positions[at]!, positions[at + 1]!, positions[at + 2]!];
    const [ex, ey, ez] = [positions[at + 3]! - ax, positions[at + 4]! - ay, positions[at + 5]! - az];
    const [gx, gy, gz] = [positions[at + 6]! - ax, positions[at + 7]! - ay, positions[at + 8]! - az];
    const [px, py, pz] = [dy * gz - dz * gy, dz * gx - dx * gz, dx * gy - dy * gx];
    const volume = ex * px + ey * py + ez * pz;
    if (volume === 0) continue;
    const [tx, ty, tz] = [ox - ax, oy - ay, oz - az];
    const u = (tx * px + ty * py + tz * pz) / volume;
    if (u < 0 || u > 1) continue;
    const [qx, qy, qz] = [ty * ez - tz * ey, tz * ex - tx * ez, tx * ey - ty * ex];
    const v = (dx * qx + dy * qy + dz * qz) / volume;
    if (v < 0 || u + v > 1) continue;
    const t = (gx * qx + gy * qy + gz * qz) / volume;
    if (t > 0 && t < distance) [face, distance] = [f, t];
  }
  return {face, distance};
}

/** The last face around a point of the page, since it is drawn on top; -1 for none. boxes: of the coordinates. */
export function faceAround(uv: Float32Array, boxes: Float32Array, x: number, y: number): number {
  for (let box = boxes.length - 4; box >= 0; box -= 4) {
    if (x < boxes[box]! || y < boxes[box + 1]! || x > boxes[box + 2]! || y > boxes[box + 3]!) continue;
    const begin = (box / 4) * RUN * 6;
    const face = lastAround(uv, begin, Math.min(begin + RUN * 6, uv.length), x, y);
    if (face >= 0) return face;
  }
  return -1;
}

function lastAround(uv: Float32Array, begin: number, end: number, x: number, y: number): number {
  for (let at = end - 6; at >= begin; at -= 6) {
    const side = (i: number, j: number) =>
      (uv[at + j]! - uv[at + i]!) * (y - uv[at + i + 1]!) - (uv[at + j + 1]! - uv[at + i + 1]!) * (x - uv[at + i]!);
    const [a, b, c] = [side(0, 2), side(2, 4), side(4, 0)];
    if ((a >= 0 && b >= 0 && c >= 0) || (a <= 0 && b <= 0 && c <= 0)) return at / 6;
  }
  return -1;
}

/** The corner of a face that is nearest to a point; values: `size` numbers for each corner. */
export function nearestCorner(values: Float32Array, size: number, face: number, point: number[]): number {
  const distance = (c: number) => point.reduce((sum, value, i) => sum + (values[size * c + i]! - value) ** 2, 0);
  return [3 * face, 3 * face + 1, 3 * face + 2].reduce((best, c) => (distance(c) < distance(best) ? c : best));
}
