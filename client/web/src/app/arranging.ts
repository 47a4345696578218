// Islands of the layout that are moved by dragging or by numbers, or locked where they are.
import {$, announce, show} from '../base/dom.js';
import {count} from '../base/words.js';
import {Locks} from '../edit/locks.js';
import {AT_REST, type Motion, boxOf, isAtRest, isOnPage, middleOf} from '../edit/motion.js';
import type {Mapped} from '../mesh/islands.js';
import type {Session} from './session.js';
import type {Viewing} from './viewing.js';

const SLACK = 4; // pixels by which a click may move

interface Drag {
  island: number;
  from: [number, number];
  motion: Motion;
  turns: boolean;
  /** About which it turns. */
  middle: [number, number];
  hasBegun: boolean;
}

/** To as many decimals as the fields show. */
const rounded = (value: number, decimals: number) => Number(value.toFixed(decimals));

const fieldOf = (what: 'u' | 'v' | 'turn') => $<HTMLInputElement>(`island-${what}`);

const facesOf = (island: number, {island: of}: Mapped) => [...of.keys()].filter((f) => of[f] === island);

export class Arranging {
  readonly locks = new Locks();
  /** How many pages there may be. */
  pages: () => number = () => 1;
  readonly #viewing: Viewing;
  readonly #session: Session;
  #arranged: Mapped | undefined;
  #drag: Drag | undefined;

