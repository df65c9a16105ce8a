// The curve view: a document of curves, drawn and changed by hand; every number and every line is the program's.
import {ask} from '../api';
import {choice, download, make, say, slider, svgFile, svgPicture, table, toggle} from '../dom';
import {jsonInput} from '../opening';
import type {Tasks} from '../tasks';
import {CurveCanvas, emptyWords} from './canvas';
import {addPoint, boxOf, chosen, growable, moveTo, NEW_KINDS, PRESETS, removePoint, rounded, snapped, type CurveDocument, type CurvesState, type Drawn} from './state';

export interface CurveFile {
  name: string;
  described: string;
  document: CurveDocument;
}

export type Edit = (change: (state: CurvesState) => void, options?: {group?: string; silent?: boolean}) => void;

export class CurvesView {
  readonly stage = make('div', {class: 'curve-stage'});
  readonly element: HTMLElement;
  private readonly canvas: CurveCanvas;
  private readonly preset;
  private readonly curve = make('select', {'aria-label': 'Curve', change: () => this.edit((s) => { s.selected = Number(this.curve.value); s.point = -1; })});
  private readonly kind;
  private readonly t;
  private readonly combScale;
  private readonly snap;
  private readonly toggles: Record<string, ReturnType<typeof toggle>> = {};
  private readonly tools = new Map<string, HTMLButtonElement>();
  private readonly numbers = make('div', {});
  private readonly readout = make('div', {class: 'readout', 'aria-live': 'polite'});
  private readonly words = make('p', {class: 'hint error-words', role: 'alert'});
  private drawn: Drawn[] = [];
  private state: CurvesState;
  private box: number[] = [-1, -1, 1, 1];
  private framedFor = '';

