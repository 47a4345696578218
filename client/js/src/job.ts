// A job from its submission to its end, over connections that break and servers that are full.
import {type Asset, requestOf} from './asset.js';
import {type Connection, Patience, call, jsonOf, patiently, reach} from './connection.js';
import {UnwrapdError, unreachable} from './error.js';
import {eventsOf} from './events.js';
import type {Job, JobEvent, Options} from './types.js';

export interface Progress {
  /** Share of the whole job that is done; never falls. */
  fraction: number;
  event: JobEvent;
}

/** How to call the server, and what to tell on the way. */
export interface Call extends Connection {
  onProgress?: ((progress: Progress) => void) | undefined;
  /** Names the request: sent again with this name, it gets the same job. Default: a new name. */
  idempotencyKey?: string | undefined;
  /** A name of the job for people, up to 200 characters. */
  name?: string | undefined;
  /** An upload ticket, in place of a key: a URL of uploadTickets(), which takes one job. */
  ticket?: string | undefined;
}

const FINAL = ['succeeded', 'failed', 'cancelled'];

function newName(): string {
  const random = () => Math.random().toString(36).slice(2); // where crypto has no randomUUID
  return globalThis.crypto?.randomUUID?.() ?? random() + random();
}

/** Sends the asset. A request that is sent again gets the job that it made before. */
function submit(asset: Asset, options: Options, settings: Call): Promise<Job> {
  const {body, headers: own} = requestOf(asset, options, settings.name);
  const headers = {Accept: 'application/json', 'Idempotency-Key': settings.idempotencyKey ?? newName(), ...own};
  return patiently(settings, async () => {
    const answer = await call(settings, settings.ticket ?? '/v1/jobs', {method: 'POST', headers, body});
    return jsonOf<Job>(settings, answer);
  });
}

async function stateOf(job: Job, connection: Connection): Promise<Job> {
  const answer = await call(connection, job.links.self);
  return jsonOf<Job>(connection, answer);
}

/** Reads events where the last connection ended. */
class Follower {
  readonly patience: Patience;
  readonly #settings: Call;
  #lastId: number | undefined;
  #fraction = 0;

  constructor(settings: Call) {
    this.#settings = settings;
    this.patience = new Patience(settings);
  }

  /** The job at its end; undefined if the connection ends before. */
  async read(job: Job): Promise<Job | undefined> {
    const last = this.#lastId === undefined ? {} : {'Last-Event-ID': String(this.#lastId)};
    const headers = {Accept: 'text/event-stream', ...last};
    const answer = await call(this.#settings, job.links.events, {headers});
    const events = eventsOf(answer.body!);
    try {
      for (;;) {
        const {value: event, done} = await reach(this.#settings, events.next());
        if (done) return undefined;
        this.#tell(event);
        if (FINAL.includes(event.event)) return event.data as Job;
      }
    } finally {
      await events.return(undefined);
    }
  }

  #tell(event: JobEvent): void {
    this.patience.renew();
    if ('id' in event) this.#lastId = event.id;
    const told = event.event === 'succeeded' ? 1 : (event.data as {fraction?: number}).fraction;
    this.#fraction = Math.max(this.#fraction, told ?? 0);
    this.#settings.onProgress?.({fraction: this.#fraction, event});
  }
}

/** Follows the job to its end. While no stream is free, its state is asked for. */
export async function follow(job: Job, settings: Call): Promise<Job> {
  const follower = new Follower(settings);
  for (;;) {
    try {
      const ended = await follower.read(job);
      if (ended) return ended;
      throw unreachable('the events ended before the job');
    } catch (error) {
      await follower.patience.after(error);
      if (!(error instanceof UnwrapdError && error.code === 'too_many_streams')) continue;
      const now = await patiently(settings, () => stateOf(job, settings));
      if (FINAL.includes(now.state)) return now;
      follower.patience.renew();
    }
  }
}

/** Asks the server to stop; that it cannot be reached is no error of the caller's. */
async function cancel(job: Job, {server, key}: Call): Promise<void> {
  await call({server, key}, job.links.self, {method: 'DELETE'}).catch(() => {});
}

/**
 * Submits and follows a job. Throws UnwrapdError unless it succeeds. The signal's reason, or what
 * onProgress throws, ends the call and cancels the job.
 */
export async function runJob(asset: Asset, options: Options, settings: Call): Promise<Job> {
  const job = await submit(asset, options, settings);
  try {
    const ended = await follow(job, settings);
    if (ended.problem) throw new UnwrapdError(ended.problem);
    return {...ended, links: job.links}; // those of a ticket are signed
  } catch (error) {
    if (!(error instanceof UnwrapdError)) await cancel(job, settings);
    throw error;
  }
}

/** A file of a job that has succeeded, read whole. */
export function download<T>(path: string, settings: Connection, read: (answer: Response) => Promise<T>,
                            headers: Record<string, string> = {}): Promise<T> {
  return patiently(settings, async () => reach(settings, read(await call(settings, path, {headers}))));
}
