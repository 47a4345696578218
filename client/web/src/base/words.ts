// Numbers and counts as people read them.

const whole = new Intl.NumberFormat('en');

export const integer = (value: number): string => whole.format(value);

/** "1 face", "2 faces". */
export function count(value: number, one: string, many = `${one}s`): string {
  return `${integer(value)} ${value === 1 ? one : many}`;
}

/** Infinite figures arrive as the largest number of a double. */
export function fixed(value: number, digits: number): string {
  return value < Number.MAX_VALUE ? value.toFixed(digits) : 'infinite';
}

/** "a, b and c". */
export function list(words: string[]): string {
  return words.length < 2 ? words.join('') : `${words.slice(0, -1).join(', ')} and ${words.at(-1)}`;
}

/** Of a path, the name of its file. */
export const lastOf = (path: string) => path.replace(/^.*\//s, '');

/** "glb" of "chair.GLB". */
export const extensionOf = (name: string) => name.replace(/^.*\./s, '').toLowerCase();

/** "chair" of "chair.glb". */
export const withoutExtension = (name: string) => name.replace(/\.[^.]*$/s, '');
