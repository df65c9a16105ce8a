// The terrain view: asks the program for what the state says and puts the answers into the picture.
import {ask, work, type Answer} from '../api';
import {download, make, say, svgFile, table} from '../dom';
import {saveFile, type SavedFormat} from '../saving';
import type {Tasks} from '../tasks';
import {TerrainControls, type Edit} from './controls';
import {Panel, type Vec3} from './panel';
import {planDrawing} from './plan';
import {profileChart, type ProfileLine} from './profile';
import {TerrainScene} from './scene';
import {cellCentre, fitRequest, SURFACES, type FileInfo, type Place, type TerrainState} from './state';

/** The profile's line on a surface: places at these distances along its corners. */
function pathOf(line: Place[], distance: Float64Array, height: Float64Array): Float32Array {
  const points: number[] = [];
  let piece = 0, before = 0;
  const length = (k: number) => Math.hypot(line[k + 1][0] - line[k][0], line[k + 1][1] - line[k][1]);
  distance.forEach((d, i) => {
    while (piece + 2 < line.length && d > before + length(piece)) before += length(piece++);
    const t = length(piece) > 0 ? Math.min(1, (d - before) / length(piece)) : 0;
    if (Number.isFinite(height[i])) points.push(line[piece][0] + t * (line[piece + 1][0] - line[piece][0]), line[piece][1] + t * (line[piece + 1][1] - line[piece][1]), height[i]);
  });
  return new Float32Array(points);
}

export class TerrainView {
  readonly stage = make('div', {class: 'terrain'});
  readonly controls: TerrainControls;
  readonly scene: TerrainScene;
  private readonly chart = make('div', {class: 'chart-place'});
  private panels: Panel[] = [];
  private shownFile = -1;
  private state: TerrainState;
  private markedFor = new Map<Panel, {marks: string; path: Float32Array | undefined}>();

  constructor(readonly files: FileInfo[], first: TerrainState, private edit: Edit, private tasks: Tasks, openFile: (file: number) => void, cameraMoved: (camera: number[]) => void) {
    this.state = first;
    this.scene = new TerrainScene(cameraMoved);
    this.controls = new TerrainControls(files, edit, openFile, (format) => this.save(format), () => this.saveContours(), (x, y) => this.askAt(x, y));
    this.stage.append(this.scene.element, this.chart);
    this.scene.canvas.addEventListener('click', (event) => this.clicked(event));
    this.scene.canvas.addEventListener('keydown', (event) => {
      if (event.key === 'Enter' && this.state.tool === 'profile') this.edit((s) => { s.tool = 'look'; });
    });
    this.scene.canvas.addEventListener('dblclick', () => {
      if (this.state.tool === 'profile' && this.state.line.length > 2) this.edit((s) => { s.line.pop(); s.tool = 'look'; });
    });
  }

  show(state: TerrainState, active: boolean): void {
    this.state = state;
    this.scene.visible(active);
    this.stage.hidden = this.controls.element.hidden = !active;
    if (!active) return;
    const info = this.files[state.file];
    while (this.panels.length > state.panels.length) this.panels.pop()?.dispose();
    while (this.panels.length < state.panels.length) this.panels.push(new Panel());
    if (this.scene.element.dataset.panels !== String(this.panels.length)) this.scene.setPanels(this.panels);
    if (this.shownFile !== state.file) {
      const width = info.cell * (info.columns ?? 0), height = info.cell * (info.rows ?? 0);
      if (width > 0) this.scene.frame(width, height, (info.low + info.high) / 2);
      if (state.camera) this.scene.setCamera(state.camera);
      this.shownFile = state.file;
      this.framed = width > 0 || state.camera !== null;
    }
    this.controls.show(state);
    this.canvasCursor();
    this.panels.forEach((_, k) => this.request(k));
    this.requestQuestions();
    this.refresh();
  }
  private framed = true;

  private canvasCursor(): void {
    this.scene.canvas.dataset.tool = this.state.tool;
  }

  /** One panel's surface, and what hangs on it. */
  private request(k: number): void {
    const state = this.state, panel = this.panels[k], info = this.files[state.file];
    const budget = Math.round((this.scene.software ? 18_000 : 240_000) / state.panels.length);
    const wanted = fitRequest(state, state.panels[k], budget);
    const key = JSON.stringify(wanted);
    this.tasks.want(`surface ${k}`, 'Fitting', key, async (signal, progress) => {
      const answer = await work('/api/terrain/fit', this.framed ? {...wanted, ...this.look()} : wanted, progress, signal);
      panel.takeSurface(answer);
      this.tasks.forget(`errors ${k}`);
      this.tasks.forget(`contours ${k}`);
      if (!this.framed) this.frameBySurface(panel);
      this.show(this.state, !this.stage.hidden);
    });
    const model = panel.report && this.fitted.get(panel) !== undefined ? panel.report.model : null;
    this.tasks.want(`errors ${k}`, 'Measuring errors', model && state.colour === 'error' && info.kind === 'grid' ? model : null, async (signal, progress) => {
      panel.takeErrors(await work('/api/terrain/errors', {model, size: 1024}, progress, signal));
      this.refresh();
    });
    // The triangles follow the eye when the camera rests. The surface of flat triangles is drawn as it is.
    const detail = model && (panel.report?.tiles || panel.report?.surface !== 'linear') ? {model, ...this.look(), triangles: budget} : null;
    this.tasks.want(`detail ${k}`, 'Refining what is near', detail && JSON.stringify(detail), async (signal) => {
      panel.takeDetail(await ask('/api/terrain/detail', detail ?? {}, signal));
      this.refresh();
    });
    const lines = model && state.contours ? {model, interval: state.interval} : null;
    this.tasks.want(`contours ${k}`, 'Drawing contours', lines ? JSON.stringify(lines) : null, async (signal, progress) => {
      panel.takeContours(await work('/api/terrain/contours', lines as Record<string, unknown>, progress, signal));
      this.refresh();
    });
    this.fitted.set(panel, key);
  }
  private fitted = new Map<Panel, string>();

