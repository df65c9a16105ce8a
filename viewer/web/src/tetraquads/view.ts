// The TetraQuad view: the surface by ray casting, its quadrics to change, and each click asked of the program as well.
import {ask, work} from '../api';
import {choice, download, make, say, slider, table, toggle} from '../dom';
import {jsonInput} from '../opening';
import {saveButtons, saveFile, type SavedFormat} from '../saving';
import type {Tasks} from '../tasks';
import {TetraQuadScene} from './scene';
import {coarseToFine, setTerm, termsOf, TERMS, TETRA_PRESETS, type QuadricDocument, type TetraQuadsState, type Term} from './state';

export type Edit = (change: (state: TetraQuadsState) => void, options?: {group?: string; silent?: boolean}) => void;

export interface TetraFile {
  name: string;
  described: string;
}

interface LoadWords {
  vertices: number;
  tetrahedra: number;
  crossed: number;
  step: number;
  middle: number[];
  lattice: number[][];
}

export class TetraQuadsView {
  readonly stage = make('div', {class: 'patch-stage tetra-stage'});
  readonly element: HTMLElement;
  readonly scene: TetraQuadScene;
  private readonly source;
  private readonly edges;
  private readonly onSurface;
  private readonly cutAxis;
  private readonly cut;
  private readonly askToggle;
  private readonly vertex = make('select', {'aria-label': 'Vertex', change: () => this.edit((s) => { s.vertex = this.vertex.value === '' ? null : this.vertex.value.split(',').map(Number); }, {silent: true})});
  private readonly sliders = new Map<Term, ReturnType<typeof slider>>();
  private readonly editor: HTMLElement;
  private readonly saveQuadrics = make('button', {type: 'button', title: 'The JSON that `retalho reconstruct` makes a model of (docs/tetraquad.md)', click: () => download('quadrics.json', new Blob([JSON.stringify(this.state.document, null, 1)], {type: 'application/json'}))}, 'Save quadrics');
  private readonly facts = make('div', {class: 'readout facts'});
  private readonly readout = make('div', {class: 'readout answer', 'aria-live': 'polite'});
  private readonly words = make('p', {class: 'hint error-words', role: 'alert'});
  private loaded: {words: LoadWords; vertices: Float32Array} | null = null;
  private point: number[] | null = null;
  private made: {cloud: number; resolution: number; words: Record<string, unknown>} | null = null;
  private readonly resolution = slider('Resolution, cubes along the longest side', '', (v) => this.edit((s) => { s.resolution = Math.round(v); }, {group: 'resolution'}));
  private framedFor = '';
  private loadedFor = '';
  private shownVertices = '';

  constructor(private files: TetraFile[], private clouds: TetraFile[], private state: TetraQuadsState, private edit: Edit, private tasks: Tasks) {
    this.scene = new TetraQuadScene(this.stage, (camera) => this.edit((s) => { s.camera = camera; }, {silent: true}), (event) => this.clicked(event));
    this.source = choice('Surface', [['', 'a document of one’s own'], ...files.map((file, k): [string, string] => [`file ${k}`, file.name]), ...clouds.map((file, k): [string, string] => [`cloud ${k}`, `Points: ${file.name}`]), ...TETRA_PRESETS.map(([name], k): [string, string] => [`preset ${k}`, `Example: ${name}`])], (v) => {
      const [kind, k] = v.split(' ');
      if (kind === 'file' || kind === 'cloud') this.openFile(kind, Number(k));
      if (kind === 'preset') this.open(TETRA_PRESETS[Number(k)][1]);
    });
    this.edges = toggle('Edges of the tetrahedra', (on) => this.edit((s) => { s.edges = on; }));
    this.onSurface = toggle('Tetrahedra on the surface', (on) => this.edit((s) => { s.onSurface = on; }));
    this.cutAxis = choice('Cut', [['none', 'whole'], ['x', 'across x'], ['y', 'across y'], ['z', 'across z']], (v) => this.edit((s) => { s.cutAxis = v as TetraQuadsState['cutAxis']; }));
    this.cut = slider('Where, as a share of the box', '', (v) => this.edit((s) => { s.cut = v; }, {group: 'cut'}));
    this.cut.limits(0, 1, 0.005);
    this.resolution.limits(8, 48, 1);
    this.askToggle = toggle('Ask where one clicks', (on) => this.edit((s) => { s.ask = on; }, {silent: true}));
    for (const term of TERMS) {
      const one = slider(term === '1' ? 'constant' : term, '', (v) => this.edit((s) => { if (s.vertex) setTerm(s.document, s.vertex, term, v); }, {group: `term ${term}`}));
      one.limits(-3, 3, 0.01);
      this.sliders.set(term, one);
    }
    this.editor = make('div', {}, make('div', {class: 'row'}, this.vertex), ...[...this.sliders.values()].map((one) => one.element));
    const input = jsonInput(this.tasks, this.words, async (parsed, signal) => {
      const document = parsed as QuadricDocument;
      await ask('/api/tetraquads/load', {document}, signal);
      this.open(document);
    });
    this.element = make('div', {class: 'controls'}, this.source.element, this.resolution.element, this.facts,
      section('Picture', this.edges.element, this.onSurface.element, this.cutAxis.element, this.cut.element),
      section('Question', this.askToggle.element, this.readout),
      section('Quadric of a vertex', this.editor),
      make('div', {class: 'row wrap'}, ...saveButtons((format) => this.save(format)),
        this.saveQuadrics,
        make('button', {type: 'button', click: () => input.click()}, 'Open quadrics'), input), this.words);
  }

