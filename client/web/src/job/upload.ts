// A mesh on its way to the server: by XMLHttpRequest, which alone tells how much has been sent.
import {type UnwrapdError, errorOf, unreachable} from '../../../js/src/error.js';
import {connection, keyHeader} from './server.js';

export interface Uploaded {
  blob: Blob;
  mediaType: string;
  sha256: string;
}

function answerOf(sent: XMLHttpRequest): Response {
  const retryAfter = sent.getResponseHeader('Retry-After');
  return new Response(sent.responseText, {status: sent.status, headers: retryAfter ? {'Retry-After': retryAfter} : {}});
}

/** Stores the mesh under its digest. onSent: the share that has been sent. Throws UnwrapdError. */
export async function upload({blob, mediaType, sha256}: Uploaded, onSent: (share: number) => void, signal: AbortSignal): Promise<void> {
  signal.throwIfAborted(); // since the digest was begun
  return new Promise((resolve, reject) => {
    const sent = new XMLHttpRequest();
    const stop = () => {
      sent.abort();
      reject(signal.reason);
    };
    sent.open('PUT', `${connection().server}/v1/meshes/${sha256}`);
    for (const [name, value] of Object.entries({'Content-Type': mediaType, ...keyHeader()})) sent.setRequestHeader(name, value);
    sent.upload.onprogress = ({loaded, total}) => onSent(total > 0 ? loaded / total : 0);
    sent.onerror = () => reject(unreachable('the upload broke'));
    sent.onload = () => {
      if (sent.status < 300) resolve();
      else errorOf(answerOf(sent)).then((error: UnwrapdError) => reject(error), reject);
    };
    sent.onloadend = () => signal.removeEventListener('abort', stop);
    signal.addEventListener('abort', stop);
    sent.send(blob);
  });
}