  constructor(private files: CurveFile[], first: CurvesState, private edit: Edit, private tasks: Tasks) {
    this.state = first;
    this.canvas = new CurveCanvas({
      drag: (index, [x, y], tangent) => this.edit((s) => {
        const spec = chosen(s);
        if (!spec?.points) return;
        if (!tangent) return moveTo(spec, index, snapped(x, s.snap), snapped(y, s.snap));
        const p = spec.points[index], v = spec.tangents?.[index];
        if (v) [v[0], v[1]] = [rounded(3 * (snapped(x, s.snap) - p[0])), rounded(3 * (snapped(y, s.snap) - p[1]))];
      }, {group: `drag ${index} ${tangent}`}),
      select: (curve, point) => this.edit((s) => { s.selected = curve; s.point = point; }, {silent: true}),
      draw: ([x, y]) => this.edit((s) => {
        const spec = chosen(s);
        if (spec && growable(spec)) addPoint(spec, [snapped(x, s.snap), snapped(y, s.snap)]);
      }),
      window: (box) => this.edit((s) => { s.window = box.map((v) => Number(v.toPrecision(8))); }, {silent: true}),
    });
    this.stage.append(this.canvas.element);
    new ResizeObserver(() => this.draw()).observe(this.stage);

    this.preset = choice('Example', [['', 'curves of one’s own'], ...files.map((file, k): [string, string] => [`file ${k}`, file.name]), ...PRESETS.map(([name], k): [string, string] => [`preset ${k}`, name])], (v) => {
      const [kind, k] = v.split(' ');
      if (kind === 'file') this.openFile(Number(k));
      if (kind === 'preset') this.open(PRESETS[Number(k)][1]);
    });
    this.kind = choice('New curve', [['', 'choose a kind …'], ...NEW_KINDS, ['implicit', 'implicit: f(x, y) = 0'], ['explicit', 'explicit: y = f(x)']], (v) => this.add(v));
    this.t = slider('t', '', (v) => this.edit((s) => { s.t = v; }, {group: 't'}));
    this.t.limits(0, 1, 0.001);
    this.combScale = slider('Comb’s length', '', (v) => this.edit((s) => { s.combScale = v; }, {group: 'comb'}), true);
    this.combScale.limits(0.1, 10);
    this.snap = choice('Snap to', [['0', 'nothing'], ['0.05', '0.05'], ['0.1', '0.1'], ['0.5', '0.5'], ['1', '1']], (v) => this.edit((s) => { s.snap = Number(v); }));
    for (const [name, words] of [['polygon', 'Control polygons'], ['casteljau', 'De Casteljau at t'], ['comb', 'Curvature comb'], ['hodograph', 'Hodograph'], ['joins', 'Joins and inflections']] as const) {
      this.toggles[name] = toggle(words, (on) => this.edit((s) => { s[name] = on; }));
    }
    const toolBar = make('div', {class: 'tools', role: 'group', 'aria-label': 'Tool'});
    for (const [tool, words, hint] of [['move', 'Move', 'Drag points; drag beside them moves the drawing, the wheel zooms'], ['draw', 'Draw', 'Each click adds a point to the chosen curve']] as const) {
      const button = make('button', {type: 'button', title: hint, click: () => this.edit((s) => { s.tool = tool; }, {silent: true})}, words);
      this.tools.set(tool, button);
      toolBar.append(button);
    }
    const button = (words: string, hint: string, click: () => void) => make('button', {type: 'button', title: hint, click}, words);
    const input = jsonInput(this.tasks, this.words, async (parsed, signal) => {
      const document = parsed as CurveDocument;
      await ask('/api/curves/compute', {document}, signal);
      this.open(document);
    });
    this.element = make('div', {class: 'controls'},
      this.preset.element, make('div', {class: 'row'}, this.curve), this.kind.element, toolBar, this.snap.element,
      section('Show', ...Object.values(this.toggles).map((one) => one.element), this.t.element, this.combScale.element),
      section('Change', make('div', {class: 'row wrap'},
        button('Split at t', 'Exact: the shape stays', () => this.change('split')),
        button('Raise degree', 'Exact: the shape stays', () => this.change('elevate')),
        button('As Bézier', 'The same curve by its Bézier points', () => this.change('bezier')),
        button('Remove curve', 'Undo brings it back', () => this.edit((s) => { s.document.curves.splice(s.selected, 1); s.selected = Math.max(0, s.selected - 1); s.point = -1; }))), this.numbers, this.words),
      section('Numbers', this.readout),
      make('div', {class: 'row wrap'},
        button('Save curves', 'The JSON that `retalho curve` reads', () => download('curves.json', new Blob([JSON.stringify(this.state.document, null, 1)], {type: 'application/json'}))),
        button('Open curves', 'The JSON that `retalho curve` reads', () => input.click()), input,
        button('Save SVG', 'The drawing', () => download('curves.svg', svgFile(this.canvas.element))),
        button('Whole drawing', 'Shows everything', () => this.edit((s) => { s.window = null; }, {silent: true}))));
    this.stage.addEventListener('keydown', (event) => {
      if (event.key !== 'Delete' && event.key !== 'Backspace') return;
      this.edit((s) => { const spec = chosen(s); if (spec && removePoint(spec, s.point)) s.point = -1; });
    });
  }

  open(document: CurveDocument): void {
    this.edit((s) => { s.document = structuredClone(document); s.selected = 0; s.point = -1; s.window = null; });
  }

  /** The drawing as it is now, as a PNG. */
  picture(): Promise<Blob | null> {
    return svgPicture(this.canvas.element, getComputedStyle(this.stage).backgroundColor);
  }

  openFile(k: number): void {
    this.open(this.files[k].document);
  }

