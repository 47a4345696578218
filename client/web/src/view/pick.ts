// What lies under a pointer: the first triangle along a ray, or the one around a point of the page.

/** The nearest face along origin + t direction, and its distance; -1 for none. */
export function faceAlong(positions: Float32Array, o: number[], d: number[]): {face: number; distance: number} {
  let [face, distance] = [-1, Infinity];
  const [ox, oy, oz, dx, dy, dz] = [o[0]!, o[1]!, o[2]!, d[0]!, d[1]!, d[2]!];
  for (let at = 0, f = 0; at < positions.length; at += 9, f += 1) {
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

/** The last face around a point of the page, since it is drawn on top; -1 for none. */
export function faceAround(uv: Float32Array, x: number, y: number): number {
  for (let at = uv.length - 6; at >= 0; at -= 6) {
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
