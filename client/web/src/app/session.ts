// One mesh and its jobs: what is open, what runs, what is shown.
import {$, present, show} from '../base/dom.js';
import {count} from '../base/words.js';
import type {Opened} from '../files/read.js';
import {ProgressView} from '../job/progress.js';
import {type Job, type OptionValues, SentMesh, UnwrapdError, cancel, ended, hasEnded} from '../job/run.js';
import {getJson} from '../job/server.js';
import {listCharts} from '../result/charts.js';
import {type Kept, listDownloads} from '../result/downloads.js';
import {showFigures} from '../result/figures.js';
import {LambdaGallery} from '../result/lambdas.js';
import {type Loaded, loadAsset, loadResult, withSourcesOf} from '../result/load.js';
import {showPictures} from '../result/pictures.js';
import {clearProblem, showMessage, showProblem} from './problem.js';
import type {Viewing} from './viewing.js';
import type {Visits} from './visits.js';

/** file: what was sent, where that is another than the one that is open. */
export interface Asked {
  options: OptionValues;
  file?: string;
}

export class Session {
  opened: Opened | undefined;
  sent: SentMesh | undefined;
  job: Job | undefined;
  loaded: Loaded | undefined;
  kept: Kept | undefined;
  /** How jobs were asked for. */
  readonly asked = new Map<string, Asked>();
  /** A result is shown. */
  onResult?: () => void;
  /** What was open is so no more: nothing that was made of it counts. */
  onClose?: () => void;
  readonly #viewing: Viewing;
  readonly #visits: Visits;
  readonly #progress = new ProgressView();
  readonly #gallery = new LambdaGallery();
  #running: AbortController | undefined;
  #last: (signal: AbortSignal) => Promise<void> = async () => {};

  constructor(viewing: Viewing, visits: Visits) {
    [this.#viewing, this.#visits] = [viewing, visits];
    $('cancel').addEventListener('click', () => void this.#cancel());
    $('retry').addEventListener('click', () => void this.#guarded(this.#last));
    $('key').addEventListener('keydown', ({key}) => key === 'Enter' && void this.#guarded(this.#last));
    $('lambda-shown').addEventListener('change', () => {
      this.#choose(Number($<HTMLSelectElement>('lambda-shown').value));
    });
  }

  get isBusy(): boolean {
    return $<HTMLButtonElement>('send').disabled;
  }

  open(opened: Opened): void {
    this.close();
    this.opened = opened;
    this.sent = new SentMesh(opened.blob, opened.mediaType, opened.name);
  }

  /** What is open is left. A job of it that runs goes on at the server. */
  close(): void {
    this.#abort();
    this.#running = undefined;
    this.#setBusy(false);
    this.opened = this.sent = this.loaded = this.kept = undefined;
    this.#leaveJob();
    this.#viewing.close();
    for (const id of ['job', 'opened']) show($(id), false);
    clearProblem();
    this.onClose?.();
  }

  /** Shows the map of another lambda of the job. */
  #choose(lambda: number): void {
    const {job} = this;
    if (!job) return;
    $<HTMLSelectElement>('lambda-shown').value = String(lambda);
    void this.#guarded((signal) => this.#show(job, lambda, this.kept?.name ?? job.id, signal));
  }

  #leaveJob(): void {
    this.job = undefined;
    this.#gallery.hide();
    show($('result'), false);
    show($('lambda-row'), false);
  }

  /** Unwraps what is open. */
  async unwrap(options: OptionValues): Promise<void> {
    const {sent, opened} = this;
    if (!sent || !opened) return showMessage('There is no mesh yet', 'Open a mesh first, or drop one on this page.');
    await this.#guarded(async (signal) => {
      this.#leaveJob();
      this.#progress.begin('Sending the mesh…');
      present($('job'));
      const job = await sent.submit(options, {onSent: (share) => this.#progress.sent(share), signal});
      this.asked.set(job.id, {options});
      signal.throwIfAborted();
      this.#visits.enterJob({job: job.id, name: opened.name});
      await this.#follow(job, opened.name, signal);
    });
  }

  /** Packs the islands of the result that is shown again; file: of that result. Where that fails, all stays as it is. */
  async repack(file: SentMesh, options: OptionValues, packed: string, onPacked: () => void): Promise<void> {
    const {kept, loaded} = this;
    if (!kept || !loaded) return;
    await this.#guarded(async (signal) => {
      this.#progress.begin('Sending the result…');
      present($('job'));
      try {
        const job = await file.submit(options, {onSent: (share) => this.#progress.sent(share), signal});
        const end = await this.#end(job, signal);
        const result = end && await loadResult(end, undefined, this.opened?.model, signal);
        signal.throwIfAborted();
        if (!result) return;
        onPacked();
        this.asked.set(job.id, {options, file: packed});
        this.#visits.enterJob({job: job.id, name: kept.name});
        show($('lambda-row'), false);
        this.#gallery.hide();
        this.take(end, {...result, model: withSourcesOf(result.model, loaded.model)}, undefined, kept.name);
        show($('result'), true);
        this.#progress.end('Packed again.');
      } finally {
        if (this.kept === kept && !signal.aborted) this.job = kept.job;
      }
    });
  }

  /** Shows a job by its address, whatever its state. Without a mesh that is open it shows the result alone. */
  async openJob(id: string, name: string): Promise<void> {
    await this.#guarded(async (signal) => {
      this.#leaveJob();
      this.#progress.begin('Asking for the job…');
      present($('job'));
      try {
        await this.#follow(await getJson<Job>(`/v1/jobs/${id}`, signal), name, signal);
      } finally {
        if (this.kept?.job.id !== id && !signal.aborted) this.#leaveResult(); // of another job
      }
    });
  }

