// The map follows the slider of λ, and pins that are dragged: jobs of the mesh that is already there,
// with its charts kept. One at a time; of the moves meanwhile the latest counts.
import {$} from '../base/dom.js';
import {fixed} from '../base/words.js';
import {Latest} from '../edit/latest.js';
import {type Job, type OptionValues, UnwrapdError, cancel, ended} from '../job/run.js';
import {loadDraft, loadResult} from '../result/load.js';
import type {Session} from './session.js';

/** Iterations of a map that is shown while the slider moves: no more can be told by the eye. */
const DRAFT = {guarantee: 'none', stop: {iterations: 10}};

/** The file that is read the fastest. */
const PLAIN = {output: 'glb', compression: 'none'};

interface Wanted {
  options: OptionValues;
  label: string;
  isDraft: boolean;
  since: number;
}

/** The picture that was asked for is drawn; pages in the background draw none. */
function drawn(): Promise<void> {
  return new Promise((resolve) => {
    requestAnimationFrame(() => requestAnimationFrame(() => resolve()));
    setTimeout(resolve, 500);
  });
}

export class Balancing {
  readonly #session: Session;
  #generation = 0;
  readonly #latest = new Latest<Wanted>((wanted) => this.#solve(wanted));

  constructor(session: Session) {
    this.#session = session;
  }

  get isPossible(): boolean {
    return Boolean(this.#session.sent && this.#session.loaded);
  }

  /** Whether files of the mesh are small: they have no images in them. */
  get #isLight(): boolean {
    return !this.#session.opened?.model.looks?.some(({image}) => image);
  }

  /** A map for these options soon. Drafts are removed from the server once they are shown, or not wanted any more. */
  ask(options: OptionValues, label: string, isDraft: boolean): void {
    if (!this.isPossible) return;
    this.#latest.ask({options: isDraft ? {...options, ...DRAFT, ...(this.#isLight ? PLAIN : {})} : options, label, isDraft, since: performance.now()});
  }

  /** Another mesh or another job: what was asked for of the last is not wanted any more. */
  reset(): void {
    this.#generation += 1;
    this.#latest.drop();
    $('live').textContent = '';
  }

  async #solve(wanted: Wanted): Promise<void> {
    const {sent} = this.#session;
    if (!sent) return;
    const generation = this.#generation;
    const isCurrent = () => generation === this.#generation && sent === this.#session.sent;
    try {
      const watcher = {signal: new AbortController().signal, wait: 10};
      const job = await sent.submit(wanted.options, watcher);
      try {
        await this.#show(await ended(job, watcher), wanted, isCurrent);
      } finally {
        if (wanted.isDraft) cancel(job).catch(() => {}); // the next one need not wait for it
      }
    } catch (error) {
      if (isCurrent()) $('live').textContent = `${wanted.label}: ${error instanceof UnwrapdError ? error.detail : String(error)}`;
    }
  }

  async #show(job: Job, {options, label, isDraft, since}: Wanted, isCurrent: () => boolean): Promise<void> {
    const {opened} = this.#session;
    const isWanted = () => isCurrent() && !this.#session.isBusy; // nothing else was begun
    if (job.problem) throw new UnwrapdError(job.problem);
    if (!isWanted()) return;
    const loaded = isDraft && this.#isLight ? await loadDraft(job) : await loadResult(job, undefined, opened!.model);
    if (!isWanted()) return;
    if (!isDraft) this.#session.asked.set(job.id, {options});
    this.#session.take(job, loaded, undefined, opened!.name, isDraft ? 'draft' : 'live');
    const {angle, area} = loaded.report.distortion;
    await drawn();
    if (!isWanted()) return;
    const line = $('live');
    line.dataset['ms'] = String(Math.round(performance.now() - since));
    line.textContent = `${label}: angles ${fixed(angle, 3)}, areas ${fixed(area, 3)}${isDraft ? ' (draft)' : ''}.`;
  }
}
