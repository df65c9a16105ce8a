// The terrain's side bar: what the state says, and what changes it.
import {choice, make, slider, toggle} from '../dom';
import {saveButtons, type SavedFormat} from '../saving';
import {FITS, SIDE_BY_SIDE, SURFACES, roundStep, type Colour, type FileInfo, type Fit, type Surface, type TerrainState, type Tool} from './state';

export type Edit = (change: (state: TerrainState) => void, group?: string) => void;

const TOOLS: [Tool, string, string][] = [
  ['look', 'Look', 'Drag turns, right drag moves, the wheel zooms'],
  ['ask', 'Ask', 'Click: height, slope and coordinates'],
  ['profile', 'Profile', 'Click the corners of a line; Enter or a double click ends it'],
  ['viewshed', 'Viewshed', 'Click: what is seen from there'],
];

export class TerrainControls {
  readonly element: HTMLElement;
  readonly readout = make('div', {class: 'readout', 'aria-live': 'polite'});
  private readonly file;
  private readonly budget;
  private readonly error;
  private readonly vertices;
  private readonly layout;
  private readonly panels = make('div', {});
  private readonly colour;
  private readonly triangles;
  private readonly contours;
  private readonly interval;
  private readonly exaggeration;
  private readonly light;
  private readonly eye;
  private readonly radius;
  private readonly snap;
  private readonly planRow: HTMLElement;
  private readonly tools = new Map<Tool, HTMLButtonElement>();
  private readonly go = make('button', {}, 'Ask');
  private readonly hint = make('p', {class: 'hint'});
  private readonly onlyGrids: HTMLElement;
  private shownPanels = '';

  constructor(private files: FileInfo[], private edit: Edit, openFile: (file: number) => void, save: (format: SavedFormat) => void, saveContours: () => void, ask: (x: number, y: number) => void) {
    this.file = choice('Terrain', files.map((info, k): [string, string] => [String(k), info.name]), (v) => openFile(Number(v)));
    this.budget = choice('Fineness by', [['error', 'largest error'], ['vertices', 'number of vertices']], (v) => edit((s) => { s.budget = v as TerrainState['budget']; }));
    this.error = slider('Tolerance', '', (v) => edit((s) => { s.maxError = v; }, 'error'), true);
    this.vertices = slider('Vertices', '', (v) => edit((s) => { s.vertices = Math.round(v); }, 'vertices'), true);
    this.layout = choice('Side by side', [['1', 'one surface'], ['2', 'two surfaces'], ['3', 'flat, the paper’s, ours']], (v) => edit((s) => {
      const n = Number(v);
      s.panels = n === 3 ? SIDE_BY_SIDE.map((p) => ({...p})) : [0, 1].slice(0, n).map((k) => s.panels[k] ?? {...SIDE_BY_SIDE[2]});
      if (n === 2 && s.panels[0].surface === s.panels[1].surface && s.panels[0].fit === s.panels[1].fit) s.panels[0] = {...SIDE_BY_SIDE[0]};
    }));
    this.colour = choice('Colour', [['heights', 'by height'], ['error', 'by error against the grid'], ['slope', 'by slope'], ['plain', 'light alone']], (v) => edit((s) => { s.colour = v as Colour; }));
    this.triangles = toggle('Triangles', (on) => edit((s) => { s.triangles = on; }));
    this.contours = toggle('Contours', (on) => edit((s) => { s.contours = on; }));
    this.interval = slider('Interval', '', (v) => edit((s) => { s.interval = v; s.contours = true; }, 'interval'), true);
    this.exaggeration = slider('Vertical exaggeration of the picture', '', (v) => edit((s) => { s.exaggeration = v; }, 'exaggeration'));
    this.exaggeration.limits(0.5, 5, 0.1);
    this.light = slider('Light from', 'degrees from north', (v) => edit((s) => { s.light = v; }, 'light'));
    this.light.limits(0, 360, 5);
    this.snap = choice('Clicks go to', [['', 'where one clicks'], ['cells', 'the nearest cell’s centre']], (v) => edit((s) => { s.snap = v === 'cells'; }));
    this.planRow = make('div', {class: 'row'}, make('button', {type: 'button', title: 'The contours of the first surface, seen from above', click: saveContours}, 'Save contours as SVG'));
    this.eye = slider('Eye over ground', '', (v) => edit((s) => { s.eye = v; }, 'eye'));
    this.eye.limits(0, 100, 0.5);
    this.radius = slider('Radius (0: no limit)', '', (v) => edit((s) => { s.radius = v; }, 'radius'));

    const toolBar = make('div', {class: 'tools', role: 'group', 'aria-label': 'Tool'});
    for (const [tool, words, hint] of TOOLS) {
      const button = make('button', {type: 'button', title: hint, click: () => edit((s) => {
        s.tool = tool;
        if (tool === 'profile') s.line = [];
      })}, words);
      this.tools.set(tool, button);
      toolBar.append(button);
    }
    const x = make('input', {type: 'number', step: 'any', 'aria-label': 'X in the CRS', placeholder: 'X'});
    const y = make('input', {type: 'number', step: 'any', 'aria-label': 'Y in the CRS', placeholder: 'Y'});
    const byNumbers = make('form', {class: 'row', submit: (event) => {
      event.preventDefault();
      if (x.value !== '' && y.value !== '') ask(Number(x.value), Number(y.value));
    }}, x, y, this.go);
    const clear = make('button', {type: 'button', click: () => edit((s) => { s.asked = null; s.line = []; s.observer = null; })}, 'Clear marks');

    this.onlyGrids = make('div', {}, this.budget.element, this.error.element, this.vertices.element, this.layout.element, this.panels);
    this.element = make('div', {class: 'controls'},
      this.file.element,
      section('Surface', this.onlyGrids, make('div', {class: 'row wrap'}, ...saveButtons(save))),
      section('Picture', this.colour.element, this.triangles.element, this.contours.element, this.interval.element, this.planRow, this.exaggeration.element, this.light.element),
      section('Questions', toolBar, this.hint, this.snap.element, byNumbers, this.eye.element, this.radius.element, clear, this.readout));
  }