  constructor(viewing: Viewing, session: Session) {
    [this.#viewing, this.#session] = [viewing, session];
    viewing.viewer.onShow = () => this.draw();
    viewing.onPicked = () => this.#showFields();
    $('lock-all').addEventListener('click', () => this.#change((map) => this.locks.lockAll(map)));
    $('unlock-all').addEventListener('click', () => this.#change(() => this.locks.unlockAll()));
    $('island-back').addEventListener('click', () => this.#move(AT_REST));
    $('island-locked').addEventListener('change', () => this.toggle(viewing.viewer.selected?.island));
    for (const what of ['u', 'v', 'turn'] as const) fieldOf(what).addEventListener('change', () => this.#moveByFields());
    for (const {canvas} of [viewing.viewer.solid, viewing.viewer.flat])
      canvas.addEventListener('keydown', ({key, ctrlKey, metaKey, altKey}) => {
        if (key.toLowerCase() === 'l' && !ctrlKey && !metaKey && !altKey) this.toggle(viewing.viewer.selected?.island);
      });
  }

  /** The map of the result as it is, while it or what is arranged of it is shown. */
  get map(): Mapped | undefined {
    const shown = this.#viewing.viewer.what?.map;
    const map = this.#session.kept?.what.map;
    return shown && (shown === map || shown === this.#arranged) ? map : undefined;
  }

  /** faces: those whose islands are locked from the start. */
  reset(faces: number[] = []): void {
    this.#arranged = this.#drag = undefined;
    this.locks.reset(faces);
    this.draw();
  }

  toggle(island: number | undefined): void {
    const map = this.map;
    if (!map || island === undefined) return announce('Pick a chart of a result first.');
    this.#change(() => this.locks.toggle(island, map));
    announce(`Chart ${island + 1} is ${this.locks.isLocked(island, map) ? 'locked' : 'unlocked'}.`);
  }

  /** A drag begins at a point of the page. */
  grab(island: number | undefined, at: [number, number], turns: boolean): boolean {
    const map = this.map;
    if (!map || island === undefined) return false;
    const middle = middleOf(facesOf(island, map), this.#viewing.viewer.what!.map!.uv);
    this.#drag = {island, from: at, motion: this.locks.motionOf(island, map), turns, middle, hasBegun: false};
    return true;
  }

  drag(at: [number, number], ends: boolean): void {
    const {viewer} = this.#viewing;
    const [drag, map] = [this.#drag, this.map];
    if (!drag || !map) return;
    const {aspect} = viewer.what!;
    drag.hasBegun ||= Math.hypot((at[0] - drag.from[0]) * aspect, at[1] - drag.from[1]) > viewer.flat.lengthOf(SLACK);
    if (ends) this.#drag = undefined;
    if (!drag.hasBegun) return;
    this.locks.move(drag.island, map, dragged(drag, at, aspect));
    if (!ends) return viewer.showLocked(this.locks.islands(map), this.locks.arranged(map, aspect));
    this.#show();
    viewer.selectIsland(drag.island);
  }

  /** The names of charts that were moved off the pages. */
  get beyond(): string[] {
    const map = this.map;
    if (!map || this.locks.movedCount === 0) return [];
    const {uv} = this.#arranged ?? map;
    const pages = this.pages();
    return this.locks.movedIslands(map).filter((island) => !isOnPage(boxOf(facesOf(island, map), uv), pages)).map((island) => `Chart ${island + 1}`);
  }

  #change(action: (map: Mapped) => void): void {
    const map = this.map;
    if (map) action(map);
    this.#show();
  }

  /** Moves the chart that is picked. */
  #move(motion: Motion): void {
    const island = this.#viewing.viewer.selected?.island;
    if (island === undefined) return;
    this.#change((map) => this.locks.move(island, map, motion));
    this.#viewing.viewer.selectIsland(island);
  }

  #moveByFields(): void {
    const [u, v, turn] = (['u', 'v', 'turn'] as const).map((what) => {
      const field = fieldOf(what);
      return Math.min(Math.max(field.valueAsNumber || 0, Number(field.min)), Number(field.max));
    });
    this.#move({turn: turn!, move: [u!, v!]});
  }

  /** Shows the islands where they were moved. */
  #show(): void {
    const map = this.map;
    if (!map) return;
    const arranged = this.locks.arranged(map, this.#viewing.viewer.what!.aspect);
    const isOther = arranged !== this.#viewing.viewer.what!.map;
    this.#arranged = arranged;
    if (isOther) this.#viewing.arrange(arranged);
    this.draw();
  }

  #showFields(): void {
    const map = this.map;
    const island = map && this.#viewing.viewer.selected?.island;
    show($('island-place'), island !== undefined);
    if (island === undefined) return;
    const motion = this.locks.motionOf(island, map!);
    $('island-name').textContent = `Chart ${island + 1}`;
    fieldOf('u').value = String(motion.move[0]);
    fieldOf('v').value = String(motion.move[1]);
    fieldOf('turn').value = String(motion.turn);
    $<HTMLInputElement>('island-locked').checked = this.locks.isLocked(island, map!);
    $<HTMLButtonElement>('island-back').disabled = isAtRest(motion);
  }

  draw(): void {
    const map = this.map;
    this.#viewing.viewer.showLocked(map ? this.locks.islands(map) : new Set());
    for (const id of ['pack-again', 'lock-all', 'unlock-all']) $<HTMLButtonElement>(id).disabled = !map;
    $('lock-count').textContent = map ? this.#told(map) : 'Show the result to arrange its islands.';
    this.#showFields();
  }

  #told({islandCount}: Mapped): string {
    const {lockedCount, movedCount} = this.locks;
    const {beyond} = this;
    return [
      `${count(lockedCount, 'island')} of ${islandCount} locked.`,
      movedCount > 0 ? `${count(movedCount, 'island')} moved. Downloads have the old places until you pack again.` : '',
      beyond.length > 0 ? `${beyond.join(', ')} ${beyond.length === 1 ? 'lies' : 'lie'} beyond the page.` : '',
    ].filter(Boolean).join(' ');
  }
}

function dragged({from, motion, turns, middle}: Drag, at: [number, number], aspect: number): Motion {
  if (!turns) return {...motion, move: [rounded(motion.move[0] + at[0] - from[0], 4), rounded(motion.move[1] + at[1] - from[1], 4)]};
  const angle = ([u, v]: [number, number]) => (Math.atan2(v - middle[1], (u - middle[0]) * aspect) / Math.PI) * 180;
  return {...motion, turn: rounded(((motion.turn + angle(at) - angle(from) + 540) % 360) - 180, 2)};
}
