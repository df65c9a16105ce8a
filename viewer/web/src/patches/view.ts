// The triangular-surface view: three space curves, the surface between them, and the parameter triangle beside it.
import {ask, type Answer} from '../api';
import {choice, download, make, say, slider, svg, svgFile, table, toggle} from '../dom';
import {legend} from '../ramps';
import {jsonInput} from '../opening';
import {saveButtons, saveFile, type SavedFormat} from '../saving';
import type {Tasks} from '../tasks';
import {PatchScene} from './scene';
import {boundsOf, boundsOfPoints, handleName, movePoint, PATCH_PRESETS, pointsOf, readDocument, robustRange, snapped, type PatchDocument, type PatchesState, type Recovery, type Style, type Vec3} from './state';

export type Edit = (change: (state: PatchesState) => void, options?: {group?: string; silent?: boolean}) => void;

export interface PatchFile {
  name: string;
  described: string;
  document: unknown;  // null: a model, which is looked at and not changed
}

const TRIANGLE = {u: [20, 180], v: [220, 180], w: [120, 12]};  // the corners U, V, W in the drawing

export class PatchesView {
  readonly stage = make('div', {class: 'patch-stage'});
  readonly element: HTMLElement;
  readonly scene: PatchScene;
  private readonly source;
  private readonly patch;
  private readonly snap;
  private readonly said = make('div', {class: 'unseen', 'aria-live': 'polite'});
  private readonly makes: HTMLElement;
  private readonly saveCurves: HTMLElement;
  private readonly pointPlace: HTMLElement;
  private readonly divisions;
  private readonly recovery;
  private readonly style;
  private readonly mesh;
  private readonly polygons;
  private readonly numbers = make('div', {});
  private readonly readout = make('div', {class: 'readout', 'aria-live': 'polite'});
  private readonly cursorWords = make('div', {class: 'readout cursor-words'});
  private readonly overlay = make('div', {class: 'overlay patch-legend'});
  private readonly words = make('p', {class: 'hint error-words', role: 'alert'});
  private readonly triangle = svg('svg', {class: 'parameters', viewBox: '0 0 240 205', role: 'img', 'aria-label': 'The parameter triangle. A click or a drag sets the cursor.'});
  private readonly dot = svg('circle', {r: 5, class: 'answer'});
  private state: PatchesState;
  private dragging = false;
  private range: [number, number] = [0, 1];
  private framedFor = '';
  private size = 1;

