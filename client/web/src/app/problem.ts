// What went wrong, in words with what to do, or what ended as it was asked to.
import {$, present, show} from '../base/dom.js';
import {UnreadableError} from '../files/error.js';
import {UnwrapdError} from '../job/run.js';

/** What to do about errors of the server, where its own words are for programs. */
const ADVICE: Record<string, string> = {
  unauthorized: 'This server wants an API key. Type it below and try again.',
  forbidden: 'This key does not permit it. Ask the operator of the server for another one.',
  not_found: 'There is no such job here. It was removed, or it belongs to another key.',
  result_expired: 'The result is no longer kept. Open the mesh and unwrap it again.',
  unreachable: 'Check your connection, then try again. A job that has begun continues on the server.',
};

function tell(title: string, text: string, code = '', calm = false): void {
  $('problem-title').textContent = title;
  $('problem-text').textContent = text;
  $('problem-code').textContent = code;
  $('problem').classList.toggle('calm', calm);
  present($('problem'));
}

export function showProblem(error: unknown): void {
  if (error instanceof UnwrapdError) {
    const wantsKey = error.status === 401;
    show($('key-row'), wantsKey || !$('key-row').hidden);
    const place = error.pointer ? ` (at ${error.pointer})` : '';
    tell(wantsKey ? 'A key is needed' : 'The server could not do this', [error.detail + place, ADVICE[error.code]].filter(Boolean).join(' '), `Code: ${error.code}`);
    if (wantsKey) $('key').focus();
  } else if (error instanceof UnreadableError) {
    tell('This file cannot be opened', error.message);
  } else {
    tell('This did not work', error instanceof Error ? error.message : String(error));
  }
}

/** Something that is no error. */
export function showMessage(title: string, text: string): void {
  tell(title, text, '', true);
}

export function clearProblem(): void {
  show($('problem'), false);
}
