// The server under load, over real sockets, from another process. Figures are printed and kept as
// JSON; nothing fails a test, since machines are noisy.
//
//   node load.mjs UNWRAPD OUT.json [SOAK_SECONDS (60; 1800 is the full one)] [streams|idle|queue|soak]
import {writeFileSync} from 'node:fs';

import {idle} from './load/idle.mjs';
import {queue} from './load/queue.mjs';
import {soak} from './load/soak.mjs';
import {streams} from './load/streams.mjs';

const [binary, out, seconds = '60', only] = process.argv.slice(2);
const parts = {streams, idle, queue, soak: (program) => soak(program, Number(seconds)),
               shared_soak: (program) =>
                 soak(program, Number(seconds) / 4, ['--isolate=off'])};
const figures = {};
for (const [name, part] of Object.entries(parts)) {
  if (only && only !== name) continue;
  figures[name] = await part(binary).catch((error) => {
    console.log(`  FAILED ${error.message}`);
    return [{name: 'failed', value: error.message}];
  });
}
writeFileSync(out, JSON.stringify({date: new Date().toISOString(), figures}, null, 2) + '\n');
