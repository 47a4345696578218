// Islands that are locked in the layout, and the others packed again around them. What is packed is
// the file of the result: it is opened in place of the mesh, with the locks as they were.
import {$} from '../base/dom.js';
import {withoutExtension} from '../base/words.js';
import {type Opened, open} from '../files/read.js';
import type {OptionValues} from '../job/run.js';
import {getBlob} from '../job/server.js';
import {type Kept, formatOf} from '../result/downloads.js';
import {ofLambda} from '../result/load.js';
import type {Arranging} from './arranging.js';
import type {Session} from './session.js';

/** Options of the form that are about packing islands that there are. */
const OF_PACKING = ['preset', 'padding', 'max_pages', 'rotation', 'effort', 'output', 'compression', 'draco_bits'];

/** The result as a file of the page. An OBJ stays one; anything else is a GLB, which has all of it in one file. */
async function fileOf({job, lambda, name, report}: Kept): Promise<Opened> {
  const isObj = formatOf(name, report.options.output) === 'obj';
  const blob = await getBlob(job.links.result + ofLambda(lambda), isObj ? 'model/obj' : 'model/gltf-binary');
  return open([{name: `${withoutExtension(name)}.${isObj ? 'obj' : 'glb'}`, blob}]);
}

export class Packing {
  readonly #arranging: Arranging;
  readonly #session: Session;
  /** What is chosen in the form. */
  chosen: () => OptionValues = () => ({});
  /** Opens the file of a result. */
  onOpen?: (opened: Opened) => void;
  /** The options of a packing that begins. */
  onPack?: (options: OptionValues) => void;
  #staying: number[] | undefined; // while a packing runs

  constructor(arranging: Arranging, session: Session, onError: (error: unknown) => void) {
    [this.#arranging, this.#session] = [arranging, session];
    $('pack-again').addEventListener('click', () => this.#pack().catch(onError));
  }

  reset(): void {
    this.#staying = undefined;
    this.#arranging.reset();
  }

  /** Another result is shown: that of a packing has its islands where they are locked. */
  ready(): void {
    if (this.#staying) $<HTMLInputElement>('edit-islands').click();
    this.#arranging.reset(this.#staying);
    this.#staying = undefined;
  }

  async #pack(): Promise<void> {
    const {kept} = this.#session;
    if (!kept || !this.#arranging.map) return;
    const {locks} = this.#arranging;
    const locked = locks.asOption(kept.what.surface);
    const {width, height} = kept.report.page;
    const chosen = Object.entries(this.chosen()).filter(([name]) => OF_PACKING.includes(name));
    const set = kept.report.texcoord > 0 ? {texcoord: kept.report.texcoord} : {};
    const options = {...Object.fromEntries(chosen), ...set, width, height, repack_only: true, ...(locked.length > 0 ? {locked_islands: locked} : {})};
    const opened = await fileOf(kept);
    const {faces} = locks;
    this.onOpen?.(opened);
    this.#staying = faces;
    this.onPack?.(options);
  }
}
