let base = '';

/** Sets the address of the server. */
export function at(address: string): void {
  base = address;
}

/** The mutator of orval's fetch client: an answer as JSON, text or bytes, by its media type. */
export async function call<T>(url: string, init: RequestInit): Promise<T> {
  const answer = await fetch(base + url, init);
  const type = answer.headers.get('Content-Type') ?? '';
  const data = /^application\/(.*\+)?json/.test(type) ? await answer.json()
    : type.startsWith('text/') ? await answer.text() : await answer.blob();
  return {data, status: answer.status, headers: answer.headers} as T;
}
