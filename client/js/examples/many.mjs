// node examples/many.mjs FILE...: unwraps files, two at once, and tells what became of each.
import {readFile} from 'node:fs/promises';
import {unwrapMany} from 'unwrapd-client';

const names = process.argv.slice(2);
async function* files() {
  for (const name of names) yield await readFile(name);
}

const settings = {server: process.env.UNWRAPD_SERVER, concurrency: 2, options: {effort: 'fast'}};
for await (const {error, report} of unwrapMany(files(), settings))
  console.log(names.shift(), error ? error.message : `${report.charts.length} charts`);