  private add(kind: string): void {
    if (kind === '') return;
    this.edit((s) => {
      const [x0, y0, x1, y1] = this.box, x = (a: number) => rounded(Number((x0 + (x1 - x0) * a).toPrecision(3))), y = (a: number) => rounded(Number((y0 + (y1 - y0) * a).toPrecision(3)));
      if (kind === 'implicit') s.document.curves.push({kind, name: 'implicit', f: 'x^2 + y^2 - 1', box: [x(0.05), y(0.05), x(0.95), y(0.95)]});
      else if (kind === 'explicit') s.document.curves.push({kind, name: 'explicit', f: 'sin(3*x)', from: x(0.1), to: x(0.9)});
      else s.document.curves.push({kind, name: kind, points: [[x(0.3), y(0.4)], [x(0.7), y(0.6)]]});
      s.selected = s.document.curves.length - 1;
      s.point = -1;
      s.tool = kind === 'implicit' || kind === 'explicit' ? 'move' : 'draw';
    });
  }

  private change(what: string): void {
    const {document, selected, t} = this.state;
    this.words.textContent = '';
    this.tasks.once('change', 'Changing the curve', async (signal) => {
      try {
        const {words} = await ask('/api/curves/change', {document, curve: selected, what, t}, signal);
        this.edit((s) => { s.document = words.document as CurveDocument; s.point = -1; });
      } catch (error) {
        if (!signal.aborted) this.words.textContent = error instanceof Error ? error.message : String(error);
      }
    });
  }

  show(state: CurvesState, active: boolean): void {
    this.state = state;
    this.stage.hidden = this.element.hidden = !active;
    if (!active) return;
    const request = {document: state.document, t: state.t, comb: state.comb, hodograph: state.hodograph};
    const empty = state.document.curves.length === 0;
    this.tasks.want('curves', 'Drawing', empty ? null : JSON.stringify(request), async (signal) => {
      this.drawn = (await ask('/api/curves/compute', request, signal)).words.curves as Drawn[];
      this.draw();
      this.say();
    });
    if (empty) this.drawn = [];
    this.showControls(state);
    this.draw();
    this.say();
  }

  private draw(): void {
    if (this.stage.hidden) return;
    // The drawing is framed anew for another document, and stays where it is while points are dragged.
    const about = JSON.stringify(this.state.document.curves.map((spec) => [spec.kind, spec.points?.length, spec.name, spec.box]));
    if (this.state.window) this.box = this.state.window;
    else if (this.framedFor !== about || !this.drawn.length) this.box = boxOf(this.state, this.drawn);
    if (this.drawn.length === this.state.document.curves.length) this.framedFor = this.state.window ? '' : about;
    this.canvas.show(this.state, this.drawn, this.box);
  }

  private showControls(state: CurvesState): void {
    const same = (document: CurveDocument) => JSON.stringify(document) === JSON.stringify(state.document);
    const file = this.files.findIndex((one) => same(one.document)), preset = PRESETS.findIndex(([, document]) => same(document));
    this.preset.show(file >= 0 ? `file ${file}` : preset >= 0 ? `preset ${preset}` : '');
    this.kind.show('');
    this.curve.replaceChildren(...state.document.curves.map((spec, k) => make('option', {value: k}, `${k + 1}: ${spec.name || spec.kind}`)));
    this.curve.value = String(state.selected);
    this.t.show(state.t);
    this.combScale.show(state.combScale);
    this.combScale.element.hidden = !state.comb;
    this.snap.show(String(state.snap));
    for (const name of ['polygon', 'casteljau', 'comb', 'hodograph', 'joins'] as const) this.toggles[name].show(state[name]);
    for (const [tool, button] of this.tools) button.setAttribute('aria-pressed', String(tool === state.tool));
    const drawing = this.tools.get('draw');
    if (drawing) drawing.disabled = !growable(chosen(state));
    this.showNumbers(state);
  }

