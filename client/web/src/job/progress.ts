// A job under way, as it is told by its events: stage, chart, iteration, and the curve of its energy.
import {$, announce, oncePerFrame} from '../base/dom.js';
import {count, fixed, integer} from '../base/words.js';
import type {JobEvent, Progress} from './run.js';

const STAGES: Record<string, string> = {
  read: 'Reading the file', setup: 'Preparing', segment: 'Splitting into charts', merge: 'Merging charts', factor: 'Preparing the solver',
  solve: 'Flattening', untangle: 'Removing flips', measure: 'Measuring', pack: 'Packing islands', write: 'Writing the file',
};

type Point = {chart: number; i: number; energy: number};

export class ProgressView {
  #curve: Point[] = [];
  #stage = '';
  readonly #drawSoon = oncePerFrame(() => this.#draw());

  /** A new job: nothing of the one before stays. */
  begin(text: string): void {
    this.#curve = [];
    this.#stage = '';
    $('iteration').textContent = '';
    $('chart-of').textContent = '';
    this.#draw();
    this.tell(text, undefined);
  }

  tell(text: string, fraction: number | undefined): void {
    const bar = $<HTMLProgressElement>('fraction');
    if (fraction === undefined) bar.removeAttribute('value');
    else bar.value = fraction;
    if ($('status').textContent !== text) $('status').textContent = text;
  }

  sent(share: number): void {
    this.tell(share < 1 ? `Sending the mesh: ${Math.floor(share * 100)} %` : 'The mesh is sent.', share);
  }

  on({fraction, event}: Progress): void {
    $<HTMLProgressElement>('fraction').value = fraction;
    this.#show(event);
  }

  #show({event, data}: JobEvent): void {
    if (event === 'queued') {
      const {position} = data;
      this.tell(position > 0 ? `Waiting: ${count(position, 'job')} ahead.` : 'Waiting for a worker…', 0);
    } else if (event === 'started') {
      this.tell('Started.', 0);
    } else if (event === 'stage') {
      const text = STAGES[data.name] ?? data.name;
      if (text !== this.#stage) this.#stage = $('status').textContent = text;
      $('chart-of').textContent = data.of > 1 ? `chart ${integer(data.chart + 1)} of ${integer(data.of)}` : '';
    } else if (event === 'iteration') {
      const {i, energy, angle, area, flipped, chart} = data;
      if (!this.#stage) this.#stage = $('status').textContent = STAGES['solve']!; // it began before this page asked
      $('iteration').textContent = `Iteration ${i}: energy ${fixed(energy, 6)}, angles ${fixed(angle, 4)}, areas ${fixed(area, 4)}, ${integer(flipped)} flipped`;
      this.#curve.push({chart, i, energy});
      this.#drawSoon();
    }
  }

  /** The energy of the chart that is being flattened, on a logarithmic scale. */
  #draw(): void {
    const chart = this.#curve.at(-1)?.chart;
    const points = this.#curve.filter((point) => point.chart === chart && point.energy > 0);
    const logs = points.map(({energy}) => Math.log(energy));
    const [low, high] = [Math.min(...logs), Math.max(...logs)];
    const x = (k: number) => (100 * k) / Math.max(points.length - 1, 1);
    const y = (log: number) => 38 - (36 * (log - low)) / (high - low || 1);
    $('energy').setAttribute('d', points.length > 1 ? `M${logs.map((log, k) => `${x(k).toFixed(2)} ${y(log).toFixed(2)}`).join('L')}` : '');
    $('energy-figure').hidden = points.length < 2;
  }

  /** The job has ended: the last iteration of its last chart is none of its result. */
  end(text: string): void {
    $('iteration').textContent = '';
    $('chart-of').textContent = '';
    this.tell(text, 1);
    announce(text);
  }
}
