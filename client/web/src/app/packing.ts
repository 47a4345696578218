// The islands of a result packed again around those that are locked or were moved: a job of the result's
// file. The mesh that is open stays so.
import {$} from '../base/dom.js';
import {withoutExtension} from '../base/words.js';
import {type OptionValues, SentMesh} from '../job/run.js';
import {getBlob} from '../job/server.js';
import {type Kept, formatOf} from '../result/downloads.js';
import {ofLambda} from '../result/load.js';
import type {Arranging} from './arranging.js';
import {showMessage} from './problem.js';
import type {Session} from './session.js';

/** Options of the form that are about packing islands that there are. */
const OF_PACKING = ['preset', 'padding', 'max_pages', 'rotation', 'effort', 'output', 'compression', 'draco_bits'];

/** Everything but an OBJ is sent as a GLB, which has all of it in one file. */
async function fileOf({job, lambda, name, report}: Kept): Promise<{file: SentMesh; name: string}> {
  const [ending, type] = formatOf(name, report.options.output) === 'obj' ? ['obj', 'model/obj'] : ['glb', 'model/gltf-binary'];
  const own = `${withoutExtension(name)}.uv.${ending}`;
  return {file: new SentMesh(await getBlob(job.links.result + ofLambda(lambda), type), type, own), name: own};
}

export class Packing {
  readonly #arranging: Arranging;
  readonly #session: Session;
  /** What is chosen in the form. */
  chosen: () => OptionValues = () => ({});
  #staying: number[] = []; // in the result that comes

  constructor(arranging: Arranging, session: Session, onError: (error: unknown) => void) {
    [this.#arranging, this.#session] = [arranging, session];
    $('pack-again').addEventListener('click', () => this.#pack().catch(onError));
  }

  /** Another result is shown: that of a packing has its islands where they are to stay. */
  ready(): void {
    this.#arranging.reset(this.#staying);
    this.#staying = [];
  }

  /** The set and the images that the result has are written anew. */
  #optionsFor({report, what}: Kept): OptionValues {
    const chosen = Object.entries(this.chosen()).filter(([name]) => OF_PACKING.includes(name));
    const locked = this.#arranging.locks.asOption(what.surface);
    const {width, height} = report.page;
    const isTransferred = report.options.textures === 'transfer';
    return {
      ...Object.fromEntries(chosen), width, height, repack_only: true, texcoord: report.texcoord,
      ...(isTransferred ? {textures: 'transfer'} : {}), ...(locked.length > 0 ? {locked_islands: locked} : {}),
    };
  }

  async #pack(): Promise<void> {
    const {kept} = this.#session;
    if (!kept || !this.#arranging.map) return;
    const {beyond, locks} = this.#arranging;
    if (beyond.length > 0) return showMessage('An island lies beyond the page', `Move ${beyond.join(', ')} onto the page, or put it back.`);
    const options = this.#optionsFor(kept);
    const {faces} = locks;
    const {file, name} = await fileOf(kept);
    if (kept !== this.#session.kept) return;
    await this.#session.repack(file, options, name, () => (this.#staying = faces));
  }
}
