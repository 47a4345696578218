// What can be given to others: a signed link, which opens one file without a key, and a command.
import {$, announce} from '../base/dom.js';
import type {Job} from '../job/run.js';
import {connection, getJson} from '../job/server.js';

/** Puts a text into the clipboard; where the browser keeps it shut, selects it for copying by hand. */
export async function copy(field: HTMLInputElement | HTMLTextAreaElement): Promise<void> {
  try {
    await navigator.clipboard.writeText(field.value);
    announce('Copied.');
  } catch {
    field.focus();
    field.select();
    announce('Press Ctrl+C to copy.');
  }
}

async function linkOf(job: Job, file: string, seconds: string): Promise<string> {
  const {url} = await getJson<{url: string}>(`${job.links.self}/link?${new URLSearchParams({file, seconds})}`);
  return new URL(url, `${connection().server}/`).href;
}

/** job: the one that is shown. */
export function connectSharing(job: () => Job | undefined, onError: (error: unknown) => void): void {
  const field = $<HTMLInputElement>('link');
  $('make-link').addEventListener('click', () => {
    const of = job();
    if (!of) return;
    linkOf(of, $<HTMLSelectElement>('link-file').value, $<HTMLSelectElement>('link-seconds').value)
      .then((url) => {
        field.value = url;
        field.parentElement!.hidden = false;
        return copy(field);
      })
      .catch(onError);
  });
  $('copy-curl').addEventListener('click', () => void copy($<HTMLTextAreaElement>('curl')));
}