  constructor(private files: PatchFile[], first: PatchesState, private edit: Edit, private tasks: Tasks) {
    this.state = first;
    this.scene = new PatchScene(this.stage, {
      drag: (handle, to) => {
        this.dragging = true;
        this.edit((s) => { movePoint(s.document, handle, snapped(to, s.snap)); s.point = handle; }, {group: `patch ${handle.join(' ')}`});
      },
      dropped: () => {
        if (!this.dragging) return;
        this.dragging = false;
        this.sayPoint();
        this.show(this.state, true);
      },
      focused: (handle) => this.edit((s) => { s.point = handle; }, {silent: true}),
      hover: (patch, uv) => { if (!this.dragging) this.edit((s) => { s.cursor = uv; if (uv) s.patch = patch; }, {silent: true}); },
      cameraMoved: (camera) => this.edit((s) => { s.camera = camera; }, {silent: true}),
    });
    this.stage.append(this.overlay, this.said);
    this.source = choice('Surface shown', [['', 'a document of one’s own'], ...files.map((file, k): [string, string] => [`file ${k}`, file.name]), ...PATCH_PRESETS.map(([name], k): [string, string] => [`preset ${k}`, `Example: ${name}`])], (v) => {
      const [kind, k] = v.split(' ');
      if (kind === 'file') this.openFile(Number(k));
      if (kind === 'preset') this.open(PATCH_PRESETS[Number(k)][1]);
    });
    this.patch = choice('Patch', [['0', '']], (v) => this.edit((s) => { s.patch = Number(v); s.cursor = null; }));
    this.snap = choice('Snap to', [['0', 'nothing'], ['0.05', '0.05'], ['0.1', '0.1'], ['0.5', '0.5'], ['1', '1']], (v) => this.edit((s) => { s.snap = Number(v); }));
    this.divisions = slider('Divisions of each side, n', '', (v) => this.edit((s) => { s.divisions = Math.round(v); }, {group: 'divisions'}), true);
    this.divisions.limits(1, 128, 1);
    this.recovery = choice('Recovery', [['barycentric', 'barycentric: flat triangles'], ['spr', 'SPR: the paper’s patches'], ['smooth', 'smooth: exact boundary, C1']], (v) => this.edit((s) => { s.recovery = v as Recovery; }));
    this.style = choice('Colour', [['light', 'light alone'], ['lines', 'parameter lines'], ['zebra', 'zebra'], ['isophotes', 'isophotes'], ['error', 'distance from the exact transfinite surface'], ['gaussian', 'Gaussian curvature'], ['mean', 'mean curvature']], (v) => this.edit((s) => { s.style = v as Style; }));
    this.mesh = toggle('Triangles as drawn', (on) => this.edit((s) => { s.mesh = on; }));
    this.polygons = toggle('Control points', (on) => this.edit((s) => { s.polygons = on; }));
    this.drawTriangle();
    const input = jsonInput(this.tasks, this.words, async (parsed, signal) => {
      const {document, divisions} = readDocument(parsed);
      await ask('/api/patches/compute', {document, divisions: 4, recovery: 'barycentric', colour: 'none'}, signal);
      this.open(document, divisions);
    });
    this.makes = make('div', {}, this.divisions.element, this.recovery.element);
    this.pointPlace = section('Point', this.snap.element, this.numbers);
    this.element = make('div', {class: 'controls'}, this.source.element,
      section('Surface', this.makes, this.readout),
      section('Picture', this.style.element, this.mesh.element, this.polygons.element),
      section('Parameter triangle', this.patch.element, this.triangle as unknown as HTMLElement, this.cursorWords,
        make('div', {class: 'row'}, make('button', {type: 'button', title: 'The parameter triangle as a drawing', click: () => download('parameters.svg', svgFile(this.triangle))}, 'Save triangle as SVG'))),
      this.pointPlace,
      make('div', {class: 'row wrap'}, ...saveButtons((format) => this.save(format)),
        this.saveCurves = make('button', {type: 'button', title: 'The JSON that `retalho patch` reads', click: () => download('patch.json', new Blob([JSON.stringify(this.fileDocument(), null, 1)], {type: 'application/json'}))}, 'Save patch'),
        make('button', {type: 'button', click: () => input.click()}, 'Open patch'), input), this.words);
  }

  open(document: PatchDocument, divisions: number | null = null): void {
    this.edit((s) => {
      Object.assign(s, {file: -1, document: structuredClone(document), patch: 0, point: null, cursor: null, camera: null});
      if (divisions !== null) s.divisions = Math.min(128, Math.max(1, divisions));
    });
  }
  /** A file of the command line: curves are a document to change, a model is looked at. */
  openFile(k: number): void {
    const {document} = this.files[k];
    if (document === null) return this.edit((s) => { Object.assign(s, {file: k, patch: 0, point: null, cursor: null, camera: null}); });
    const read = readDocument(document);
    this.open(read.document, read.divisions);
  }

  private fileDocument(): unknown {
    const {document, divisions} = this.state;
    return {curves: document.curves, patches: document.patches.map((patch) => ({...patch, divisions}))};
  }

  /** Which patches: a model of the command line, or the document. */
  private what(state: PatchesState): Record<string, unknown> {
    return state.file >= 0 ? {model: state.file} : {document: state.document, divisions: state.divisions, recovery: state.recovery};
  }

  private save(format: SavedFormat): void {
    const {name} = this.state.file >= 0 ? this.files[this.state.file] : this.state.document.patches[0];
    saveFile(this.tasks, '/api/patches/save', this.what(this.state), name, format);
  }

  private sayPoint(): void {
    const {document, point} = this.state;
    if (point) this.said.textContent = `${handleName(document, point)}: ${pointsOf(document.curves[point[0]])[point[1]].map((v) => say(v, 5)).join(', ')}`;
  }