  /** A surface or points of the command line. */
  openFile(kind: 'file' | 'cloud', k: number): void {
    this.edit((s) => { Object.assign(s, {file: -1, cloud: -1, [kind]: k, vertex: null, asked: null, camera: null}); });
  }

  open(document: QuadricDocument): void {
    this.edit((s) => { s.file = -1; s.cloud = -1; s.document = structuredClone(document); s.vertex = null; s.asked = null; s.camera = null; });
  }

  private save(format: SavedFormat): void {
    const request = this.request(), {file, cloud} = this.state;
    const name = file >= 0 ? this.files[file].name : cloud >= 0 ? this.clouds[cloud].name : 'tetraquad';
    if (request) saveFile(this.tasks, '/api/tetraquads/save', request, name, format);
  }

  /** What is to be shown now; nothing while the first, coarse reconstruction of a cloud is on its way. */
  private request(): Record<string, unknown> | null {
    if (this.state.cloud >= 0 && this.state.cloud < this.clouds.length) {
      return this.made && this.made.cloud === this.state.cloud ? {cloud: this.made.cloud, resolution: this.made.resolution} : null;
    }
    return this.state.file >= 0 && this.state.file < this.files.length ? {file: this.state.file} : {document: this.state.document};
  }

  show(state: TetraQuadsState, active: boolean): void {
    this.state = state;
    this.stage.hidden = this.element.hidden = !active;
    this.scene.visible(active);
    if (!active) return;
    const wanted = state.cloud >= 0 ? {cloud: state.cloud, resolution: state.resolution} : null;
    this.tasks.want('reconstruct', 'Reconstructing', wanted && JSON.stringify(wanted), async (signal, progress) => {
      for (const resolution of coarseToFine(state.resolution)) {
        const {words} = await work('/api/tetraquads/reconstruct', {cloud: state.cloud, resolution}, (stage, fraction) => progress(`resolution ${resolution}, ${stage}`, fraction), signal);
        this.made = {cloud: state.cloud, resolution, words};
        this.show(this.state, !this.stage.hidden);
      }
    });
    this.resolution.element.hidden = state.cloud < 0;
    this.resolution.show(state.resolution);
    const request = this.request();
    if (request) this.load(request, state);
    const asked = state.asked && request && this.loadedFor === JSON.stringify(request) ? {...request, origin: state.asked.origin, direction: state.asked.direction, ...this.span(state)} : null;
    this.tasks.want('ray', 'Asking', asked && JSON.stringify(asked), async (signal) => this.takeRay((await ask('/api/tetraquads/ray', asked ?? {}, signal)).words));
    if (!state.asked) {
      this.point = null;
      this.readout.replaceChildren();
    }
    this.showControls(state);
  }

  private load(request: Record<string, unknown>, state: TetraQuadsState): void {
    this.tasks.want('tetraquads', 'Reading the quadrics', JSON.stringify(request), async (signal) => {
      const answer = await ask('/api/tetraquads/load', request, signal);
      this.loaded = {words: answer.words as unknown as LoadWords, vertices: answer.arrays.vertices as Float32Array};
      this.scene.take(answer);
      const shape = 'cloud' in request ? `cloud ${request.cloud}` : 'file' in request ? JSON.stringify(request) : JSON.stringify([state.document.tetrahedra, state.document.step, state.document.origin]);
      if (this.framedFor !== shape) {
        this.scene.frame();
        if (this.state.camera) this.scene.setCamera(this.state.camera);
        this.framedFor = shape;
      }
      this.loadedFor = JSON.stringify(request);
      this.show(this.state, !this.stage.hidden);
    });
  }

