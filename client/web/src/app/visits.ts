// What the entries of the browser's history are about: Back and Forward lead to the mesh and the job that
// were open. A reload forgets meshes, and keeps the addresses of jobs.
import {type Place, hashOf, placeOf} from '../base/permalink.js';
import type {Opened} from '../files/read.js';

const KEPT_MESHES = 4; // they are large: beyond them Back leads to the job alone

export interface Visit {
  opened: Opened | undefined;
  place: Place | undefined;
}

export class Visits {
  readonly #meshes = new Map<string, Opened>();
  /** What the page was led to last. */
  #at: Visit = {opened: undefined, place: undefined};
  #address = location.href;
  #state: unknown = history.state;

  /** What another entry than the last is about; undefined if nothing is to be shown anew. */
  arrive(): (Visit & {isForgotten: boolean}) | undefined {
    const place = placeOf(location.hash);
    if (!place && location.hash) { // it names no job, so it is no place of its own
      history.replaceState(this.#state, '', this.#address);
      return undefined;
    }
    const opened = this.#meshes.get(history.state?.mesh);
    const isSame = opened === this.#at.opened && place?.job === this.#at.place?.job;
    this.#settle(opened, place);
    return isSame ? undefined : {opened, place, isForgotten: Boolean(history.state?.mesh) && !opened && !place};
  }

  /** A mesh was opened. */
  enterMesh(opened: Opened): void {
    const mesh = crypto.randomUUID?.() ?? String(Math.random());
    this.#meshes.set(mesh, opened);
    if (this.#meshes.size > KEPT_MESHES) this.#meshes.delete(this.#meshes.keys().next().value!);
    history.pushState({mesh}, '', location.pathname + location.search);
    this.#settle(opened, undefined);
  }

  /** The page is about a job now, of the mesh that is open. */
  enterJob(place: Place): void {
    if (placeOf(location.hash)?.job === place.job) return this.changeJob(place);
    history.pushState(history.state, '', hashOf(place));
    this.#settle(this.#at.opened, place);
  }

  /** As enterJob(), where Back need not lead to what was before. */
  changeJob(place: Place): void {
    history.replaceState(history.state, '', hashOf(place));
    this.#settle(this.#at.opened, place);
  }

  #settle(opened: Opened | undefined, place: Place | undefined): void {
    this.#at = {opened, place};
    [this.#address, this.#state] = [location.href, history.state];
  }
}
