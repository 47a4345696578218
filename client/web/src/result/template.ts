// A template to paint on: exactly the page, with the borders of islands and nothing else.
import type {Surface} from '../mesh/surface.js';
import type {Mapped} from '../mesh/islands.js';
import {bothSides, linesOf} from '../view/lines.js';

export function templateOf(map: Mapped, surface: Surface, width: number, height: number): Blob {
  const lines = linesOf(bothSides(map, surface), map.uv, 2);
  const path: string[] = [];
  const at = (i: number) => `${(lines[i]! * width).toFixed(2)} ${((1 - lines[i + 1]!) * height).toFixed(2)}`;
  for (let i = 0; i < lines.length; i += 4) path.push(`M${at(i)}L${at(i + 2)}`);
  return new Blob([
    `<svg xmlns="http://www.w3.org/2000/svg" width="${width}" height="${height}" viewBox="0 0 ${width} ${height}">`,
    `<path d="${path.join('')}" fill="none" stroke="#000" stroke-width="1" stroke-linecap="round"/></svg>\n`,
  ], {type: 'image/svg+xml'});
}
