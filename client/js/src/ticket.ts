// Upload tickets: how the holder of an API key lets pages without one send jobs.
import {type Connection, call, jsonOf, patiently} from './connection.js';
import type {Tickets} from './types.js';

/** What each ticket is for. */
export interface TicketTerms {
  /** Seconds for which it is valid. Default: 900, at most a day. */
  seconds?: number;
  /** The most bytes of its upload. Default: what the server takes. */
  maxBytes?: number;
  /** Number of tickets. Default: 1, at most 100. */
  count?: number;
}

/** Tickets for the `ticket` of unwrap(), each of which takes one job for the key of this connection. */
export function uploadTickets(connection: Connection, {seconds, maxBytes, count}: TicketTerms = {}): Promise<Tickets> {
  const terms = Object.entries({seconds, max_bytes: maxBytes, count}).filter(([, value]) => value !== undefined);
  const query = new URLSearchParams(terms.map(([name, value]) => [name, String(value)]));
  return patiently(connection, async () =>
    jsonOf<Tickets>(connection, await call(connection, `/v1/tickets?${query}`, {method: 'POST', body: ''})));
}
