// node examples/node.mjs IN OUT: unwraps a file by the server at UNWRAPD_SERVER.
import {readFile, writeFile} from 'node:fs/promises';
import {unwrap} from 'unwrapd-client';

const [input, output] = process.argv.slice(2);
const {asset, report} = await unwrap(await readFile(input), {preset: 'texture'}, {
  server: process.env.UNWRAPD_SERVER,
  onProgress: ({fraction, event}) => console.error(`${Math.round(100 * fraction)} % ${event.event}`),
});
await writeFile(output, Buffer.from(await asset.arrayBuffer()));
console.log(`${report.charts.length} charts, D_angle ${report.distortion.angle}`);
