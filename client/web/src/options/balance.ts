// The slider of λ and the field beside it: one value, shown twice. A list of values is typed.
import {$} from '../base/dom.js';
import {SLIDER_STEPS, lambdaOfSlider, lambdaOfText, sliderOfLambda} from './lambda.js';

/** onMove: λ while the slider moves (a draft will do), and where it is let go. */
export function connectBalance(onMove: (lambda: number, isDraft: boolean) => void): void {
  const [slider, field, problem] = [$<HTMLInputElement>('balance'), $<HTMLInputElement>('lambda'), $('lambda-problem')];
  slider.max = String(SLIDER_STEPS);
  const spell = (lambda: number) => slider.setAttribute('aria-valuetext', `λ ${lambda}`);
  const show = () => {
    try {
      const lambda = [lambdaOfText(field.value)].flat()[0]!;
      slider.value = String(sliderOfLambda(lambda));
      spell(lambda);
      problem.textContent = '';
      field.removeAttribute('aria-invalid');
    } catch (error) {
      problem.textContent = (error as Error).message;
      field.setAttribute('aria-invalid', 'true');
    }
  };
  slider.addEventListener('input', () => {
    const lambda = lambdaOfSlider(Number(slider.value));
    field.value = String(lambda);
    spell(lambda);
    problem.textContent = '';
    field.removeAttribute('aria-invalid');
    onMove(lambda, true);
  });
  slider.addEventListener('change', () => onMove(lambdaOfSlider(Number(slider.value)), false));
  field.addEventListener('input', show);
  show();
}
