// One request to the server, and when to send it again.
import {UNREACHABLE, UnwrapdError, errorOf, unexpected, unreachable} from './error.js';

/** Where the server is, and how long to be patient with it. */
export interface Connection {
  /** Address of the server. Default: the origin of the page; elsewhere http://127.0.0.1:8080. */
  server?: string | undefined;
  /** An API key. */
  key?: string | undefined;
  /** Ends the call; a job that has begun is cancelled. */
  signal?: AbortSignal | undefined;
  /** How often in a row a request may fail for want of a connection or of room. Default: 10. */
  retries?: number | undefined;
}

const RETRIES = 10;
const FIRST_PAUSE = 0.25; // seconds, doubled each time
const LONGEST_PAUSE = 5;
const LONGEST_RETRY_AFTER = 60;
const GATEWAYS = [502, 504]; // a proxy without a server behind it

function addressOf({server}: Connection): string {
  const own = typeof location === 'undefined' ? 'http://127.0.0.1:8080' : location.origin;
  const address = server ?? own;
  if (!/^https?:\/\//i.test(address)) throw new RangeError(`server is an address with http:// or https://, not ${address}`);
  return address.replace(/\/$/, '');
}

/** Awaits what the network does: TypeErrors of fetch and of broken bodies become UnwrapdErrors. */
export async function reach<T>(connection: Connection, wanted: Promise<T>): Promise<T> {
  try {
    return await wanted;
  } catch (error) {
    connection.signal?.throwIfAborted();
    throw error instanceof TypeError ? unreachable(error) : error;
  }
}

/** Sends one request; throws UnwrapdError for any answer but one of success. */
export async function call(connection: Connection, path: string, init: RequestInit = {}): Promise<Response> {
  const headers = new Headers(init.headers);
  if (connection.key) headers.set('Authorization', `Bearer ${connection.key}`);
  const signal = connection.signal ?? null;
  const answer = await reach(connection, fetch(addressOf(connection) + path, {signal, ...init, headers}));
  if (!answer.ok) throw await errorOf(answer);
  return answer;
}

/** The JSON of an answer; a proxy may have sent a page of its own. */
export async function jsonOf<T>(connection: Connection, answer: Response): Promise<T> {
  const text = await reach(connection, answer.text());
  try {
    return JSON.parse(text) as T;
  } catch {
    throw unexpected(answer.status);
  }
}

function wait(seconds: number, signal: AbortSignal | undefined): Promise<void> {
  return new Promise((resolve, reject) => {
    const stop = () => {
      clearTimeout(timer);
      reject(signal?.reason);
    };
    const timer = setTimeout(() => {
      signal?.removeEventListener('abort', stop);
      resolve();
    }, seconds * 1000);
    signal?.addEventListener('abort', stop, {once: true});
  });
}

/** Counts failures in a row, and waits after each. */
export class Patience {
  readonly #connection: Connection;
  #failures = 0;

  constructor(connection: Connection) {
    this.#connection = connection;
  }

  /** Forgets the failures: there was progress. */
  renew(): void {
    this.#failures = 0;
  }

  /** Waits until the next attempt; throws the error again if there is none. */
  async after(error: unknown): Promise<void> {
    const {signal, retries = RETRIES} = this.#connection;
    signal?.throwIfAborted();
    const pause = this.#pauseAfter(error);
    if (pause === undefined || ++this.#failures > retries) throw error;
    await wait(pause, signal);
  }

  #pauseAfter(error: unknown): number | undefined {
    if (!(error instanceof UnwrapdError)) return undefined;
    if (error.retryAfter) return Math.min(error.retryAfter, LONGEST_RETRY_AFTER);
    const isAway = error.code === UNREACHABLE || GATEWAYS.includes(error.status);
    return isAway ? Math.min(FIRST_PAUSE * 2 ** this.#failures, LONGEST_PAUSE) : undefined;
  }
}

/** Attempts until one succeeds, or fails for good. An attempt must be safe to make again. */
export async function patiently<T>(connection: Connection, attempt: () => Promise<T>): Promise<T> {
  const patience = new Patience(connection);
  for (;;) {
    try {
      return await attempt();
    } catch (error) {
      await patience.after(error);
    }
  }
}
