// Normals of corners: smooth, but for edges that are sharp.
import type {Surface} from '../mesh/surface.js';

const SHARP = 0.7; // cosine of the angle to the smooth normal beyond which a face keeps its own

/** Of each face, twice its area long. */
export function faceNormals(positions: Float32Array): Float32Array {
  const normals = new Float32Array(positions.length / 3);
  for (let at = 0, n = 0; at < positions.length; at += 9, n += 3) {
    const e = (i: number, j: number) => positions[at + j * 3 + i]! - positions[at + i]!;
    const [ax, ay, az, bx, by, bz] = [e(0, 1), e(1, 1), e(2, 1), e(0, 2), e(1, 2), e(2, 2)];
    normals[n] = ay * bz - az * by;
    normals[n + 1] = az * bx - ax * bz;
    normals[n + 2] = ax * by - ay * bx;
  }
  return normals;
}

export function normalsOf({positions, points, pointCount}: Surface): Float32Array {
  const own = faceNormals(positions);
  const smooth = new Float32Array(pointCount * 3);
  points.forEach((point, c) => {
    const f = 3 * Math.floor(c / 3);
    for (let i = 0; i < 3; i += 1) smooth[3 * point + i] = smooth[3 * point + i]! + own[f + i]!;
  });
  const normals = new Float32Array(positions.length);
  points.forEach((point, c) => {
    const [f, p] = [3 * Math.floor(c / 3), 3 * point];
    const length = Math.hypot(own[f]!, own[f + 1]!, own[f + 2]!) || 1;
    const whole = Math.hypot(smooth[p]!, smooth[p + 1]!, smooth[p + 2]!) || 1;
    const cosine = (own[f]! * smooth[p]! + own[f + 1]! * smooth[p + 1]! + own[f + 2]! * smooth[p + 2]!) / length / whole;
    const [from, at, by] = cosine > SHARP ? [smooth, p, whole] : [own, f, length];
    for (let i = 0; i < 3; i += 1) normals[3 * c + i] = from[at + i]! / by;
  });
  return normals;
}
