// Islands that are locked in the layout, and the others packed again around them. What is packed is
// the file of the result: it is opened in place of the mesh, with the locks as they were.
import {$, announce} from '../base/dom.js';
import {count, withoutExtension} from '../base/words.js';
import {Locks} from '../edit/locks.js';
import {type Opened, open} from '../files/read.js';
import type {OptionValues} from '../job/run.js';
import {getBlob} from '../job/server.js';
import {type Kept, formatOf} from '../result/downloads.js';
import {ofLambda} from '../result/load.js';
import type {Session} from './session.js';
import type {Viewing} from './viewing.js';

/** Options of the form that are about packing islands that there are. */
const OF_PACKING = ['preset', 'padding', 'max_pages', 'rotation', 'effort', 'output', 'compression', 'draco_bits'];

/** The result as a file of the page. An OBJ stays one; anything else is a GLB, which has all of it in one file. */
async function fileOf({job, lambda, name, report}: Kept): Promise<Opened> {
  const isObj = formatOf(name, report.options.output) === 'obj';
  const blob = await getBlob(job.links.result + ofLambda(lambda), isObj ? 'model/obj' : 'model/gltf-binary');
  return open([{name: `${withoutExtension(name)}.${isObj ? 'obj' : 'glb'}`, blob}]);
}

export class Packing {
  readonly #viewing: Viewing;
  readonly #session: Session;
  readonly #locks = new Locks();
  /** What is chosen in the form. */
  chosen: () => OptionValues = () => ({});
  /** Opens the file of a result. */
  onOpen?: (opened: Opened) => void;
  /** The options of a packing that begins. */
  onPack?: (options: OptionValues) => void;
  #staying: number[] | undefined; // while a packing runs

  constructor(viewing: Viewing, session: Session, onError: (error: unknown) => void) {
    [this.#viewing, this.#session] = [viewing, session];
    const onClick = (id: string, action: () => void) => $(id).addEventListener('click', () => {
      action();
      this.draw();
    });
    onClick('lock-all', () => this.#map && this.#locks.lockAll(this.#map));
    onClick('unlock-all', () => this.#locks.clear());
    viewing.viewer.onShow = () => this.draw();
    $('pack-again').addEventListener('click', () => this.#pack().catch(onError));
    for (const {canvas} of [viewing.viewer.solid, viewing.viewer.flat])
      canvas.addEventListener('keydown', ({key, ctrlKey, metaKey, altKey}) => {
        if (key.toLowerCase() === 'l' && !ctrlKey && !metaKey && !altKey) this.toggle(viewing.viewer.selected?.island);
      });
  }

  /** The map of the result, while it is shown. */
  get #map() {
    const map = this.#viewing.viewer.what?.map;
    return map === this.#session.kept?.what.map ? map : undefined;
  }

  reset(): void {
    this.#staying = undefined;
    this.#locks.clear();
    this.draw();
  }

  /** Another result is shown: that of a packing has its islands where they are locked. */
  ready(): void {
    if (this.#staying) $<HTMLInputElement>('edit-islands').click();
    this.#locks.faces = this.#staying ?? [];
    this.#staying = undefined;
    this.draw();
  }

  toggle(island: number | undefined): void {
    const map = this.#map;
    if (!map || island === undefined) return announce('Pick a chart of a result first.');
    announce(`Chart ${island + 1} is ${this.#locks.toggle(island, map) ? 'locked' : 'unlocked'}.`);
    this.draw();
  }

  draw(): void {
    const map = this.#map;
    this.#viewing.viewer.showLocked(map ? this.#locks.islands(map) : new Set());
    $('lock-count').textContent = map ? `${count(this.#locks.count, 'island')} of ${map.islandCount} locked.` : '';
  }

  async #pack(): Promise<void> {
    const {kept} = this.#session;
    const map = this.#map;
    if (!kept || !map) return;
    const locked = this.#locks.asOption(kept.what.surface);
    const {width, height} = kept.report.page;
    const chosen = Object.entries(this.chosen()).filter(([name]) => OF_PACKING.includes(name));
    const set = kept.report.texcoord > 0 ? {texcoord: kept.report.texcoord} : {};
    const options = {...Object.fromEntries(chosen), ...set, width, height, repack_only: true, ...(locked.length > 0 ? {locked_islands: locked} : {})};
    const opened = await fileOf(kept);
    const faces = this.#locks.faces;
    this.onOpen?.(opened);
    this.#staying = faces;
    this.onPack?.(options);
  }
}
