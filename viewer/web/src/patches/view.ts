// The triangular-surface view: three space curves, the surface between them, and the parameter triangle beside it.
import {ask, type Answer} from '../api';
import {choice, download, make, say, slider, svg, table, toggle} from '../dom';
import {legend} from '../ramps';
import {jsonInput} from '../opening';
import type {Tasks} from '../tasks';
import {PatchScene} from './scene';
import {boundsOf, editable, movePoint, PATCH_PRESETS, robustRange, type PatchDocument, type PatchesState, type Recovery, type Style, type Vec3} from './state';

export type Edit = (change: (state: PatchesState) => void, options?: {group?: string; silent?: boolean}) => void;

const TRIANGLE = {u: [20, 180], v: [220, 180], w: [120, 12]};  // the corners U, V, W in the drawing

export class PatchesView {
  readonly stage = make('div', {class: 'patch-stage'});
  readonly element: HTMLElement;
  readonly scene: PatchScene;
  private readonly preset;
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

  constructor(first: PatchesState, private edit: Edit, private tasks: Tasks) {
    this.state = first;
    this.scene = new PatchScene(this.stage, {
      drag: (side, index, to) => {
        this.dragging = true;
        this.edit((s) => { movePoint(s.document, side, index, to); s.point = [side, index]; }, {group: `patch ${side} ${index}`});
      },
      dropped: () => { this.dragging = false; this.show(this.state, true); },
      hover: (uv) => { if (!this.dragging) this.edit((s) => { s.cursor = uv; }, {silent: true}); },
      cameraMoved: (camera) => this.edit((s) => { s.camera = camera; }, {silent: true}),
    });
    this.stage.append(this.overlay);
    this.preset = choice('Example', [['', 'choose …'], ...PATCH_PRESETS.map(([name], k): [string, string] => [String(k), name])], (v) => { if (v !== '') this.open(PATCH_PRESETS[Number(v)][1]); });
    this.divisions = slider('Divisions of each side, n', '', (v) => this.edit((s) => { s.divisions = Math.round(v); }, {group: 'divisions'}), true);
    this.divisions.limits(1, 128, 1);
    this.recovery = choice('Recovery', [['barycentric', 'barycentric: flat triangles'], ['spr', 'SPR: the paper’s patches'], ['smooth', 'smooth: exact boundary, C1']], (v) => this.edit((s) => { s.recovery = v as Recovery; }));
    this.style = choice('Colour', [['light', 'light alone'], ['lines', 'parameter lines'], ['zebra', 'zebra'], ['isophotes', 'isophotes'], ['error', 'distance from the exact transfinite surface'], ['gaussian', 'Gaussian curvature'], ['mean', 'mean curvature']], (v) => this.edit((s) => { s.style = v as Style; }));
    this.mesh = toggle('Triangles as drawn', (on) => this.edit((s) => { s.mesh = on; }));
    this.polygons = toggle('Control points', (on) => this.edit((s) => { s.polygons = on; }));
    this.drawTriangle();
    const input = jsonInput(this.tasks, this.words, async (parsed, signal) => {
      const document = editable(parsed);
      if (!document) throw new Error('expected {"patches": [{"sides": [three curves of kind "bezier" with points of three numbers]}]}');
      await ask('/api/patches/compute', {document, divisions: 4, recovery: 'barycentric', colour: 'none'}, signal);
      this.open(document);
    });
    this.element = make('div', {class: 'controls'}, this.preset.element,
      section('Surface', this.divisions.element, this.recovery.element, this.readout),
      section('Picture', this.style.element, this.mesh.element, this.polygons.element),
      section('Parameter triangle', this.triangle as unknown as HTMLElement, this.cursorWords),
      section('Point', this.numbers),
      make('div', {class: 'row wrap'},
        make('button', {type: 'button', title: 'The JSON that `retalho patch` reads', click: () => download('patch.json', new Blob([JSON.stringify(this.fileDocument(), null, 1)], {type: 'application/json'}))}, 'Save patch'),
        make('button', {type: 'button', click: () => input.click()}, 'Open patch'), input), this.words);
  }

