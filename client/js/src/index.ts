import type {Asset} from './asset.js';
import {jsonOf} from './connection.js';
import {type Call, download, runJob} from './job.js';
import type {Job, Options, Report} from './types.js';

export type {Asset, AssetInParts, Bytes} from './asset.js';
export type {Connection} from './connection.js';
export {UnwrapdError} from './error.js';
export type {Call, Progress} from './job.js';
export {type TicketTerms, uploadTickets} from './ticket.js';
export type {Job, JobEvent, Options, Problem, Report, Result, Tickets} from './types.js';

export interface Unwrapped {
  /** The asset with its texture coordinates. Its type says the format. */
  asset: Blob;
  report: Report;
  job: Job;
}

/** Unwraps an asset: a glTF, OBJ, STL, PLY or OFF. Throws UnwrapdError, or the signal's reason. */
export async function unwrap(asset: Asset, options: Options = {}, settings: Call = {}): Promise<Unwrapped> {
  const job = await runJob(asset, options, settings);
  const report = await download(job.links.report, settings, (answer) => jsonOf<Report>(settings, answer));
  return {asset: await download(job.links.result, settings, (answer) => answer.blob()), report, job};
}

export interface Many extends Omit<Call, 'idempotencyKey' | 'name' | 'ticket'> {
  /** Most assets under way at once. Default: 4. */
  concurrency?: number;
  options?: Options;
}

/** What became of one of many assets: what unwrap() returns, or what it throws. */
export type Outcome<T extends Asset> =
  ({input: T} & Unwrapped & {error?: undefined}) | {input: T; error: unknown};

/**
 * Unwraps assets, several at once; yields what became of each in their order. Whoever stops early
 * cancels the jobs that are under way.
 */
export async function* unwrapMany<T extends Asset>(assets: Iterable<T> | AsyncIterable<T>, settings: Many = {}):
    AsyncGenerator<Outcome<T>> {
  const {concurrency = 4, options = {}, ...each} = settings;
  const begun: Promise<Outcome<T>>[] = [];
  const all = new AbortController();
  const stop = () => all.abort(each.signal?.reason);
  each.signal?.addEventListener('abort', stop);
  if (each.signal?.aborted) stop();
  const begin = (input: T) => unwrap(input, options, {...each, signal: all.signal});
  try {
    for await (const input of assets) {
      begun.push(begin(input).then((done) => ({input, ...done}), (error) => ({input, error})));
      if (begun.length >= concurrency) yield (await begun.shift())!;
    }
    while (begun.length > 0) yield (await begun.shift())!;
  } finally {
    each.signal?.removeEventListener('abort', stop);
    if (begun.length > 0) stop();
    await Promise.all(begun);
  }
}