  /** No result is shown, but the mesh if one is open. */
  #leaveResult(): void {
    this.loaded = this.kept = undefined;
    this.onClose?.();
    if (this.opened) this.#viewing.open(this.opened.model);
    else this.#viewing.close();
  }


  /** A job that has succeeded; undefined where it was cancelled, which is told. */
  async #end(job: Job, signal: AbortSignal): Promise<Job | undefined> {
    signal.throwIfAborted();
    this.job = job;
    const end = await ended(job, {signal, onProgress: (progress) => this.#progress.on(progress)});
    if (end.state === 'cancelled') return void this.#tellCancelled();
    if (end.problem) throw new UnwrapdError(end.problem);
    this.#progress.tell('Fetching the result…', 1);
    return (this.job = end);
  }

  async #follow(job: Job, name: string, signal: AbortSignal): Promise<void> {
    const end = await this.#end(job, signal);
    if (!end) return;
    const lambdas = [end.options.lambda].flat().filter((lambda) => lambda !== null);
    $('lambda-shown').replaceChildren(...(lambdas.length > 1 ? lambdas : []).map((lambda) => new Option(String(lambda), String(lambda))));
    show($('lambda-row'), lambdas.length > 1);
    await this.#show(end, lambdas.length > 1 ? lambdas[0] : undefined, name, signal);
    present($('result'));
  }

  async #show(job: Job, lambda: number | undefined, name: string, signal: AbortSignal): Promise<void> {
    const loaded = await loadResult(job, lambda, this.opened?.model, signal);
    signal.throwIfAborted();
    this.take(job, loaded, lambda, name);
    this.#gallery.show(job, loaded.report, lambda, (other) => this.#choose(other));
    this.#progress.end(`Done: ${count(loaded.report.charts.length, 'chart')}.`);
  }

  /** Shows a result. live: what is on the page changes in place; a draft has no address and no files. */
  take(job: Job, loaded: Loaded, lambda: number | undefined, name: string, kind: 'whole' | 'live' | 'draft' = 'whole'): void {
    const {report, model} = loaded;
    if (kind === 'live') this.#visits.changeJob({job: job.id, name});
    if (kind !== 'whole') {
      show($('lambda-row'), false);
      this.#gallery.hide();
    }
    const {width, height} = report.page;
    const what = this.#viewing.result(model, {
      aspect: width / height, pages: report.pages, isTurned: report.repairs.some((repair) => repair.kind === 'faces_turned'),
      mayOverlap: kind !== 'draft' && report.overlaps !== 0, ofAny: Boolean(report.options.repack_only),
      asset: kind !== 'draft' && /\.(glb|gltf)$/i.test(name) ? () => loadAsset(job, lambda) : undefined,
    });
    if (kind !== 'draft') {
      this.job = job;
      this.loaded = loaded;
      this.kept = {job, report, lambda, what, name};
    }
    showFigures(report);
    listCharts(this.#viewing.charts, ({island}) => {
      this.#viewing.viewer.selectIsland(island);
      $('views').scrollIntoView({block: 'nearest'});
    });
    if (kind === 'draft') $('downloads').replaceChildren('This is a draft. Let the slider go for a result.');
    else listDownloads(this.kept!, showProblem);
    if (kind !== 'draft' && this.#viewing.isBlank) showPictures(this.kept!).catch(showProblem);
    this.onResult?.();
  }

  async #cancel(): Promise<void> {
    const {job} = this;
    if (!job || hasEnded(job)) return this.#abort();
    await cancel(job).catch(showProblem);
  }

  #abort(): void {
    this.#running?.abort(new DOMException('', 'AbortError'));
  }

  #setBusy(isBusy: boolean): void {
    $<HTMLButtonElement>('send').disabled = isBusy;
    show($('cancel'), isBusy);
  }

  #tellCancelled(): void {
    show($('job'), false);
    showMessage('Cancelled', `The job was stopped${this.opened ? ', as you asked. The mesh and the options are still here' : ''}.`);
  }

  /** Runs one thing at a time, with the buttons and messages that belong to it. */
  async #guarded(action: (signal: AbortSignal) => Promise<void>): Promise<void> {
    this.#abort();
    this.#last = action;
    const running = (this.#running = new AbortController());
    clearProblem();
    this.#setBusy(true);
    try {
      await action(running.signal);
    } catch (error) {
      if (running === this.#running) this.#fail(error, running.signal);
    } finally {
      if (running === this.#running) this.#setBusy(false);
    }
  }

  #fail(error: unknown, signal: AbortSignal): void {
    if (signal.aborted || (error instanceof UnwrapdError && error.code === 'cancelled')) return this.#tellCancelled();
    show($('job'), false);
    showProblem(error);
  }
}
