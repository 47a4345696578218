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

  /** The entry of now. */
  get here(): Visit {
    return {opened: this.#meshes.get(history.state?.mesh), place: placeOf(location.hash)};
  }

  /** A mesh was opened. */
  enterMesh(opened: Opened): void {
    const mesh = crypto.randomUUID?.() ?? String(Math.random());
    this.#meshes.set(mesh, opened);
    if (this.#meshes.size > KEPT_MESHES) this.#meshes.delete(this.#meshes.keys().next().value!);
    history.pushState({mesh}, '', location.pathname + location.search);
  }

  /** The page is about a job now, of the mesh that is open. */
  enterJob(place: Place): void {
    if (placeOf(location.hash)?.job === place.job) this.changeJob(place);
    else history.pushState(history.state, '', hashOf(place));
  }

  /** As enterJob(), where Back need not lead to what was before. */
  changeJob(place: Place): void {
    history.replaceState(history.state, '', hashOf(place));
  }
}