  /** The eye, in steps of a twentieth of its distance: small moves ask for nothing. */
  private look(): {eye: number[]; forward: number[]; stretch: number; angle: number} {
    const {eye, forward, angle} = this.scene.look, step = 2 ** Math.round(Math.log2(Math.hypot(...eye.map((v, k) => v - this.scene.target[k])) / 20));
    return {eye: eye.map((v) => Math.round(v / step) * step), forward: forward.map((v) => Math.round(10 * v) / 10), stretch: this.state.exaggeration, angle: Number(angle.toPrecision(2))};
  }

  private frameBySurface(panel: Panel): void {
    panel.surface.geometry.computeBoundingBox();
    const box = panel.surface.geometry.boundingBox;
    if (!box) return;
    this.scene.frame(box.max.x - box.min.x, box.max.y - box.min.y, (box.max.z + box.min.z) / 2);
    this.framed = true;
  }

  private models(): string[] {
    return this.panels.flatMap((panel) => (panel.report ? [panel.report.model] : []));
  }

  private requestQuestions(): void {
    const state = this.state, models = this.models();
    const ready = models.length === state.panels.length;
    const asked = ready && state.asked ? {models, x: state.asked[0], y: state.asked[1]} : null;
    this.tasks.want('ask', 'Asking', asked ? JSON.stringify(asked) : null, async (signal) => {
      const answers = await Promise.all(models.map((model) => ask('/api/terrain/at', {model, x: asked?.x, y: asked?.y}, signal)));
      this.heights.asked = answers.map(({words}) => (typeof words.z === 'number' ? words.z : null));
      this.showAnswers(answers);
      this.refresh();
    });
    if (!asked) {
      this.controls.readout.replaceChildren();
      this.heights.asked = [];
    }
    const line = ready && state.line.length > 1 ? {models, line: state.line} : null;
    this.tasks.want('profile', 'Measuring the profile', line ? JSON.stringify(line) : null, async (signal) => {
      const points = state.line.map(([x, y]) => ({x, y}));
      const answers = await Promise.all(models.map((model) => ask('/api/terrain/profile', {model, points, count: 600}, signal)));
      this.heights.paths = answers.map(({arrays}) => pathOf(state.line, arrays.distance as Float64Array, arrays.surface as Float64Array));
      this.showProfile(answers);
      this.refresh();
    });
    if (!line) {
      this.chart.replaceChildren();
      this.heights.paths = [];
    }
    const view = ready && state.observer ? {model: models[0], x: state.observer[0], y: state.observer[1], height: state.eye, radius: state.radius} : null;
    this.tasks.want('viewshed', 'Looking around', view ? JSON.stringify(view) : null, async (signal, progress) => {
      const answer = await work('/api/terrain/viewshed', view as Record<string, unknown>, progress, signal);
      for (const panel of this.panels) panel.takeSeen(answer);
      const {visible_cells: seen, cells} = answer.words as {visible_cells: number; cells: number};
      this.heights.ground = answer.words.ground as number;
      this.seenWords = `${say(seen, 9)} of ${say(cells, 9)} cells are seen (${say((100 * seen) / cells, 3)} %)`;
      this.refresh();
    });
    if (!view) {
      for (const panel of this.panels) panel.takeSeen(null);
      this.seenWords = '';
      this.heights.ground = null;
    }
  }
  private seenWords = '';
  /** What the marks stand on, as the program said it. */
  private heights: {asked: (number | null)[]; ground: number | null; paths: Float32Array[]; corner: Vec3 | null} = {asked: [], ground: null, paths: [], corner: null};

