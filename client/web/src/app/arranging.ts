// Islands of the layout that are put where they are wanted, by dragging or by numbers, and locked there.
import {$, announce, show} from '../base/dom.js';
import {count} from '../base/words.js';
import {Locks} from '../edit/locks.js';
import {AT_REST, type Motion, isAtRest, middleOf} from '../edit/motion.js';
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

export class Arranging {
  readonly locks = new Locks();
  readonly #viewing: Viewing;
  readonly #session: Session;
  #arranged: Mapped | undefined;
  #drag: Drag | undefined;

  constructor(viewing: Viewing, session: Session) {
    [this.#viewing, this.#session] = [viewing, session];
    viewing.viewer.onShow = () => this.draw();
    const onClick = (id: string, action: () => void) => $(id).addEventListener('click', action);
    onClick('lock-all', () => this.#change((map) => this.locks.lockAll(map)));
    onClick('unlock-all', () => this.#change(() => this.locks.clear()));
    onClick('island-back', () => this.#put(AT_REST));
    for (const what of ['u', 'v', 'turn'] as const) fieldOf(what).addEventListener('change', () => this.#putByFields());
    for (const {canvas} of [viewing.viewer.solid, viewing.viewer.flat])
      canvas.addEventListener('keydown', ({key, ctrlKey, metaKey, altKey}) => {
        if (key.toLowerCase() === 'l' && !ctrlKey && !metaKey && !altKey) this.toggle(viewing.viewer.selected?.island);
      });
    viewing.onPicked = () => this.#showFields();
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
    this.locks.faces = faces;
    this.draw();
  }

  toggle(island: number | undefined): void {
    if (!this.map || island === undefined) return announce('Pick a chart of a result first.');
    const isLocked = this.#change((map) => this.locks.toggle(island, map));
    this.#viewing.viewer.selectIsland(island);
    announce(`Chart ${island + 1} is ${isLocked ? 'locked' : 'unlocked'}.`);
  }

  /** A drag begins at a point of the page. */
  grab(island: number | undefined, at: [number, number], turns: boolean): boolean {
    const map = this.map;
    if (!map || island === undefined) return false;
    const motion = this.locks.motionOf(island, map);
    const faces = [...map.island.keys()].filter((f) => map.island[f] === island);
    this.#drag = {island, from: at, motion, turns, middle: middleOf(faces, this.#viewing.viewer.what!.map!.uv), hasBegun: false};
    return true;
  }

  drag(at: [number, number], ends: boolean): void {
    const [drag, map, {flat}] = [this.#drag, this.map, this.#viewing.viewer];
    if (!drag || !map) return;
    const aspect = this.#viewing.viewer.what!.aspect;
    const [u, v] = [at[0] - drag.from[0], at[1] - drag.from[1]];
    drag.hasBegun ||= Math.hypot(u * aspect, v) > flat.lengthOf(SLACK);
    if (drag.hasBegun) this.locks.put(drag.island, map, this.#dragged(drag, at, aspect));
    if (!ends) return drag.hasBegun ? this.#viewing.viewer.showLocked(this.locks.islands(map), this.locks.arranged(map, aspect)) : undefined;
    this.#drag = undefined;
    if (!drag.hasBegun) return;
    this.#show();
    this.#viewing.viewer.selectIsland(drag.island);
  }

  #dragged({from, motion, turns, middle}: Drag, at: [number, number], aspect: number): Motion {
    if (!turns) return {...motion, move: [rounded(motion.move[0] + at[0] - from[0], 4), rounded(motion.move[1] + at[1] - from[1], 4)]};
    const angle = ([u, v]: [number, number]) => (Math.atan2(v - middle[1], (u - middle[0]) * aspect) / Math.PI) * 180;
    return {...motion, turn: rounded(((motion.turn + angle(at) - angle(from) + 540) % 360) - 180, 2)};
  }

  #change<T>(action: (map: Mapped) => T): T | undefined {
    const map = this.map;
    const result = map && action(map);
    this.#show();
    return result;
  }

  /** Puts the chart that is picked somewhere. */
  #put(motion: Motion): void {
    const island = this.#viewing.viewer.selected?.island;
    if (island === undefined || !this.map) return;
    this.#change((map) => this.locks.put(island, map, motion));
    this.#viewing.viewer.selectIsland(island);
  }

  #putByFields(): void {
    const [u, v, turn] = [fieldOf('u'), fieldOf('v'), fieldOf('turn')].map(({valueAsNumber}) => valueAsNumber || 0);
    this.#put({turn: turn!, move: [u!, v!]});
  }

  /** Shows the islands where they were put. */
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
    const {selected} = this.#viewing.viewer;
    const map = this.map;
    const island = map && selected?.island;
    show($('island-place'), island !== undefined);
    if (island === undefined) return;
    const {turn, move: [u, v]} = this.locks.motionOf(island, map!);
    $('island-name').textContent = `Chart ${island + 1}`;
    fieldOf('u').value = String(u);
    fieldOf('v').value = String(v);
    fieldOf('turn').value = String(turn);
    $<HTMLButtonElement>('island-back').disabled = isAtRest({turn, move: [u, v]});
  }

  draw(): void {
    const map = this.map;
    this.#viewing.viewer.showLocked(map ? this.locks.islands(map) : new Set());
    const {count: locked, movedCount: moved} = this.locks;
    const waits = moved > 0 ? ` ${count(moved, 'island')} ${moved === 1 ? 'lies' : 'lie'} elsewhere. Pack again writes it.` : '';
    $('lock-count').textContent = map ? `${count(locked, 'island')} of ${map.islandCount} locked.${waits}` : '';
    this.#showFields();
  }
}
