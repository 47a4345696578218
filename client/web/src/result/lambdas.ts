// The maps of a list of lambdas beside each other: pictures of the server, with the figures of each.
import {$, el, show} from '../base/dom.js';
import {fixed} from '../base/words.js';
import type {Job, Report} from '../job/run.js';
import {getBlob} from '../job/server.js';
import {ofLambda} from './load.js';

const SIZE = 320; // pixels of a picture

export class LambdaGallery {
  #job = '';
  #urls: string[] = [];

  /** Nothing is beside anything. */
  hide(): void {
    this.#job = '';
    for (const url of this.#urls.splice(0)) URL.revokeObjectURL(url);
    $('lambdas').replaceChildren();
    show($('lambdas-row'), false);
  }

  /** shown: the one in the views. onChoose: another is to be shown there. */
  show(job: Job, {curve}: Report, shown: number | undefined, onChoose: (lambda: number) => void): void {
    if (this.#job !== job.id) {
      this.hide();
      this.#job = job.id;
      const cards = curve.map(({lambda, distortion: {angle, area}}) => {
        const pictures = [el('img', {alt: '', width: SIZE, height: SIZE}), el('img', {alt: '', width: SIZE, height: SIZE})] as const;
        const button = el('button', {type: 'button', value: String(lambda)}, ...pictures, el('span', {}, `λ ${lambda}: angles ${fixed(angle, 3)}, areas ${fixed(area, 3)}`));
        button.addEventListener('click', () => onChoose(lambda));
        return {lambda, button, pictures};
      });
      $('lambdas').replaceChildren(...cards.map(({button}) => el('li', {}, button)));
      void this.#load(job, cards);
    }
    for (const button of $('lambdas').querySelectorAll('button')) button.setAttribute('aria-pressed', String(Number(button.value) === shown));
    show($('lambdas-row'), curve.length > 1);
  }

  /** One after the other, so that the server is not asked for all at once. A picture that fails is left out. */
  async #load(job: Job, cards: {lambda: number; pictures: readonly HTMLImageElement[]}[]): Promise<void> {
    for (const {lambda, pictures} of cards)
      for (const [i, link] of [job.links.preview, job.links.layout_png].entries()) {
        const blob = await getBlob(`${link}${ofLambda(lambda)}&size=${SIZE}`).catch(() => undefined);
        if (this.#job !== job.id) return;
        if (!blob) continue;
        pictures[i]!.src = URL.createObjectURL(blob);
        this.#urls.push(pictures[i]!.src);
      }
  }
}
