// The jobs of this server, or of the key that was given: newest first.
import {$, el} from '../base/dom.js';
import {hashOf} from '../base/permalink.js';
import type {Job} from './run.js';
import {getJson} from './server.js';

interface Page {
  jobs: Job[];
  next?: string | null;
}

const STATES: Record<string, string> = {queued: 'waiting', running: 'running', succeeded: 'done', failed: 'failed', cancelled: 'cancelled'};
const when = new Intl.DateTimeFormat('en', {dateStyle: 'medium', timeStyle: 'medium'});

function row({id, name, state, created, options}: Job): HTMLElement {
  const link = el('a', {href: hashOf({job: id, name: name ?? id})}, name ?? `${id.slice(0, 10)}…`);
  const what = [STATES[state] ?? state, options.preset, options.method].join(', ');
  return el('li', {}, link, ` ${when.format(new Date(created))}: ${what}`);
}

export async function listJobs(): Promise<void> {
  const {jobs} = await getJson<Page>('/v1/jobs?limit=50');
  $('job-list').replaceChildren(...(jobs.length > 0 ? jobs.map(row) : [el('li', {}, 'No jobs yet.')]));
}