  show(state: TerrainState): void {
    const info = this.files[state.file];
    const range = Math.max(info.high - info.low, 1e-6);
    this.file.show(String(state.file));
    this.onlyGrids.hidden = info.kind === 'model';
    this.colour.enable('error', info.kind === 'grid');
    this.budget.show(state.budget);
    this.error.limits(roundStep(range / 5000), range / 2);
    this.error.show(state.maxError);
    this.error.element.hidden = state.budget !== 'error';
    this.vertices.limits(10, Math.max(1000, Math.min(500_000, info.valid ?? 1000)));
    this.vertices.show(state.vertices);
    this.vertices.element.hidden = state.budget !== 'vertices';
    this.layout.show(String(state.panels.length));
    this.showPanels(state);
    this.colour.show(state.colour);
    this.triangles.show(state.triangles);
    this.contours.show(state.contours);
    this.planRow.hidden = !state.contours;
    this.snap.show(state.snap ? 'cells' : '');
    this.snap.element.hidden = info.kind === 'model';
    this.interval.limits(roundStep(range / 500), range / 2);
    this.interval.show(state.interval);
    this.exaggeration.show(state.exaggeration);
    this.light.show(state.light);
    this.eye.show(state.eye);
    this.radius.limits(0, info.cell * Math.max(info.columns ?? 1000, info.rows ?? 1000), 1);
    this.radius.show(state.radius);
    this.eye.element.hidden = this.radius.element.hidden = state.tool !== 'viewshed';
    for (const [tool, button] of this.tools) button.setAttribute('aria-pressed', String(tool === state.tool));
    this.go.textContent = state.tool === 'profile' ? 'Add' : state.tool === 'viewshed' ? 'Look' : 'Ask';
    this.hint.textContent = TOOLS.find(([tool]) => tool === state.tool)?.[2] ?? '';
  }

  /** Says that a click met no surface, until the next thing is shown. */
  missed(yes: boolean): void {
    if (yes) this.hint.textContent = 'There is no terrain there.';
  }

  private showPanels(state: TerrainState): void {
    const now = JSON.stringify(state.panels);
    if (now === this.shownPanels) return;
    this.shownPanels = now;
    this.panels.replaceChildren(...state.panels.map((panel, k) => {
      const surface = choice(state.panels.length > 1 ? `Surface ${k + 1}` : 'Surface', SURFACES, (v) => this.edit((s) => { s.panels[k].surface = v as Surface; }));
      const fit = choice(state.panels.length > 1 ? `Fit ${k + 1}` : 'Fit', FITS, (v) => this.edit((s) => { s.panels[k].fit = v as Fit; }));
      surface.show(panel.surface);
      fit.show(panel.fit);
      return make('div', {class: 'panel-choice'}, surface.element, fit.element);
    }));
  }
}

function section(title: string, ...children: HTMLElement[]): HTMLElement {
  return make('details', {open: true}, make('summary', {}, title), ...children);
}
