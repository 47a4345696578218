// A job of a mesh, from its bytes to its end.
import {jsonOf, patiently} from '../../../js/src/connection.js';
import {UnwrapdError} from '../../../js/src/error.js';
import {type Progress, follow} from '../../../js/src/job.js';
import type {Job} from '../../../js/src/types.js';
import {connection, request} from './server.js';
import {sha256} from './sha256.js';
import {type Uploaded, upload} from './upload.js';

export type {Job, JobEvent, Report, Result} from '../../../js/src/types.js';
export type {Progress} from '../../../js/src/job.js';
export {UnwrapdError} from '../../../js/src/error.js';

/** Options as JSON, nested as the API has them. */
export type OptionValues = {[name: string]: unknown};

export interface Watcher {
  onSent?: (share: number) => void;
  onProgress?: (progress: Progress) => void;
  signal: AbortSignal;
  /** Seconds for which the answer to the submission may wait for the job's end. */
  wait?: number;
}

/** The name of a file as the API takes it for the name of a job. */
function plainLine(name: string): string {
  return [...name.replace(/[\u0000-\u001f\u007f-\u009f\u2028-\u202e\u2066-\u2069]/g, ' ')].slice(0, 200).join('');
}

/** A mesh that is sent once, however many jobs it has. */
export class SentMesh {
  readonly #blob: Blob;
  readonly #mediaType: string;
  readonly #name: string;
  #sent: Promise<Uploaded> | undefined;
  #isThere = false;

  constructor(blob: Blob, mediaType: string, name: string) {
    this.#blob = blob;
    this.#mediaType = mediaType;
    this.#name = plainLine(name);
  }

  /** Makes a job. The server may have dropped the mesh, which is then sent again. */
  async submit(options: OptionValues, watcher: Watcher): Promise<Job> {
    const mesh = await (this.#sent ??= sha256(this.#blob).then((digest) => ({blob: this.#blob, mediaType: this.#mediaType, sha256: digest})));
    const wasThere = this.#isThere;
    if (!wasThere) await patiently(connection(watcher.signal), () => upload(mesh, watcher.onSent ?? (() => {}), watcher.signal));
    this.#isThere = true;
    try {
      return await submitJob(mesh.sha256, this.#name, options, watcher);
    } catch (error) {
      if (!wasThere || !(error instanceof UnwrapdError && error.code === 'mesh_not_found')) throw error;
      this.#isThere = false;
      return this.submit(options, watcher);
    }
  }
}

function submitJob(digest: string, name: string, options: OptionValues, {signal, wait}: Watcher): Promise<Job> {
  const here = connection(signal);
  const key = Array.from(crypto.getRandomValues(new Uint32Array(4)), (word) => word.toString(36)).join('-');
  const headers = {'Content-Type': 'application/json', 'Idempotency-Key': key, ...(wait ? {Prefer: `wait=${wait}`} : {})};
  const init = {method: 'POST', headers, body: JSON.stringify(options)};
  const path = `/v1/meshes/${digest}/jobs?${new URLSearchParams({name})}`;
  return patiently(here, async () => jsonOf<Job>(here, await request(path, init, signal)));
}

export const hasEnded = ({state}: Job) => ['succeeded', 'failed', 'cancelled'].includes(state);

/** Follows a job to its end. */
export async function ended(job: Job, watcher: Watcher): Promise<Job> {
  return hasEnded(job) ? job : follow(job, {...connection(watcher.signal), onProgress: watcher.onProgress});
}

/** Asks the server to stop a job. */
export async function cancel(job: Job): Promise<void> {
  await request(job.links.self, {method: 'DELETE'});
}
