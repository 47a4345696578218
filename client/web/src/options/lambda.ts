// λ as people type and drag it: a number, or several.

const LOW = -3; // of the slider, as powers of ten; its left end is 0
const HIGH = 2;
export const SLIDER_STEPS = 100;

export function lambdaOfSlider(step: number): number {
  return step <= 0 ? 0 : Number((10 ** (LOW + ((HIGH - LOW) * step) / SLIDER_STEPS)).toPrecision(3));
}

export function sliderOfLambda(lambda: number): number {
  if (!(lambda > 0)) return 0;
  return Math.round(Math.min(Math.max(((Math.log10(lambda) - LOW) / (HIGH - LOW)) * SLIDER_STEPS, 1), SLIDER_STEPS));
}

/** "0.1" is 0.1; "1, 0.1" is a list. Throws Error with what to type. */
export function lambdaOfText(text: string, most = 32): number | number[] {
  const words = text.trim().split(/[\s,;]+/).filter(Boolean);
  const numbers = words.map(Number);
  const wrong = words.find((_, i) => !(numbers[i]! >= 0 && numbers[i]! < Infinity));
  if (words.length === 0 || wrong !== undefined)
    throw new Error(`λ must be a number of 0 or more, or several such as “1, 0.1”${wrong === undefined ? '' : `; “${wrong}” is not one`}.`);
  if (words.length > most) throw new Error(`λ takes at most ${most} values; these are ${words.length}.`);
  return numbers.length === 1 ? numbers[0]! : numbers;
}