  open(document: PatchDocument): void {
    this.edit((s) => { s.document = structuredClone(document); s.point = null; s.cursor = null; s.camera = null; });
  }

  private fileDocument(): unknown {
    return {patches: [{...this.state.document.patches[0], divisions: this.state.divisions}]};
  }

  show(state: PatchesState, active: boolean): void {
    this.state = state;
    this.stage.hidden = this.element.hidden = !active;
    this.scene.visible(active);
    if (!active) return;
    const {centre, size} = boundsOf(state.document);
    this.size = size;
    const shape = JSON.stringify(state.document.patches[0].sides.map((side) => side.points.length)) + state.document.patches[0].name;
    if (this.framedFor !== shape) {
      this.scene.frame(centre, size);
      if (state.camera) this.scene.setCamera(state.camera);
      this.framedFor = shape;
    }
    const colour = state.style === 'error' || state.style === 'gaussian' || state.style === 'mean' ? state.style : 'none';
    const request = {document: state.document, divisions: state.divisions, recovery: state.recovery, colour, dragging: this.dragging};
    this.tasks.want('patch', 'Computing the surface', JSON.stringify(request), async (signal) => this.take(await ask('/api/patches/compute', request, signal), state));
    const cursor = state.cursor ? {document: state.document, divisions: state.divisions, recovery: state.recovery, u: state.cursor[0], v: state.cursor[1]} : null;
    this.tasks.want('cursor', 'Asking', cursor && JSON.stringify(cursor), async (signal) => this.takeCursor(await ask('/api/patches/at', cursor ?? {}, signal)));
    if (!cursor) {
      this.scene.setCursor(null, size);
      this.cursorWords.replaceChildren(make('p', {class: 'hint'}, 'The cursor is where the mouse is, on the surface or in the triangle.'));
    }
    this.preset.show('');
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

  private take(answer: Answer, state: PatchesState): void {
    const {words, arrays} = answer;
    const values = arrays.value as Float32Array | undefined;
    this.range = values ? robustRange(values, state.style !== 'error') : [0, 1];
    this.scene.takeSurface(answer, state.recovery);
    this.scene.show(this.state, this.size, this.range);
    const titles: Partial<Record<Style, [string, string]>> = {error: ['distance from the exact surface', 'units'], gaussian: ['Gaussian curvature', '1/unit²'], mean: ['mean curvature', '1/unit']};
    const title = titles[state.style];
    this.overlay.replaceChildren(...(title && values ? [legend(state.style === 'error' ? 'amount' : 'difference', ...title, ...this.range)] : []));
    this.overlay.hidden = !title;
    const rows: [string, string][] = [['nodes', say(words.nodes)], ['triangles', say(words.triangles)]];
    if (words.boundary_gap !== undefined) rows.push(['boundary gap', say(words.boundary_gap, 4)], ['gradient jump', say(words.gradient_jump, 4)], ['folds', say(words.folds)], ['turned triangles', say(words.turned)]);
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
    if (!state.point) return this.numbers.replaceChildren(make('p', {class: 'hint'}, 'Drag a point of a curve, in the plane of the screen.'));
    const [side, index] = state.point, p = state.document.patches[0].sides[side].points[index];
    this.numbers.replaceChildren(...['x', 'y', 'z'].map((name, k) => {
      const input: HTMLInputElement = make('input', {type: 'number', step: 'any', value: p[k], change: () => {
        const v = Number(input.value);
        if (input.value === '' || !Number.isFinite(v)) return;
        this.edit((s) => { const to = [...s.document.patches[0].sides[side].points[index]] as Vec3; to[k] = v; movePoint(s.document, side, index, to); });
      }});
      return make('div', {class: 'control'}, make('label', {}, `Side ${side + 1}, point ${index + 1}, ${name}`, input));
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
