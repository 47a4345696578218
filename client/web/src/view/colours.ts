// The colours of the server's pictures: even steps of lightness, so that they stay in order in grey.

const WORSE = ['d1fdc7', 'a5f0bc', '74e2ba', '35d2bc', '00c0c0', '00abc1', '0094be', '007db5', '1d66a5', '32518e', '383e74', '352e57'];
const LESS_OR_MORE = ['143b7b', '22599d', '3a79ba', '5b99d2', '84b9e4', 'b3d8f3', 'f4f4ef', 'e6d1ab', 'd5ad75', 'c38944', 'ad6613', '934600', '742900'];

export type Rgb = [number, number, number];

const linear = (s: number) => (s <= 0.04045 ? s / 12.92 : ((s + 0.055) / 1.055) ** 2.4);

/** Light of red, green and blue, as WebGL wants it, of "rrggbb". */
export function rgb(hex: string): Rgb {
  return [0, 2, 4].map((at) => linear(parseInt(hex.slice(at, at + 2), 16) / 255)) as Rgb;
}

export interface Scale {
  colours: string[];
  ticks: string[];
  of: (value: number) => Rgb;
}

function scale(hexes: string[], low: number, high: number, first: number, ticks: string[]): Scale {
  const colours = hexes.map(rgb);
  const last = hexes.length - 1;
  const of = (value: number) => {
    const place = first + ((last - first) * Math.log(value / low)) / Math.log(high / low);
    return colours[place <= last ? Math.max(0, Math.floor(place)) : last]!;
  };
  return {colours: hexes, ticks, of};
}

export const WORSE_SCALE = scale(WORSE, 1, 4, 0, ['1', '2', '4 or more']);
export const AREA_SCALE = scale(LESS_OR_MORE, 0.25, 4, 1, ['1/4 or less', '1/2', '1', '2', '4 or more']);

/** A colour for each chart: hues a golden angle apart, none darker than a label on it can stand. */
export function chartColour(number: number): Rgb {
  const hue = (number * 137.508) % 360;
  const light = 0.62 + 0.12 * ((number % 3) / 2);
  const channel = (n: number) => {
    const k = (n + hue / 30) % 12;
    return linear(light - 0.5 * Math.min(light, 1 - light) * Math.max(-1, Math.min(k - 3, 9 - k, 1)));
  };
  return [channel(0), channel(8), channel(4)];
}
