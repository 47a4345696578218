// Files come in: chosen, dropped anywhere, or none yet.
import {$, announce, el, present, show} from '../base/dom.js';
import {analyse} from '../analysis/analyse.js';
import {sentences} from '../analysis/words.js';
import {type Named, dropped, named} from '../files/pick.js';
import {type Opened, open} from '../files/read.js';
import type {Viewing} from './viewing.js';

/** Shows the mesh at once, then what it is. */
export async function showMesh(opened: Opened, viewing: Viewing): Promise<void> {
  const surface = viewing.open(opened.model);
  $('mesh-name').textContent = opened.name;
  const remarks = opened.remarks.map((text) => el('li', {}, text));
  $('analysis').replaceChildren(...remarks, el('li', {}, 'Looking at the mesh…'));
  present($('opened'));
  await new Promise((resolve) => requestAnimationFrame(() => setTimeout(resolve)));
  $('analysis').replaceChildren(...remarks, ...sentences(analyse(opened.model, surface)).map((text) => el('li', {}, text)));
}

/** onOpen: a mesh was read. onError: it could not be. */
export function connectOpening(onOpen: (opened: Opened) => void, onError: (error: unknown) => void): void {
  const input = $<HTMLInputElement>('files');
  let latest = 0;
  let wasShown = false; // a mesh, when the reading began
  const read = async (files: Named[] | Promise<Named[]>) => {
    const mine = (latest += 1);
    wasShown ||= !$('opened').hidden;
    show($('opened'), false);
    announce('Reading the file…');
    const end = (then: () => void) => {
      if (mine !== latest) return;
      show($('opened'), wasShown);
      wasShown = false;
      then();
    };
    try {
      const all = await files;
      if (all.length === 0) return end(() => {});
      const opened = await open(all);
      end(() => onOpen(opened));
    } catch (error) {
      end(() => onError(error));
    }
  };
  input.addEventListener('change', () => {
    void read(named(input.files ?? []));
    input.value = ''; // the same file may be chosen again
  });
  for (const kind of ['dragover', 'dragleave', 'drop'] as const)
    document.addEventListener(kind, (event) => {
      event.preventDefault();
      document.body.classList.toggle('over', kind === 'dragover');
      if (kind === 'drop' && event.dataTransfer) void read(dropped(event.dataTransfer));
    });
}
