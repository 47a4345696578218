// The views with their tools: what is shown, in which colours, and what is picked.
import {$, el, once, show} from '../base/dom.js';
import {count} from '../base/words.js';
import {type Mapped, mapped, uvOf} from '../mesh/islands.js';
import type {Model} from '../mesh/model.js';
import {overlappingFaces} from '../mesh/overlaps.js';
import {type Surface, surfaceOf} from '../mesh/surface.js';
import {type Chart, chartsOf, describe} from '../result/charts.js';
import {type Colouring, SCALES, type Shown, shown} from '../view/paint.js';
import {type Skin, skinOf} from '../view/skin.js';
import {imageTexture} from '../view/textures.js';
import {Viewer} from '../view/viewer.js';

const UNSEEN = 0.01; // distortion that nobody sees: no chart is the worst one
const SEARCHED_FACES = 300_000; // beyond them overlaps of a mesh as it came in are not searched for

const colour = (name: string) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

/** Colours of the page as the views want them: light-dark() is resolved by a property that has it. */
function resolved(name: string): string {
  const probe = el('span');
  probe.style.color = colour(name);
  document.body.append(probe);
  const found = getComputedStyle(probe).color;
  probe.remove();
  return found;
}

export interface Result {
  aspect: number;
  pages: number;
  /** Whether faces were turned that the file winds against others. */
  isTurned: boolean;
  /** Whether triangles overlap, or nobody has looked. */
  mayOverlap: boolean;
  /** Whether those of different islands may. */
  ofAny: boolean;
  /** The file that came out, with its materials; absent if it has none, or those that came in. */
  asset?: (() => Promise<Model>) | undefined;
}

/** A skin for the faces of a surface alone. */
const sameFaces = (skin: Skin | undefined, {faces}: Surface) => (skin?.uv.length === 6 * faces ? skin : undefined);

export class Viewing {
  readonly viewer: Viewer;
  /** Another chart is picked, or none. */
  onPicked?: () => void;
  #charts: Chart[] = [];
  #before: Shown | undefined;
  #after: Shown | undefined;
  readonly #onError: (error: unknown) => void;

  constructor(onError: (error: unknown) => void) {
    this.#onError = onError;
    this.viewer = new Viewer($<HTMLCanvasElement>('solid'), $<HTMLCanvasElement>('flat'));
    this.viewer.onPick = (picked) => {
      this.#tellPicked(picked?.island);
      this.onPicked?.();
    };
    $('colouring').addEventListener('change', () => this.#choose().catch(onError));
    $('image').addEventListener('change', () => this.#useImage().catch(onError));
    for (const id of ['show-seams', 'show-wire', 'show-worst', 'show-overlaps']) $(id).addEventListener('change', () => this.#showLines());
    for (const id of ['before', 'after']) $(id).addEventListener('change', () => this.#showVersion());
    $('fit').addEventListener('click', () => {
      this.viewer.solid.fit();
      this.viewer.flat.fit();
    });
    const dark = matchMedia('(prefers-color-scheme: dark)');
    dark.addEventListener('change', () => this.#useTheme());
    this.#useTheme();
    show($('no-webgl'), this.isBlank);
    $('views').classList.toggle('blank', this.isBlank);
  }

  /** Whether this browser cannot draw the views. */
  get isBlank(): boolean {
    return this.viewer.solid.isBlank;
  }

  get #colouring(): Colouring {
    return $<HTMLSelectElement>('colouring').value as Colouring;
  }

  get charts(): Chart[] {
    return this.#charts;
  }

  /** Nothing is shown until there is another mesh. */
  close(): void {
    this.#before = this.#after = undefined;
    show($('views'), false);
  }

  /** A mesh as it came in. */
  open(model: Model): Surface {
    const surface = surfaceOf(model);
    const uv = uvOf(model, 0);
    this.#before = shown(surface, uv && mapped(surface, uv));
    if (model.looks) this.#before.skin = once(() => skinOf(model));
    if (surface.faces <= SEARCHED_FACES) this.#before.overlapping = this.#before.map && overlappingFaces(this.#before.map);
    this.#after = undefined;
    show($('pictures'), false);
    this.#show(this.#before);
    return surface;
  }

  /** What a job made of it; the view stays if it is the same mesh. */
  result(model: Model, {aspect, pages, isTurned, mayOverlap, ofAny, asset}: Result): Shown {
    const last = this.#after ?? this.#before;
    const surface = isSame(last?.surface, model) ? last!.surface : surfaceOf(model);
    const map = mapped(surface, uvOf(model, 0)!, surface === last?.surface ? last.map : undefined);
    this.#after = shown(surface, map, aspect, pages, isTurned);
    const before = this.#before?.skin;
    if (asset ?? before) this.#after.skin = once(async () => sameFaces(await this.#skinOf(asset), surface) ?? sameFaces(await before?.(), surface));
    if (mayOverlap) this.#after.overlapping = overlappingFaces(this.#after.map!, ofAny);
    $<HTMLInputElement>('after').checked = true;
    this.#show(this.#after, surface === last?.surface);
    return this.#after;
  }

  /** The islands of the result are put elsewhere, and keep their shapes. */
  arrange(map: Mapped): void {
    if (!this.#after) return;
    this.#after = {...this.#after, map, overlapping: overlappingFaces(map, true)};
    this.#show(this.#after, true);
  }

  /** The materials of a file; where it cannot be read, that is told. */
  async #skinOf(asset: (() => Promise<Model>) | undefined): Promise<Skin | undefined> {
    try {
      return asset && await skinOf(await asset());
    } catch (error) {
      this.#onError(error);
      return undefined;
    }
  }

  /** Materials can be chosen where there may be some. */
  #offerMaterials({skin}: Shown): void {
    const colourings = $<HTMLSelectElement>('colouring');
    for (const option of colourings.options) if (option.value === 'materials') option.hidden = option.disabled = !skin;
    if (skin || this.#colouring !== 'materials') return;
    colourings.value = 'checker';
    this.viewer.colour('checker');
  }

  #show(what: Shown, keepsView = false): void {
    show($('views'), true);
    this.#offerMaterials(what);
    show($('versions'), Boolean(this.#after && this.#before?.map));
    show($('no-layout'), !what.map);
    this.#charts = chartsOf(what);
    const [worst, other] = this.#charts;
    what.worst = other && worst!.angle + worst!.area - 4 > UNSEEN ? worst!.island : undefined;
    this.viewer.show(what, keepsView);
    this.#tellFaults(what);
    this.#legend();
    this.#showLines();
  }

  #tellFaults({worst, overlapping}: Shown): void {
    const [some, many] = [overlapping?.length ?? 0, worst !== undefined];
    show($('worst-row'), many);
    show($('overlaps-row'), some > 0);
    const chart = `chart ${worst! + 1}`;
    const told = this.isBlank ? `The most distorted one is ${chart}.` : `The frame shows ${chart}, the most distorted one.`;
    const texts = [
      many ? told : '',
      some > 0 ? `${count(some, 'triangle')} ${some === 1 ? 'overlaps' : 'overlap'} others. They are hatched.` : '',
    ];
    $('faults').textContent = texts.filter(Boolean).join(' ');
  }

  #showVersion(): void {
    const what = $<HTMLInputElement>('before').checked ? this.#before : this.#after;
    if (what) this.#show(what, true);
  }

  #showLines(): void {
    const [seams, wire, worst, overlaps] = ['seams', 'wire', 'worst', 'overlaps'].map((what) => $<HTMLInputElement>(`show-${what}`).checked);
    this.viewer.setVisible({seams: seams!, wire: wire!, worst: worst!, overlaps: overlaps!});
  }

  async #choose(): Promise<void> {
    const colouring = this.#colouring;
    show($('image'), colouring === 'image');
    if (colouring === 'image' && $<HTMLInputElement>('image').files?.length === 0) $('image').click();
    this.viewer.colour(colouring);
    this.#legend();
  }

  async #useImage(): Promise<void> {
    const file = $<HTMLInputElement>('image').files?.[0];
    if (file) this.viewer.showImage(await imageTexture(file));
  }

