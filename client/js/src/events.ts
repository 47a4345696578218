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

/** The events of one connection, as they arrive. */
export async function* eventsOf(body: ReadableStream<Uint8Array>): AsyncGenerator<JobEvent> {
  const reader = body.getReader();
  const decoder = new TextDecoder();
  let rest = '';
  try {
    for (;;) {
      const {value, done} = await reader.read();
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
