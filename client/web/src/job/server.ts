// Calls to the server that shows this page, by the client's own code.
import {call, jsonOf, patiently, reach, type Connection} from '../../../js/src/connection.js';

let key: string | undefined;

/** The key that people type in: in no storage and no address. */
export function setKey(given: string): void {
  key = given.trim() || undefined;
}

export function connection(signal?: AbortSignal): Connection {
  return {server: new URL('.', location.href).href.replace(/\/$/, ''), key, signal};
}

export const keyHeader = (): Record<string, string> => (key ? {Authorization: `Bearer ${key}`} : {});

/** One request; patience is the caller's. */
export function request(path: string, init: RequestInit = {}, signal?: AbortSignal): Promise<Response> {
  return call(connection(signal), path, {cache: 'no-store', ...init});
}

/** JSON by GET, which is safe to ask for again. */
export function getJson<T>(path: string, signal?: AbortSignal): Promise<T> {
  const here = connection(signal);
  return patiently(here, async () => jsonOf<T>(here, await request(path, {}, signal)));
}

/** Bytes by GET, the same. */
export function getBlob(path: string, accept?: string, signal?: AbortSignal): Promise<Blob> {
  const here = connection(signal);
  const headers = accept ? {Accept: accept} : {};
  return patiently(here, async () => reach(here, (await request(path, {headers}, signal)).blob()));
}