  /** The chosen point, weight and knots, or the formula, as numbers to type. */
  private showNumbers(state: CurvesState): void {
    if (this.numbers.contains(document.activeElement)) return;
    const spec = chosen(state), rows: HTMLElement[] = [];
    const field = (words: string, value: string, set: (text: string) => void, type = 'number') => {
      const input: HTMLInputElement = make('input', {type, value, step: 'any', change: () => set(input.value)});
      rows.push(make('div', {class: 'control'}, make('label', {}, words, input)));
    };
    const p = spec?.points?.[state.point];
    const change = (set: (spec: NonNullable<ReturnType<typeof chosen>>) => void) => this.edit((s) => { const one = chosen(s); if (one) set(one); });
    if (p) {
      field(`Point ${state.point + 1}, x`, String(p[0]), (v) => change((one) => moveTo(one, state.point, Number(v), p[1])));
      field(`Point ${state.point + 1}, y`, String(p[1]), (v) => change((one) => moveTo(one, state.point, p[0], Number(v))));
      if (spec?.kind === 'bspline' || spec?.kind === 'bezier') field('Its weight', String(spec.weights?.[state.point] ?? 1), (v) => change((one) => {
        const weights = one.weights ?? (one.points ?? []).map(() => 1);
        weights[state.point] = Number(v);
        if (weights.every((w) => w === 1)) delete one.weights;
        else one.weights = weights;
      }));
    }
    if (spec?.knots) field('Knots', spec.knots.join(' '), (v) => change((one) => { one.knots = v.trim().split(/[\s,]+/).map(Number); }), 'text');
    if (spec?.f !== undefined) field(spec.kind === 'implicit' ? 'f(x, y) = 0' : 'y = f(x)', spec.f, (v) => change((one) => { one.f = v; }), 'text');
    if (spec?.from !== undefined) {
      field('from', String(spec.from), (v) => change((one) => { one.from = Number(v); }));
      field('to', String(spec.to), (v) => change((one) => { one.to = Number(v); }));
    }
    if (spec?.box) field('Box: x0 y0 x1 y1', spec.box.join(' '), (v) => change((one) => { one.box = v.trim().split(/[\s,]+/).map(Number); }), 'text');
    this.numbers.replaceChildren(...rows);
  }

  private say(): void {
    const curve = this.drawn[this.state.selected];
    if (!curve) return this.readout.replaceChildren(emptyWords());
    if (curve.error) return this.readout.replaceChildren(make('p', {class: 'error-words'}, curve.error));
    const rows: [string, string][] = [['kind', curve.kind]];
    if (curve.degree !== undefined) rows.push(['degree', say(curve.degree)], ['segments', say(curve.segments)], ['length', say(curve.length, 8)]);
    if (curve.casteljau) rows.push(['point at t', curve.casteljau.point.map((v) => say(v, 7)).join(', ')], ['derivative', curve.casteljau.derivative.map((v) => say(v, 6)).join(', ')], ['curvature', say(curve.casteljau.curvature, 6)]);
    if (curve.certified !== undefined) rows.push(['proved everywhere', curve.certified ? 'yes' : 'no: cells are shown']);
    if (curve.breaks?.length) rows.push(['not continuous at x =', curve.breaks.map((v) => say(v, 5)).join(', ')]);
    const children: HTMLElement[] = [table(rows)];
    if (curve.dimension === 3) children.push(make('p', {class: 'hint'}, 'In space: seen from above. The length is the curve’s own.'));
    if (curve.joins?.length) {
      children.push(make('table', {class: 'joins'}, make('thead', {}, make('tr', {}, ...['at', 'C', 'G', 'gap', 'angle °', 'Δ curvature', 'kind'].map((words) => make('th', {}, words)))),
        make('tbody', {}, ...curve.joins.map((j) => make('tr', {}, ...[say(j.at, 4), j.C, j.G, say(j.gap, 3), say(j.angle, 4), say(j.curvature_gap, 3), j.kind].map((text) => make('td', {}, text)))))));
    }
    this.readout.replaceChildren(...children);
  }
}

function section(title: string, ...children: HTMLElement[]): HTMLElement {
  return make('details', {open: true}, make('summary', {}, title), ...children);
}
