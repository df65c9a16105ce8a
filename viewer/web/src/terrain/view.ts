// The terrain view: asks the program for what the state says and puts the answers into the picture.
import {ask, work, type Answer} from '../api';
import {make, say, table} from '../dom';
import {saveFile, type SavedFormat} from '../saving';
import type {Tasks} from '../tasks';
import {TerrainControls, type Edit} from './controls';
import {Panel} from './panel';
import {profileChart, type ProfileLine} from './profile';
import {TerrainScene} from './scene';
import {fitRequest, SURFACES, type FileInfo, type Place, type TerrainState} from './state';

export class TerrainView {
  readonly stage = make('div', {class: 'terrain'});
  readonly controls: TerrainControls;
  readonly scene: TerrainScene;
  private readonly chart = make('div', {class: 'chart-place'});
  private panels: Panel[] = [];
  private shownFile = -1;
  private state: TerrainState;
  private markedFor = '';

  constructor(readonly files: FileInfo[], first: TerrainState, private edit: Edit, private tasks: Tasks, openFile: (file: number) => void, cameraMoved: (camera: number[]) => void) {
    this.state = first;
    this.scene = new TerrainScene(cameraMoved);
    this.controls = new TerrainControls(files, edit, openFile, (format) => this.save(format), (x, y) => void this.askAt(x, y));
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
      const answer = await work('/api/terrain/fit', wanted, progress, signal);
      panel.takeSurface(answer);
      this.tasks.forget(`errors ${k}`);
      this.tasks.forget(`contours ${k}`);
      if (!this.framed) this.frameBySurface(panel);
      this.markedFor = '';
      this.show(this.state, !this.stage.hidden);
    });
    const model = panel.report && this.fitted.get(panel) !== undefined ? panel.report.model : null;
    this.tasks.want(`errors ${k}`, 'Measuring errors', model && state.colour === 'error' && info.kind === 'grid' ? model : null, async (signal, progress) => {
      panel.takeErrors(await work('/api/terrain/errors', {model, size: 1024}, progress, signal));
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
      this.showAnswers(answers);
    });
    if (!asked) this.controls.readout.replaceChildren();
    const line = ready && state.line.length > 1 ? {models, line: state.line} : null;
    this.tasks.want('profile', 'Measuring the profile', line ? JSON.stringify(line) : null, async (signal) => {
      const points = state.line.map(([x, y]) => ({x, y}));
      const answers = await Promise.all(models.map((model) => ask('/api/terrain/profile', {model, points, count: 600}, signal)));
      this.showProfile(answers);
    });
    if (!line) this.chart.replaceChildren();
    const view = ready && state.observer ? {model: models[0], x: state.observer[0], y: state.observer[1], height: state.eye, radius: state.radius} : null;
    this.tasks.want('viewshed', 'Looking around', view ? JSON.stringify(view) : null, async (signal, progress) => {
      const answer = await work('/api/terrain/viewshed', view as Record<string, unknown>, progress, signal);
      for (const panel of this.panels) panel.takeSeen(answer);
      const {visible_cells: seen, cells} = answer.words as {visible_cells: number; cells: number};
      this.seenWords = `${say(seen, 9)} of ${say(cells, 9)} cells are seen (${say((100 * seen) / cells, 3)} %)`;
      this.refresh();
    });
    if (!view) {
      for (const panel of this.panels) panel.takeSeen(null);
      this.seenWords = '';
    }
  }
  private seenWords = '';

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
    this.chart.replaceChildren(profileChart(lines, info.unit));
    this.scene.redraw();
  }

  /** The first surface. */
  private save(format: SavedFormat): void {
    const [model] = this.models();
    if (model) saveFile(this.tasks, '/api/terrain/save', {model}, this.files[this.state.file].name, format);
  }

  /** A place by its coordinates in the CRS. */
  private async askAt(x: number, y: number): Promise<void> {
    const model = this.models()[0];
    if (!model) return;
    const {words} = await ask('/api/terrain/at', {model, crs_x: x, crs_y: y});
    const place: Place = [words.local_x as number, words.local_y as number];
    this.edit((s) => { s.asked = place; });
  }

  private clicked(event: MouseEvent): void {
    const tool = this.state.tool;
    if (tool === 'look') return;
    const hit = this.scene.pick(event);
    if (!hit) return;
    this.edit((s) => {
      if (tool === 'ask') s.asked = hit.at;
      if (tool === 'viewshed') s.observer = hit.at;
      if (tool === 'profile') s.line.push(hit.at);
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
    const marks = JSON.stringify([state.asked, state.observer, state.line, state.exaggeration, this.models()]);
    if (marks !== this.markedFor) {
      this.markedFor = marks;
      const places = [...(state.asked ? [{at: state.asked, colour: 0xffffff}] : []), ...(state.observer ? [{at: state.observer, colour: 0xffb000}] : [])];
      const size = (info.cell * Math.max(info.columns ?? 200, info.rows ?? 200)) / 160;
      for (const panel of this.panels) panel.mark(places, state.line, size, state.exaggeration, this.scene.ray);
    }
    this.scene.redraw();
  }
}