  private showControls(state: TetraQuadsState): void {
    this.edges.show(state.edges);
    this.onSurface.show(state.onSurface);
    this.cutAxis.show(state.cutAxis);
    this.cut.show(state.cut);
    this.cut.element.hidden = state.cutAxis === 'none';
    this.askToggle.show(state.ask);
    const preset = TETRA_PRESETS.findIndex(([, document]) => JSON.stringify(document) === JSON.stringify(state.document));
    this.source.show(state.cloud >= 0 ? `cloud ${state.cloud}` : state.file >= 0 ? `file ${state.file}` : preset >= 0 ? `preset ${preset}` : '');
    this.showLoaded();
  }

  /** Where on the ray the cut leaves something: the program's ray is bounded as the picture's is. */
  private span(state: TetraQuadsState): {from?: number; to?: number} {
    if (state.cutAxis === 'none' || !state.asked) return {};
    const {normal, offset} = this.scene.cutOf(state), k = normal.indexOf(1);
    const side = offset - state.asked.origin[k], lean = state.asked.direction[k];
    if (lean > 0) return {to: Math.max(0, side / lean)};
    return lean < 0 ? {from: Math.max(0, side / lean)} : {};
  }

  private clicked(event: MouseEvent): void {
    if (!this.state.ask) return;
    const ray = this.scene.ray(event);
    this.edit((s) => { s.asked = ray; });
  }

  private takeRay(words: Record<string, unknown>): void {
    const shader = this.state.asked ? this.scene.shaderHit(this.state.asked) : null;
    if (!words.hit) {
      this.point = null;
      this.readout.replaceChildren(make('p', {}, shader ? 'The program’s ray caster hits nothing here, the picture does.' : 'Nothing is hit here.'));
    } else {
      const point = words.page_point as number[], normal = words.normal as number[] | null;
      this.point = point;
      const rows: [string, string][] = [['point', (words.point as number[]).map((v) => say(v, 6)).join(', ')]];
      if (normal) rows.push(['normal', normal.map((v) => say(v, 4)).join(', ')]);
      rows.push(['tetrahedron', say(words.tet)]);
      rows.push(['the picture’s hit is off by', shader ? `${say(Math.hypot(...point.map((v, k) => v - shader[k])) / (words.cell as number), 3)} of a cell` : 'it hits nothing']);
      this.readout.replaceChildren(table(rows));
    }
    this.scene.show(this.state, this.vertexPlace(), this.point);
  }

  private madeRows(): [string, string][] {
    if (this.state.cloud < 0 || !this.made) return [];
    const {words, resolution} = this.made;
    return [['resolution', say(resolution)], ['points', say(words.points, 9)], ['mean distance of the points', say(words.residual_mean, 4)], ['largest', say(words.residual_max, 4)]];
  }

  private vertexPlace(): number[] | null {
    const {vertex} = this.state;
    if (!this.loaded || !vertex) return null;
    const at = this.loaded.words.lattice.findIndex((l) => l.every((v, k) => v === vertex[k]));
    return at < 0 ? null : [...this.loaded.vertices.subarray(3 * at, 3 * at + 3)];
  }

  private showLoaded(): void {
    if (!this.loaded) return;
    const {words} = this.loaded, {state} = this;
    this.facts.replaceChildren(table([['vertices', say(words.vertices)], ['tetrahedra', say(words.tetrahedra)], ['that the surface may cross', say(words.crossed)], ['step', say(words.step)], ...this.madeRows()]));
    this.editor.hidden = this.saveQuadrics.hidden = state.file >= 0 || state.cloud >= 0;
    const names = JSON.stringify(words.lattice);
    if (names !== this.shownVertices) {
      this.shownVertices = names;
      this.vertex.replaceChildren(make('option', {value: ''}, 'choose a vertex …'), ...words.lattice.map((l) => make('option', {value: l.join(',')}, `vertex ${l.join(', ')}`)));
    }
    this.vertex.value = state.vertex ? state.vertex.join(',') : '';
    const terms = state.vertex ? termsOf(state.document, state.vertex) : {};
    for (const [term, one] of this.sliders) {
      one.element.hidden = state.vertex === null;
      one.show(terms[term] ?? 0);
    }
    this.scene.show(state, this.vertexPlace(), this.point);
  }
}

function section(title: string, ...children: HTMLElement[]): HTMLElement {
  return make('details', {open: true}, make('summary', {}, title), ...children);
}