  private showAnswers(answers: Answer[]): void {
    const info = this.files[this.state.file];
    const first = answers[0].words as Record<string, number>;
    const digits = info.geographic ? 10 : 9;
    const rows: [string, string][] = [['X', say(first.x, digits)], ['Y', say(first.y, digits)], ['CRS', info.crs || 'none']];
    answers.forEach(({words}, k) => {
      const name = answers.length > 1 ? ` ${k + 1}` : '';
      rows.push([`height${name}`, `${say(words.z, 8)} ${info.unit}`], [`slope${name}`, `${say(words.slope, 6)}°`]);
      if (typeof words.aspect === 'number') rows.push([`faces${name}`, `${say(words.aspect, 6)}° from north`]);
    });
    if (info.kind === 'grid') rows.push(['grid cell here', `${say(first.grid, 8)} ${info.unit}`]);
    this.controls.readout.replaceChildren(table(rows));
  }

  private showProfile(answers: Answer[]): void {
    const info = this.files[this.state.file];
    const lines = answers.map(({arrays}, k): ProfileLine => ({
      name: `${k + 1} ${SURFACES.find(([name]) => name === this.panels[k]?.report?.surface)?.[1] ?? ''}`,
      distance: arrays.distance as Float64Array,
      height: arrays.surface as Float64Array,
    }));
    if (info.kind === 'grid') lines.push({name: 'grid', distance: answers[0].arrays.distance as Float64Array, height: answers[0].arrays.grid as Float64Array});
    const chart = profileChart(lines, info.unit), drawing = chart.querySelector('svg');
    if (drawing) chart.append(make('button', {type: 'button', title: 'The profile as a drawing', click: () => download('profile.svg', svgFile(drawing))}, 'Save profile as SVG'));
    this.chart.replaceChildren(chart);
    this.scene.redraw();
  }

  /** The first surface. */
  private save(format: SavedFormat): void {
    const [model] = this.models();
    if (model) saveFile(this.tasks, '/api/terrain/save', {model}, this.files[this.state.file].name, format);
  }

  private saveContours(): void {
    const info = this.files[this.state.file], panel = this.panels[0], {contours} = panel;
    if (!contours) return;
    const [w, h] = info.cell_size ?? [0, 0];
    let width = w * ((info.columns ?? 1) - 1), height = h * ((info.rows ?? 1) - 1);
    if (!(width > 0 && height > 0)) {  // a model without its grid: what its triangles cover
      panel.surface.geometry.computeBoundingBox();
      const box = panel.surface.geometry.boundingBox;
      if (!box) return;
      [width, height] = [box.max.x - box.min.x, box.max.y - box.min.y];
    }
    download('contours.svg', new Blob([planDrawing(...contours, width, height, info.unit, `${info.name}, contours every ${say(this.state.interval)} ${info.unit}`)], {type: 'image/svg+xml'}));
  }

  /** A place by its coordinates in the CRS, for the tool in hand. */
  private askAt(x: number, y: number): void {
    const model = this.models()[0];
    if (!model) return;
    this.tasks.once('place', 'Asking', async (signal) => {
      const {words} = await ask('/api/terrain/at', {model, crs_x: x, crs_y: y}, signal);
      this.controls.missed(!words.valid);
      if (words.valid) this.use([words.local_x as number, words.local_y as number], words.z as number);
    });
  }

  private clicked(event: MouseEvent): void {
    const tool = this.state.tool;
    if (tool === 'look') return;
    const hit = this.scene.pick(event);
    this.controls.missed(!hit);
    if (hit) this.use(this.state.snap ? cellCentre(hit.at, this.files[this.state.file]) : hit.at, hit.height);
  }

  private use(at: Place, height: number): void {
    const {tool} = this.state;
    if (tool === 'profile') this.heights.corner = [...at, height];
    this.edit((s) => {
      if (tool === 'viewshed') s.observer = at;
      else if (tool === 'profile') s.line.push(at);
      else s.asked = at;
    });
  }

  /** Colours, words and marks from what is there already. */
  refresh(): void {
    const state = this.state, info = this.files[state.file];
    const errorRange = Math.max(0, ...this.panels.map((panel) => panel.errorRange));
    this.panels.forEach((panel, k) => {
      panel.show(state, info, errorRange);
      panel.describe(state, state.panels[k], info, errorRange);
    });
    if (this.seenWords && this.panels[0]) this.panels[0].overlay.append(make('p', {class: 'seen'}, this.seenWords));
    const {asked, ground, paths, corner} = this.heights;
    const size = (info.cell * Math.max(info.columns ?? 200, info.rows ?? 200)) / 160;
    this.panels.forEach((panel, k) => {
      const pins: {at: Vec3; colour: number}[] = [], height = asked[k];
      if (state.asked && typeof height === 'number') pins.push({at: [...state.asked, height], colour: 0xffffff});
      if (state.observer && ground !== null) pins.push({at: [...state.observer, ground], colour: 0xffb000});
      if (state.line.length === 1 && corner) pins.push({at: corner, colour: 0x3d95cc});
      const marks = JSON.stringify([pins, state.line.length, state.exaggeration]);
      if (marks === this.markedFor.get(panel)?.marks && paths[k] === this.markedFor.get(panel)?.path) return;
      this.markedFor.set(panel, {marks, path: paths[k]});
      panel.mark(pins, paths[k] ?? new Float32Array(), size, state.exaggeration);
    });
    this.scene.redraw();
  }
}
