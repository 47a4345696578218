// The page: it opens meshes, has them unwrapped by the server that shows it, and shows what came of it.
// It uses nothing but the API that everybody has.
import {Arranging} from './app/arranging.js';
import {Balancing} from './app/balancing.js';
import {Editing} from './app/editing.js';
import {connectOpening, showMesh} from './app/opening.js';
import {showMessage, showProblem} from './app/problem.js';
import {Packing} from './app/packing.js';
import {type Asked, Session} from './app/session.js';
import {Viewing} from './app/viewing.js';
import {Visits} from './app/visits.js';
import {$} from './base/dom.js';
import {isBroken} from './base/permalink.js';
import {withoutExtension} from './base/words.js';
import type {Opened} from './files/read.js';
import {listJobs} from './job/list.js';
import {connection, getJson, setKey} from './job/server.js';
import {connectBalance} from './options/balance.js';
import {OptionsForm} from './options/form.js';
import type {Methods} from './options/types.js';
import {formatOf} from './result/downloads.js';
import {curlOf} from './share/curl.js';
import {connectSharing} from './share/share.js';

interface Limits {
  max_sync_faces: number;
}

async function start(): Promise<void> {
  const viewing = new Viewing(showProblem);
  const visits = new Visits();
  const session = new Session(viewing, visits);
  const openMesh = (opened: Opened) => {
    session.open(opened);
    showMesh(opened, viewing).catch(showProblem);
  };
  connectOpening((opened) => {
    visits.enterMesh(opened);
    openMesh(opened);
  }, showProblem);
  $('key').addEventListener('input', () => setKey($<HTMLInputElement>('key').value));
  const [methods, limits] = await Promise.all([getJson<Methods>('/v1/methods'), getJson<Limits>('/v1/limits')]);
  const form = new OptionsForm(methods);
  const showBalance = (method: string) => ($('balance-row').hidden = method !== 'hybrid');
  form.onMethod = showBalance;
  showBalance(form.method);
  const balancing = new Balancing(session);
  const editing = new Editing(viewing, session);
  const again = (label: string, isDraft: boolean) => {
    try {
      balancing.ask({...form.chosen(), ...editing.keepingCharts(), ...editing.options(true)}, label, isDraft);
    } catch (error) {
      showProblem(error);
    }
  };
  connectBalance((lambda, isDraft) => again(`λ ${lambda}`, isDraft));
  const arranging = new Arranging(viewing, session);
  const packing = new Packing(arranging, session, showProblem);
  packing.chosen = () => form.chosen();
  arranging.pages = () => form.pages;
  editing.islands = arranging;
  session.onClose = () => {
    arranging.reset();
    editing.reset();
    balancing.reset();
  };
  editing.onPins = () => again('Pins', false);
  const run = () => {
    try {
      void session.unwrap({...form.chosen(), ...editing.options()});
    } catch (error) {
      showProblem(error);
    }
  };
  $('form').addEventListener('submit', (event) => {
    event.preventDefault();
    run();
  });
  session.onResult = () => {
    editing.ready();
    packing.ready();
    const asked = session.asked.get(session.job?.id ?? '');
    $('curl-row').hidden = !session.opened || !asked;
    if (session.opened && asked) $<HTMLTextAreaElement>('curl').value = commandOf(session, asked, limits);
  };
  connectSharing(() => session.job, showProblem);
  $('jobs').addEventListener('toggle', () => $<HTMLDetailsElement>('jobs').open && listJobs().catch(showProblem));
  const follow = () => {
    if (isBroken(location.hash)) showMessage('This address names no job', 'The link may have been cut off. Ask for the whole of it.');
    const visit = visits.arrive();
    if (!visit) return;
    const {opened, place, isForgotten} = visit;
    if (!opened) session.close();
    else if (opened !== session.opened || !place) openMesh(opened);
    balancing.reset();
    if (isForgotten) showMessage('This mesh is not open any more', 'The page keeps the last few meshes only. Open it again.');
    if (place) void session.openJob(place.job, place.name);
  };
  addEventListener('popstate', follow);
  $('skip').addEventListener('click', (event) => {
    event.preventDefault(); // the address is the job's
    $('main').focus();
  });
  follow();
}

function commandOf({opened, kept}: Session, {options, file: packed}: Asked, {max_sync_faces: most}: Limits): string {
  const isArchive = opened!.mediaType === 'application/zip' && !packed;
  const file = packed ?? opened!.name;
  const base = withoutExtension(file);
  return curlOf({
    server: connection().server!, options, file: isArchive ? `${base}.zip` : file,
    mediaType: packed ? (packed.endsWith('.obj') ? 'model/obj' : 'model/gltf-binary') : opened!.mediaType,
    result: `${base}.uv.${formatOf(file, kept!.report.options.output) ?? 'glb'}`, isSmall: kept!.report.input.faces <= most,
    needsKey: $<HTMLInputElement>('key').value !== '',
  });
}

start().catch(showProblem);
