// What the page itself does for a picture of a large mesh, in Chromium: its scripts' time while the mesh is
// turned and while a pointer moves over it, and what a graphics card must draw. The card's own time is not
// measured: without one Chromium draws in software, which is no measure of a card.
//
//   node frames.mjs UNWRAPD OUT.json [FACES (200000)]
import {writeFileSync} from 'node:fs';

import {figure, quantile, round} from './load/measure.mjs';

const [binary, out, faces = '200000'] = process.argv.slice(2);
process.env.UNWRAPD = binary;  // before what follows asks for it
const {Bench, cap, launchChromium, missing, openMesh} = await import('../e2e/page.mjs');
const kPictures = 120;
const kPicture = 1000 / 60; // ms
const flags = ['--no-sandbox', '--disable-quic', '--use-gl=angle', '--use-angle=swiftshader', '--enable-unsafe-swiftshader',
  '--disable-gpu-compositing', '--webgl-antialiasing-mode=none'];

/** Counts what WebGL is asked for, and the time of scripts within a picture. */
function watch() {
  const counts = (window.counts = {calls: 0, corners: 0, uploaded: 0, times: []});
  const context = WebGL2RenderingContext.prototype;
  for (const [name, corners] of [['drawArrays', (given) => given[2]], ['drawElements', (given) => given[1]]]) {
    const own = context[name];
    context[name] = function (...given) {
      counts.calls += 1;
      counts.corners += corners(given);
      return own.apply(this, given);
    };
  }
  for (const name of ['bufferData', 'bufferSubData']) {
    const own = context[name];
    context[name] = function (...given) {
      counts.uploaded += given.find((value) => value?.byteLength)?.byteLength ?? 0;
      return own.apply(this, given);
    };
  }
  const ask = window.requestAnimationFrame.bind(window);
  window.requestAnimationFrame = (callback) => ask((now) => {
    const begin = performance.now();
    callback(now);
    counts.times.push(performance.now() - begin);
  });
}

/** Moves a pointer over the mesh, a picture for each move; ms of scripts for each picture, and what was drawn. */
async function moves(page, isTurning) {
  const box = await page.locator('#solid').boundingBox();
  const at = (k) => [box.x + box.width * (0.5 + 0.3 * Math.cos(k / 9)), box.y + box.height * (0.5 + 0.3 * Math.sin(k / 9))];
  await page.mouse.move(...at(0));
  if (isTurning) await page.mouse.down();
  const before = await scriptSeconds(page);
  await page.evaluate(() => Object.assign(window.counts, {calls: 0, corners: 0, uploaded: 0, times: []}));
  for (let k = 1; k <= kPictures; k += 1) {
    await page.mouse.move(...at(k));
    await page.evaluate(() => new Promise((done) => setTimeout(() => requestAnimationFrame(done))));
  }
  const scripts = (1000 * (await scriptSeconds(page) - before)) / kPictures;
  const counts = await page.evaluate(() => window.counts);
  if (isTurning) await page.mouse.up();
  return {scripts, counts};
}

async function scriptSeconds(page) {
  page.protocol ??= await page.context().newCDPSession(page);
  await page.protocol.send('Performance.enable');
  const {metrics} = await page.protocol.send('Performance.getMetrics');
  return metrics.find(({name}) => name === 'ScriptDuration').value;
}

if (missing) throw new Error(missing);
const bench = new Bench();
await bench.open(() => launchChromium(flags));
const ends = [];
try {
  const page = await bench.blank({after: (end) => ends.push(end)});
  await page.addInitScript(watch);
  await page.goto(`${bench.server.base}/`);
  await page.locator('#option-method').waitFor();
  const side = Math.round(Math.sqrt(Number(faces) / 2));
  await page.click('#form summary');
  await page.check('#preset-paper');
  await openMesh(page, bench.file('large.obj', cap(side)));
  await page.click('#send');
  await page.locator('#result').waitFor({timeout: 300_000});
  console.log(`${2 * side * side} triangles, both views, scripts of a picture`);
  const [turned, hovered] = [await moves(page, true), await moves(page, false)];
  const {calls, corners, uploaded, times} = turned.counts;
  const figures = [
    figure('turning the mesh, mean', round(turned.scripts, 2), 'ms', round(kPicture / 4, 1)),
    figure('turning, the slowest of a hundred', round(quantile(times, 0.99), 2), 'ms', round(kPicture / 2, 1)),
    figure('a pointer over the mesh, mean', round(hovered.scripts, 2), 'ms', round(kPicture / 2, 1)),
    figure('calls to draw', round(calls / kPictures, 1), 'a picture'),
    figure('triangles and lines drawn', round(corners / 3 / kPictures / 1000, 0), 'thousand a picture'),
    figure('sent to the graphics card', round(uploaded / kPictures / 1000, 1), 'kB a picture'),
  ];
  writeFileSync(out, JSON.stringify({date: new Date().toISOString(), faces: 2 * side * side, figures}, null, 2) + '\n');
} finally {
  for (const end of ends) await end();
  await bench.close();
}