  #legend(): void {
    const scale = SCALES[this.#colouring];
    show($('legend'), Boolean(scale && this.viewer.what?.map));
    if (!scale) return;
    const bar = document.createElementNS('http://www.w3.org/2000/svg', 'svg');
    bar.setAttribute('viewBox', `0 0 ${scale.colours.length} 1`);
    bar.setAttribute('preserveAspectRatio', 'none');
    bar.setAttribute('aria-hidden', 'true');
    scale.colours.forEach((hex, x) => {
      const square = document.createElementNS('http://www.w3.org/2000/svg', 'rect');
      for (const [name, value] of Object.entries({x, width: 1.02, height: 1, fill: `#${hex}`})) square.setAttribute(name, String(value));
      bar.append(square);
    });
    $('legend').replaceChildren(bar, el('span', {}, `${scale.ticks.join(' · ')}; 1 is ideal. Flipped triangles are red.`));
  }

  #tellPicked(island: number | undefined): void {
    const chart = this.#charts.find((one) => one.island === island);
    $('picked').textContent = chart ? `Chart ${chart.island + 1} of ${this.#charts.length}: ${describe(chart)}.` : '';
  }

  #useTheme(): void {
    this.viewer.setTheme({background: resolved('--soft'), line: resolved('--faint'), seam: resolved('--bad'), mark: resolved('--accent'), pin: resolved('--edit'), frame: resolved('--text')});
  }
}

/** Whether a model has the faces of a surface at the same places. */
function isSame(surface: Surface | undefined, model: Model): boolean {
  if (!surface) return false;
  let f = 0;
  for (const [number, {faces, positions, places}] of model.parts.entries())
    for (const place of places) {
      for (let i = 0; i < faces.length / 3; i += 1, f += 1) {
        if (surface.part[f] !== number || surface.faceInPart[f] !== i) return false;
        const v = 3 * faces[3 * i]!;
        const x = place[0]! * positions[v]! + place[4]! * positions[v + 1]! + place[8]! * positions[v + 2]! + place[12]!;
        if (Math.abs(surface.positions[9 * f]! - x) > 1e-4 * (1 + Math.abs(x))) return false;
      }
    }
  return f === surface.faces;
}