  show(state: PatchesState, active: boolean): void {
    this.state = state;
    this.stage.hidden = this.element.hidden = !active;
    this.scene.visible(active);
    if (!active) return;
    if (state.file < 0) {
      const {centre, size} = boundsOf(state.document);
      this.frame(JSON.stringify([state.document.curves.map((curve) => curve.points?.length), state.document.patches]), centre, size);
    }
    const {size} = this;
    const colour = state.style === 'error' || state.style === 'gaussian' || state.style === 'mean' ? state.style : 'none';
    const request = {...this.what(state), colour, dragging: this.dragging};
    this.tasks.want('patch', 'Computing the surface', JSON.stringify(request), async (signal) => this.take(await ask('/api/patches/compute', request, signal), state));
    const cursor = state.cursor ? {...this.what(state), patch: state.patch, u: state.cursor[0], v: state.cursor[1]} : null;
    this.tasks.want('cursor', 'Asking', cursor && JSON.stringify(cursor), async (signal) => this.takeCursor(await ask('/api/patches/at', cursor ?? {}, signal)));
    if (!cursor) {
      this.scene.setCursor(null, size);
      this.cursorWords.replaceChildren(make('p', {class: 'hint'}, 'The cursor is where the mouse is, on the surface or in the triangle.'));
    }
    const preset = PATCH_PRESETS.findIndex(([, document]) => JSON.stringify(document) === JSON.stringify(state.document));
    this.source.show(state.file >= 0 ? `file ${state.file}` : preset >= 0 ? `preset ${preset}` : '');
    this.makes.hidden = this.polygons.element.hidden = this.pointPlace.hidden = this.saveCurves.hidden = state.file >= 0;
    this.showPatches(state.file >= 0 ? this.names : state.document.patches.map(({name}) => name));
    this.snap.show(String(state.snap));
    this.divisions.show(state.divisions);
    this.recovery.show(state.recovery);
    this.style.show(state.style);
    this.mesh.show(state.mesh);
    this.polygons.show(state.polygons);
    this.dot.setAttribute('visibility', state.cursor ? 'visible' : 'hidden');
    if (state.cursor) {
      const [x, y] = this.toTriangle(...state.cursor);
      this.dot.setAttribute('cx', String(x));
      this.dot.setAttribute('cy', String(y));
    }
    this.scene.show(state, size, this.range);
    this.showPoint(state);
  }

  private frame(shape: string, centre: Vec3, size: number): void {
    this.size = size;
    if (this.framedFor === shape) return;
    this.scene.frame(centre, size);
    if (this.state.camera) this.scene.setCamera(this.state.camera);
    this.framedFor = shape;
  }

  private showPatches(names: string[]): void {
    this.patch.options(names.map((name, k): [string, string] => [String(k), name || `patch ${k + 1}`]));
    this.patch.show(String(this.state.patch));
    this.patch.element.hidden = names.length < 2;
  }
  private names: string[] = [];

  private take(answer: Answer, state: PatchesState): void {
    const {words, arrays} = answer;
    this.names = words.patches as string[];
    if (state.file >= 0) {
      const points: Vec3[] = [], {position} = arrays;
      for (let i = 0; i < position.length; i += 3) points.push([position[i], position[i + 1], position[i + 2]]);
      const {centre, size} = boundsOfPoints(points.length > 20_000 ? points.filter((_, k) => k % Math.ceil(points.length / 20_000) === 0) : points);
      this.frame(`file ${state.file}`, centre, size);
      this.showPatches(this.names);
    }
    const values = arrays.value as Float32Array | undefined;
    this.range = values ? robustRange(values, state.style !== 'error') : [0, 1];
    this.scene.takeSurface(answer);
    this.scene.show(this.state, this.size, this.range);
    const titles: Partial<Record<Style, [string, string]>> = {error: ['distance from the exact surface', 'units'], gaussian: ['Gaussian curvature', '1/unit²'], mean: ['mean curvature', '1/unit']};
    const title = titles[state.style];
    this.overlay.replaceChildren(...(title && values ? [legend(state.style === 'error' ? 'amount' : 'difference', ...title, ...this.range)] : []));
    this.overlay.hidden = !title;
    const rows: [string, string][] = [['nodes', say(words.nodes)], ['triangles', say(words.triangles)]];
    if (words.boundary_gap !== undefined) rows.push(['boundary gap', say(words.boundary_gap, 4)], ['gradient jump', say(words.gradient_jump, 4)], ['folds', say(words.folds)], ['turned triangles', say(words.turned)]);
    const joins = words.joins as {watertight: boolean; angle: number; kind: string}[] | undefined;
    if (joins?.length) rows.push(['shared sides', `${joins.length}, ${joins.every((join) => join.watertight) ? 'all watertight' : `${joins.filter((join) => !join.watertight).length} cracked`}`], ['largest angle over them', `${say(Math.max(...joins.map((join) => join.angle)), 4)}°`]);
    rows.push(['computed in', `${say(1000 * (words.seconds as number), 3)} ms`]);
    this.readout.replaceChildren(table(rows));
  }

