// What a map does to each triangle, by the singular values of its Jacobian after one global scale that
// makes the area of all UVs that of the surface. The same figures as in the server's pictures.

export interface Stretches {
  /** Of each face; large >= small >= 0 in units of the global scale. */
  large: Float32Array;
  small: Float32Array;
  area: Float32Array;
  flipped: Uint8Array;
}

function edges(p: Float32Array, f: number): [number, number, number] {
  const at = 9 * f;
  const a = [p[at + 3]! - p[at]!, p[at + 4]! - p[at + 1]!, p[at + 5]! - p[at + 2]!];
  const b = [p[at + 6]! - p[at]!, p[at + 7]! - p[at + 1]!, p[at + 8]! - p[at + 2]!];
  const aa = Math.hypot(a[0]!, a[1]!, a[2]!);
  const along = aa > 0 ? (a[0]! * b[0]! + a[1]! * b[1]! + a[2]! * b[2]!) / aa : 0;
  const bb = b[0]! ** 2 + b[1]! ** 2 + b[2]! ** 2;
  return [aa, along, Math.sqrt(Math.max(0, bb - along * along))];
}

/** aspect: width / height of the texture. */
export function stretches(positions: Float32Array, uv: Float32Array, aspect = 1): Stretches {
  const count = uv.length / 6;
  const result = {large: new Float32Array(count), small: new Float32Array(count), area: new Float32Array(count), flipped: new Uint8Array(count)};
  let [space, page] = [0, 0];
  for (let f = 0; f < count; f += 1) {
    const [length, along, height] = edges(positions, f);
    const at = 6 * f;
    const [ux, uy] = [(uv[at + 2]! - uv[at]!) * aspect, uv[at + 3]! - uv[at + 1]!];
    const [vx, vy] = [(uv[at + 4]! - uv[at]!) * aspect, uv[at + 5]! - uv[at + 1]!];
    const doubled = length * height;
    result.area[f] = doubled / 2;
    if (!(doubled > 0)) continue;
    const [a, c] = [ux / length, uy / length]; // J = [a b; c d]
    const [b, d] = [(vx - a * along) / height, (vy - c * along) / height];
    const [e, g] = [Math.hypot(a + d, c - b) / 2, Math.hypot(a - d, b + c) / 2];
    result.large[f] = e + g;
    result.small[f] = Math.abs(e - g);
    result.flipped[f] = e < g ? 1 : 0;
    space += doubled;
    page += doubled * Math.abs(a * d - b * c);
  }
  const scale = page > 0 ? Math.sqrt(space / page) : 1;
  for (let f = 0; f < count; f += 1) {
    result.large[f] = result.large[f]! * scale;
    result.small[f] = result.small[f]! * scale;
  }
  return result;
}

/** D_angle and D_area of each island: 2 is ideal. */
export function deviations({large, small, area}: Stretches, island: Uint32Array, islandCount: number): {angle: number; area: number}[] {
  const [weights, angles, areas] = [new Float64Array(islandCount), new Float64Array(islandCount), new Float64Array(islandCount)];
  island.forEach((which, f) => {
    const a = area[f]!;
    if (!(a > 0)) return;
    const [s, t] = [large[f]!, Math.max(small[f]!, 1e-6)];
    weights[which] = weights[which]! + a;
    angles[which] = angles[which]! + a * (s / t + t / s);
    areas[which] = areas[which]! + a * (s * t + 1 / (s * t));
  });
  return Array.from(weights, (weight, i) => (weight > 0 ? {angle: angles[i]! / weight, area: areas[i]! / weight} : {angle: 2, area: 2}));
}
