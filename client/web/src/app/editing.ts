// Seams and pins by hand, and the balance while it is dragged: each leads to another job of the mesh.
import {$, announce, el, show} from '../base/dom.js';
import {count} from '../base/words.js';
import {Pins} from '../edit/pins.js';
import {SeamMarks} from '../edit/seams.js';
import {type SeamPath, seamsOf, vertexOf} from '../edit/vertices.js';
import type {OptionValues} from '../job/run.js';
import type {Surface} from '../mesh/surface.js';
import {flat} from '../view/flat.js';
import {nearestCorner} from '../view/pick.js';
import type {Session} from './session.js';
import type {Viewing} from './viewing.js';

const REACH = 14; // pixels from a pin at which it is taken

/** What is marked along edges: seams, or edges that are kept from them. */
type Marked = 'seams' | 'keep';
type Mode = 'look' | Marked | 'pins' | 'islands';

const PURPOSES: Record<Marked, string> = {
  seams: 'Unwrap cuts along these edges.',
  keep: 'Unwrap finds other charts, and no seam runs along these edges. It may cross them.',
};

export class Editing {
  readonly #viewing: Viewing;
  readonly #session: Session;
  readonly #pins = new Pins();
  /** Takes drags of islands. */
  islands?: {
    grab(island: number | undefined, at: [number, number], turns: boolean): boolean;
    drag(at: [number, number], ends: boolean): void;
  };
  /** Another solve is wanted, since a pin was moved. */
  onPins?: () => void;
  #marks: Partial<Record<Marked, SeamMarks>> = {};
  #surface: Surface | undefined;
  #dragged = -1;

