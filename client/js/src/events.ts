// The event stream format of the HTML standard, as far as the server uses it: lines end in LF.
import type {JobEvent} from './types.js';

function eventOf(block: string): JobEvent | undefined {
  const fields: Record<string, string> = {};
  for (const line of block.split('\n')) {
    const [, name, value] = /^(\w+): ?(.*)$/.exec(line) ?? []; // a comment has no name
    if (name) fields[name] = fields[name] === undefined ? value! : `${fields[name]}\n${value}`;
  }
  if (!fields['event'] || fields['data'] === undefined) return undefined;
  const id = fields['id'] === undefined ? {} : {id: Number(fields['id'])};
  return {...id, event: fields['event'], data: JSON.parse(fields['data'])} as JobEvent;
}

const SILENCE = 60_000; // ms; the server says something more often

/** What is read, or an error if nothing comes: a connection may have died without a word. */
async function heard<T>(reading: Promise<T>): Promise<T> {
  let timer: ReturnType<typeof setTimeout> | undefined;
  const silence = new Promise<never>((_, reject) => {
    timer = setTimeout(() => reject(new TypeError('the server is silent')), SILENCE);
  });
  try {
    return await Promise.race([reading, silence]);
  } finally {
    clearTimeout(timer);
  }
}

/** The events of one connection, as they arrive. */
export async function* eventsOf(body: ReadableStream<Uint8Array>): AsyncGenerator<JobEvent> {
  const reader = body.getReader();
  const decoder = new TextDecoder();
  let rest = '';
  try {
    for (;;) {
      const {value, done} = await heard(reader.read());
      if (done) return;
      const blocks = (rest + decoder.decode(value, {stream: true})).split('\n\n');
      rest = blocks.pop()!;
      for (const block of blocks) {
        const event = eventOf(block);
        if (event) yield event;
      }
    }
  } finally {
    await reader.cancel().catch(() => {});
  }
}