  private takeCursor({words}: Answer): void {
    const uv = this.state.cursor;
    if (!uv) return;
    this.scene.setCursor(words.point as Vec3, this.size);
    this.cursorWords.replaceChildren(table([['u, v', `${say(uv[0], 4)}, ${say(uv[1], 4)}`], ['point', (words.point as Vec3).map((v) => say(v, 5)).join(', ')], ['Gaussian', say(words.gaussian, 4)], ['mean', say(words.mean, 4)]]));
  }

  private showPoint(state: PatchesState): void {
    if (this.numbers.contains(document.activeElement)) return;
    const handle = state.point, p = handle ? pointsOf(state.document.curves[handle[0]] ?? {kind: ''})[handle[1]] : undefined;
    if (!handle || !p) return this.numbers.replaceChildren(make('p', {class: 'hint'}, 'Drag a point of a curve, in the plane of the screen; or reach it with Tab and move it with the arrow keys.'));
    this.numbers.replaceChildren(...['x', 'y', 'z'].map((name, k) => {
      const input: HTMLInputElement = make('input', {type: 'number', step: 'any', value: p[k], change: () => {
        const v = Number(input.value);
        if (input.value === '' || !Number.isFinite(v)) return;
        this.edit((s) => { const to = [...pointsOf(s.document.curves[handle[0]])[handle[1]]] as Vec3; to[k] = v; movePoint(s.document, handle, to); });
      }});
      return make('div', {class: 'control'}, make('label', {}, `${handleName(state.document, handle)}, ${name}`, input));
    }));
  }

  private toTriangle(u: number, v: number): [number, number] {
    const w = 1 - u - v;
    return [0, 1].map((k) => u * TRIANGLE.u[k] + v * TRIANGLE.v[k] + w * TRIANGLE.w[k]) as [number, number];
  }

  private drawTriangle(): void {
    const point = ([x, y]: number[]) => `${x},${y}`, t = TRIANGLE;
    this.triangle.append(svg('polygon', {points: [t.u, t.v, t.w].map(point).join(' ')}));
    for (let k = 1; k < 6; ++k) {
      for (const ends of [[[k / 6, 0], [k / 6, 1 - k / 6]], [[0, k / 6], [1 - k / 6, k / 6]]]) {
        const [[x1, y1], [x2, y2]] = ends.map(([u, v]) => this.toTriangle(u, v));
        this.triangle.append(svg('line', {class: 'rule', x1, y1, x2, y2}));
      }
      const [[x1, y1], [x2, y2]] = [this.toTriangle(k / 6, 0), this.toTriangle(0, k / 6)];
      this.triangle.append(svg('line', {class: 'rule', x1, y1, x2, y2}));
    }
    for (const [a, b, side] of [[t.u, t.v, 0], [t.v, t.w, 1], [t.w, t.u, 2]] as const) this.triangle.append(svg('line', {class: `c${[0, 1, 2][side]} side`, x1: a[0], y1: a[1], x2: b[0], y2: b[1]}));
    this.triangle.append(svg('text', {x: t.u[0] - 6, y: t.u[1] + 18}, 'U'), svg('text', {x: t.v[0] - 4, y: t.v[1] + 18}, 'V'), svg('text', {x: t.w[0] + 10, y: t.w[1] + 8}, 'W'), this.dot);
    const set = (event: PointerEvent) => {
      const box = this.triangle.getBoundingClientRect(), scale = Math.max(240 / box.width, 205 / box.height);
      const x = 120 + (event.clientX - box.left - box.width / 2) * scale, y = 102.5 + (event.clientY - box.top - box.height / 2) * scale;
      const w = (t.u[1] - y) / (t.u[1] - t.w[1]), v = (x - t.u[0] - w * (t.w[0] - t.u[0])) / (t.v[0] - t.u[0]), u = 1 - v - w;
      if (u < 0 || v < 0 || w < 0) return;
      this.edit((s) => { s.cursor = [u, v]; }, {silent: true});
    };
    this.triangle.addEventListener('pointermove', set);
    this.triangle.addEventListener('pointerdown', set);
  }
}

function section(title: string, ...children: HTMLElement[]): HTMLElement {
  return make('details', {open: true}, make('summary', {}, title), ...children);
}