  constructor(viewing: Viewing, session: Session) {
    [this.#viewing, this.#session] = [viewing, session];
    const {viewer} = viewing;
    for (const mode of ['look', 'seams', 'keep', 'pins', 'islands']) $(`edit-${mode}`).addEventListener('change', () => this.#showMode());
    viewer.onClick = (view, event) => this.#click(view, event);
    viewer.flat.onGrab = (event) => this.#grab(event);
    viewer.flat.onDrag = (u, v, ends) => this.#drag([u, v], ends);
    const onClick = (id: string, action: () => void) => $(id).addEventListener('click', () => {
      action();
      this.#draw();
    });
    onClick('seam-ring', () => this.#shownMarks?.ring() || announce('Mark an edge first. Click two points.'));
    const angle = () => Number($<HTMLInputElement>('crease-angle').value);
    onClick('seam-crease', () => this.#shownMarks?.followCrease(angle()) || announce('Mark an edge of a crease first. Click its two ends.'));
    onClick('seam-creases', () => this.#ownMarks()?.markCreases(angle()) || announce('The mesh has no edge that sharp. Try fewer degrees.'));
    onClick('seam-lift', () => this.#shownMarks?.lift());
    onClick('seam-undo', () => this.#shownMarks?.undo());
    onClick('seam-clear', () => this.#shownMarks?.clear());
    onClick('pins-clear', () => this.#pins.clear());
  }

  get #mode(): Mode {
    return document.querySelector<HTMLInputElement>('input[name=edit]:checked')!.value as Mode;
  }

  /** What a click on the mesh marks. */
  get #marked(): Marked | undefined {
    const mode = this.#mode;
    return mode === 'seams' || mode === 'keep' ? mode : undefined;
  }

  get #shownMarks(): SeamMarks | undefined {
    return this.#marked && this.#marks[this.#marked];
  }

  /** Another mesh: nothing of the last one counts. */
  reset(): void {
    this.#marks = {};
    this.#surface = undefined;
    this.#pins.clear();
    $<HTMLInputElement>('edit-look').checked = true;
    show($('edit'), false);
    this.#showMode();
  }

  /** A result is shown, which can be edited. */
  ready(): void {
    const surface = this.#viewing.viewer.what?.surface;
    const isOpen = Boolean(this.#session.sent);
    show($('edit'), Boolean(this.#session.loaded));
    show($('edit-closed'), !isOpen);
    for (const mode of ['seams', 'keep', 'pins']) $<HTMLInputElement>(`edit-${mode}`).disabled = !isOpen;
    if (surface !== this.#surface) this.#marks = {};
    this.#surface = surface;
    this.#draw();
  }

  /** Options that leave the charts as they are. */
  keepingCharts(): OptionValues {
    const {loaded, kept} = this.#session;
    return loaded && kept?.what.map ? {seams: 'none', seam_edges: seamsOf(kept.what.map, kept.what.surface, loaded.model)} : {};
  }

  #optionOf(marked: Marked): SeamPath[] {
    const {loaded} = this.#session;
    return (loaded && this.#marks[marked]?.asOption(loaded.model)) ?? [];
  }

  /** What the edits add to the options of the form. Edges are kept where charts are sought, not where those that are there stay. */
  options(keepsCharts = false): OptionValues {
    const [marked, pinned] = [this.#optionOf('seams'), this.#pins.asOption()];
    const stay = keepsCharts || pinned.length > 0;
    const kept = stay ? [] : this.#optionOf('keep');
    if (marked.length + kept.length + pinned.length === 0) return {};
    const keeps = stay || (kept.length === 0 && $<HTMLInputElement>('keep-charts').checked) ? this.keepingCharts() : {};
    const edges = [...((keeps['seam_edges'] as object[] | undefined) ?? []), ...marked];
    return {
      ...keeps, ...(edges.length > 0 ? {seam_edges: edges} : {}), ...(kept.length > 0 ? {keep_edges: kept} : {}),
      ...(pinned.length > 0 ? {constraints: pinned} : {}),
    };
  }

  #showMode(): void {
    show($('seam-tools'), Boolean(this.#marked));
    show($('keep-charts-row'), this.#marked === 'seams');
    $('seam-purpose').textContent = this.#marked ? PURPOSES[this.#marked] : '';
    show($('pin-tools'), this.#mode === 'pins');
    show($('island-tools'), this.#mode === 'islands');
    this.#draw();
  }

  #click(view: 'solid' | 'flat', event: MouseEvent | undefined): boolean {
    if (this.#marked && view === 'solid') this.#markAt(event);
    else if (this.#mode === 'pins' && view === 'flat') this.#pinAt(event);
    else return false;
    return true;
  }

  #islandAt(event: PointerEvent): number | undefined {
    const {viewer} = this.#viewing;
    const face = viewer.flat.hit(event);
    return face < 0 ? undefined : viewer.what?.map?.island[face];
  }

  #ownMarks(): SeamMarks | undefined {
    const marked = this.#marked;
    if (marked && this.#surface) this.#marks[marked] ??= new SeamMarks(this.#surface);
    return this.#shownMarks;
  }

  #markAt(event: MouseEvent | undefined): void {
    const hit = this.#viewing.viewer.solid.hit(event);
    const surface = this.#surface;
    if (!hit || !surface) return;
    const corner = nearestCorner(surface.positions, 3, hit.face, hit.point);
    if (!this.#ownMarks()!.add(surface.points[corner]!)) announce('No path along edges leads there. A new path begins.');
    this.#draw();
  }

  /** The corner of the layout at an event; -1 for none. */
  #cornerAt(event: MouseEvent | undefined): number {
    const {viewer} = this.#viewing;
    const face = viewer.flat.hit(event);
    return face < 0 ? -1 : nearestCorner(viewer.what!.map!.uv, 2, face, viewer.flat.uvAt(event));
  }

  #pinAt(event: MouseEvent | undefined): number {
    const corner = this.#cornerAt(event);
    const {what} = this.#viewing.viewer;
    if (corner < 0 || !what?.map || !this.#session.loaded) return -1;
    const vertex = vertexOf(corner, what.surface, this.#session.loaded.model);
    const number = this.#pins.add(vertex, [what.map.uv[2 * corner]!, what.map.uv[2 * corner + 1]!]);
    this.#draw();
    return number;
  }

  #grab(event: PointerEvent): boolean {
    const {viewer} = this.#viewing;
    if (this.#mode === 'islands') return this.islands?.grab(this.#islandAt(event), viewer.flat.uvAt(event), event.shiftKey) ?? false;
    if (this.#mode !== 'pins') return false;
    this.#dragged = this.#pins.near(viewer.flat.uvAt(event), viewer.flat.lengthOf(REACH), viewer.what?.aspect ?? 1);
    return this.#dragged >= 0;
  }

  #drag(uv: [number, number], ends: boolean): void {
    if (this.#mode === 'islands') return this.islands?.drag(uv, ends);
    this.#pins.move(this.#dragged, uv);
    this.#draw();
    if (ends) this.onPins?.();
  }

  #draw(): void {
    const {viewer} = this.#viewing;
    const marks = this.#shownMarks;
    viewer.solid.setEdits(marks?.lines() ?? new Float32Array());
    viewer.solid.setDots(marks?.dots() ?? new Float32Array());
    const pins = this.#mode === 'pins' ? this.#pins.all.flatMap(({uv}) => uv) : [];
    viewer.flat.setDots(flat(pins, viewer.what?.aspect ?? 1, 3));
    const [edges, paths] = [marks?.edges ?? 0, marks?.paths ?? 0];
    const begun = marks?.isBegun ? ` ${edges > 0 ? 'The next click goes on from the last.' : 'A path begins here. Click where it shall lead.'}` : '';
    const waits = this.#marked === 'keep' && edges > 0 && this.#pins.all.length > 0 ? ' They count once there is no pin: pins keep the present charts.' : '';
    $('seam-count').textContent = (edges > 0 ? `${count(edges, 'edge')} marked in ${count(paths, 'path')}.` : 'No edges marked.') + waits + begun;
    this.#listPins();
  }

  /** Rows are made anew for other pins alone: fields that are in use stay. */
  #listPins(): void {
    const list = $('pin-list');
    const vertices = this.#pins.all.map(({mesh, vertex}) => `${mesh} ${vertex}`).join();
    if (list.dataset['of'] !== vertices) list.replaceChildren(...this.#pins.all.map((_, number) => this.#rowOf(number)));
    list.dataset['of'] = vertices;
    for (const [number, {uv}] of this.#pins.all.entries())
      for (const axis of [0, 1]) {
        const input = $<HTMLInputElement>(`pin-${number}-${'UV'[axis]}`);
        if (input !== document.activeElement) input.value = uv[axis]!.toFixed(4);
      }
  }

  #rowOf(number: number): HTMLElement {
    const fields = [0, 1].flatMap((axis) => {
      const name = 'UV'[axis]!;
      const input = el('input', {type: 'number', step: '0.01', id: `pin-${number}-${name}`});
      input.addEventListener('change', () => {
        const moved: [number, number] = [...this.#pins.all[number]!.uv];
        moved[axis] = Number(input.value);
        this.#pins.move(number, moved);
        this.#draw();
        this.onPins?.();
      });
      return [el('label', {htmlFor: input.id}, name), input];
    });
    const remove = el('button', {type: 'button', aria: {label: `Remove pin ${number + 1}`}}, 'Remove');
    remove.addEventListener('click', () => {
      this.#pins.remove(number);
      this.#draw();
      $('edit-pins').focus();
    });
    return el('li', {className: 'pin'}, `Vertex ${this.#pins.all[number]!.vertex}`, ...fields, remove);
  }
}
