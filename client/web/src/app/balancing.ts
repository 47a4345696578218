// The map follows the slider of λ, and pins that are dragged: jobs of the mesh that is already there,
// with its charts kept. One at a time; of the moves meanwhile the latest counts.
import {$} from '../base/dom.js';
import {fixed} from '../base/words.js';
import {Latest} from '../edit/latest.js';
import {type OptionValues, UnwrapdError, cancel, ended} from '../job/run.js';
import {loadResult} from '../result/load.js';
import type {Session} from './session.js';

/** Iterations of a map that is shown while the slider moves: no more can be told by the eye. */
const DRAFT = {guarantee: 'none', stop: {iterations: 10}};

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
  readonly #latest = new Latest<Wanted>((wanted) => this.#solve(wanted));

  constructor(session: Session) {
    this.#session = session;
  }

  get isPossible(): boolean {
    return Boolean(this.#session.sent && this.#session.loaded);
  }

  /** A map for these options soon. Drafts are removed from the server once they are shown. */
  ask(options: OptionValues, label: string, isDraft: boolean): void {
    if (!this.isPossible) return;
    this.#latest.ask({options: isDraft ? {...options, ...DRAFT} : options, label, isDraft, since: performance.now()});
  }

  async #solve({options, label, isDraft, since}: Wanted): Promise<void> {
    const {sent, opened} = this.#session;
    const line = $('live');
    if (!sent || !opened) return;
    try {
      const watcher = {signal: new AbortController().signal, wait: 10};
      const job = await ended(await sent.submit(options, watcher), watcher);
      if (job.problem) throw new UnwrapdError(job.problem);
      const loaded = await loadResult(job, undefined, opened.model);
      if (sent !== this.#session.sent || this.#session.isBusy) return; // something else was begun
      this.#session.take(job, loaded, undefined, opened.name, isDraft ? 'draft' : 'live');
      const {angle, area} = loaded.report.distortion;
      await drawn();
      line.dataset['ms'] = String(Math.round(performance.now() - since));
      line.textContent = `${label}: angles ${fixed(angle, 3)}, areas ${fixed(area, 3)}${isDraft ? ' (draft)' : ''}.`;
      if (isDraft) await cancel(job).catch(() => {});
    } catch (error) {
      line.textContent = error instanceof UnwrapdError ? `${label}: ${error.detail}` : `${label}: ${String(error)}`;
    }
  }
}
