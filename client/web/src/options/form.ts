// The form of options, made of GET /v1/methods: a row for each option that the method has. It shows what
// the chosen preset sets, and gives what differs from that.
import {$, el} from '../base/dom.js';
import {lambdaOfText} from './lambda.js';
import {FIRST, labelOf, wordsOf} from './names.js';
import type {Methods, Option} from './types.js';

type Input = HTMLInputElement | HTMLSelectElement;

/** Options with an editor of their own elsewhere on the page, and lists that only programs need. */
const ELSEWHERE = ['preset', 'lambda', 'constraints', 'seam_edges', 'keep_edges', 'locked_islands', 'materials', 'primitives'];

const idOf = (name: string) => `option-${name.replace('.', '-')}`;

function inputOf(option: Option): Input {
  const {name} = option;
  const common = {name, id: idOf(name)};
  if (option.enum && !option.words) {
    const select = el('select', common);
    for (const value of option.enum) select.add(new Option(wordsOf(name, value), value));
    return select;
  }
  if (option.type === 'boolean') return el('input', {...common, type: 'checkbox'});
  if (option.words || option.type === 'string')
    return el('input', {...common, type: 'text', autocomplete: 'off', placeholder: option.default === null ? 'none' : ''});
  const {minimum, maximum} = option;
  return el('input', {...common, type: 'number', step: option.type === 'integer' ? '1' : 'any',
    ...(minimum === undefined ? {} : {min: String(minimum)}), ...(maximum === undefined ? {} : {max: String(maximum)}),
    placeholder: option.default === null ? 'automatic' : ''});
}

export class OptionsForm {
  readonly #methods: Methods;
  readonly #inputs = new Map<string, Input>();
  onMethod?: (method: string) => void;

  constructor(methods: Methods) {
    this.#methods = methods;
    for (const option of methods.options.filter(({name}) => !ELSEWHERE.includes(name))) this.#addRow(option);
    for (const {name, title, description} of methods.presets) this.#addPreset(name, title, description);
    this.#inputs.get('method')!.addEventListener('change', () => this.#showWhatCounts());
    this.#showPreset();
  }

  #addRow(option: Option): void {
    const input = inputOf(option);
    const help = el('small', {id: `${input.id}-help`}, option.description);
    input.setAttribute('aria-describedby', help.id);
    const label = el('label', {htmlFor: input.id}, labelOf(option.name));
    const row = el('div', {className: 'option'}, label, ' ', el('code', {}, option.name), input, help);
    this.#inputs.set(option.name, input);
    $(FIRST.includes(option.name) ? 'options' : 'more').append(row);
  }

  #addPreset(name: string, title: string, description: string): void {
    const input = el('input', {type: 'radio', name: 'preset', value: name, id: `preset-${name}`, checked: name === 'texture'});
    input.addEventListener('change', () => this.#showPreset());
    const card = el('div', {className: 'card'}, input, el('label', {htmlFor: input.id}, el('b', {}, title), el('span', {}, description)));
    $(name === 'paper' ? 'more-presets' : 'presets').append(card);
  }

  get preset(): string {
    return document.querySelector<HTMLInputElement>('input[name=preset]:checked')!.value;
  }

  get method(): string {
    return this.#inputs.get('method')!.value;
  }

  /** How many pages there may be. */
  get pages(): number {
    return Number(this.#inputs.get('max_pages')?.value) || 1;
  }

  #has(name: string): boolean {
    return this.#methods.methods.find((method) => method.name === this.method)!.options.includes(name);
  }

  #showWhatCounts(): void {
    for (const [name, input] of this.#inputs) input.parentElement!.hidden = !this.#has(name);
    const {title, description} = this.#methods.methods.find(({name}) => name === this.method)!;
    $(`${idOf('method')}-help`).textContent = `${title}. ${description}`;
    this.onMethod?.(this.method);
  }

  /** What the chosen preset sets. */
  #usual(option: Option): unknown {
    const preset = this.#methods.presets.find(({name}) => name === this.preset)!;
    const set = option.name.split('.').reduce<unknown>((at, name) => (at as Record<string, unknown> | undefined)?.[name], preset.options);
    return set === undefined ? option.default : set;
  }

  #showPreset(): void {
    for (const option of this.#methods.options) {
      const input = this.#inputs.get(option.name);
      if (!input) continue;
      const usual = this.#usual(option);
      if (input instanceof HTMLInputElement && input.type === 'checkbox') input.checked = usual === true;
      else input.value = usual === null ? '' : String(usual);
    }
    this.#showWhatCounts();
  }

  #valueOf(option: Option, input: Input): unknown {
    if (input instanceof HTMLInputElement && input.type === 'checkbox') return input.checked;
    if (option.enum || option.words?.includes(input.value)) return input.value;
    if (input.value === '') return null;
    if (option.type === 'string') return input.value;
    const number = Number(input.value);
    if (Number.isNaN(number)) throw new Error(`${labelOf(option.name)} must be a number${option.words ? `, or ${option.words.join(' or ')}` : ''}, not “${input.value}”.`);
    return number;
  }

  /** What differs from the preset, nested as the API has it. Throws Error with what to type. */
  chosen(): Record<string, unknown> {
    const options: Record<string, unknown> = this.preset === 'texture' ? {} : {preset: this.preset};
    for (const option of this.#methods.options) {
      const input = this.#inputs.get(option.name);
      if (!input || !this.#has(option.name)) continue;
      const value = this.#valueOf(option, input);
      const usual = this.#usual(option);
      if (value === usual || (value === null && typeof usual !== 'number')) continue;
      const path = option.name.split('.');
      const last = path.pop()!;
      path.reduce<Record<string, unknown>>((at, name) => (at[name] ??= {}) as Record<string, unknown>, options)[last] = value;
    }
    const lambda = this.method === 'hybrid' ? lambdaOfText($<HTMLInputElement>('lambda').value) : undefined;
    return lambda === undefined ? options : {...options, lambda};
  }
}
