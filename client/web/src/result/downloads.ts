// Files of a job, as downloads.
import {$, el, save} from '../base/dom.js';
import {extensionOf, withoutExtension} from '../base/words.js';
import type {Job, Report} from '../job/run.js';
import {getBlob} from '../job/server.js';
import type {Shown} from '../view/paint.js';
import {ofLambda} from './load.js';
import {templateOf} from './template.js';

interface File {
  label: string;
  ending: string;
  get: () => Promise<Blob>;
}

const FORMATS = [['GLB', 'glb', 'model/gltf-binary'], ['glTF', 'gltf', 'model/gltf+json'], ['OBJ', 'obj', 'model/obj']] as const;

export interface Kept {
  job: Job;
  report: Report;
  lambda: number | undefined;
  what: Shown;
  /** Of the mesh's file. */
  name: string;
}

function filesOf({job, report, lambda, what}: Kept): File[] {
  const {links} = job;
  const {width, height} = report.page;
  return [
    ...FORMATS.map(([label, ending, type]) => ({label, ending: `uv.${ending}`, get: () => getBlob(links.result + ofLambda(lambda), type)})),
    {label: 'Report (JSON)', ending: 'report.json', get: () => getBlob(links.report + ofLambda(lambda))},
    {label: 'Layout (SVG)', ending: 'layout.svg', get: () => getBlob(links.layout + ofLambda(lambda))},
    {label: 'Layout (PNG)', ending: 'layout.png', get: () => getBlob(links.layout_png + ofLambda(lambda))},
    {label: 'Template to paint on (SVG)', ending: 'template.svg',
      get: async () => templateOf(what.map!, what.surface, width, height)},
  ];
}

/** How the name of a result ends; undefined where only the server knows. */
export function formatOf(name: string, output: string | undefined): string | undefined {
  if (output && output !== 'auto') return output;
  const own = extensionOf(name);
  return ['stl', 'ply', 'off'].includes(own) ? 'glb' : ['glb', 'gltf', 'obj'].find((format) => format === own);
}

/** The format that the job itself has stands first, as the button that most people want. */
export function listDownloads(kept: Kept, onError: (error: unknown) => void): void {
  const files = filesOf(kept);
  const own = files.find(({ending}) => ending === `uv.${formatOf(kept.name, kept.report.options.output)}`);
  const base = withoutExtension(kept.name);
  const buttons = [...files].sort((a, b) => Number(b === own) - Number(a === own)).map(({label, ending, get}, place) => {
    const button = el('button', {type: 'button', className: place === 0 ? 'primary' : ''}, place === 0 ? `Download ${label}` : label);
    button.addEventListener('click', () => get().then((blob) => save(blob, `${base}.${ending}`)).catch(onError));
    return button;
  });
  $('downloads').replaceChildren(...buttons);
}
