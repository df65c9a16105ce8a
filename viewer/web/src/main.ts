// The page: its frame, its state, and which view is shown.
import {ask, CallError, newTabAddress, openSession} from './api';
import {firstCurves, PRESETS} from './curves/state';
import {CurvesView, type CurveFile} from './curves/view';
import {download, make} from './dom';
import {History} from './history';
import {lazily} from './lazily';
import {firstPatches, PATCH_PRESETS, readDocument, type PatchesState} from './patches/state';
import {PatchesView, type PatchFile} from './patches/view';
import {startPage, type Card} from './start';
import {decoded, encoded, merged, type PageState, type ViewName} from './state';
import {Tasks} from './tasks';
import {firstLook, type FileInfo} from './terrain/state';
import {TerrainView} from './terrain/view';
import {firstTetraQuads, TETRA_PRESETS} from './tetraquads/state';
import {TetraQuadsView, type TetraFile} from './tetraquads/view';
import './style.css';

const VIEWS: [ViewName, string][] = [['start', 'Start'], ['terrain', 'Terrain'], ['curves', 'Curves'], ['patches', 'Triangular surfaces'], ['tetraquads', 'TetraQuads']];
const page = document.getElementById('page') as HTMLElement;

function fail(words: string): void {
  page.replaceChildren(make('main', {class: 'failure', role: 'alert'}, make('h1', {}, 'Retalho'), make('p', {}, words)));
}

/** A saved state over the first one; documents of patches as they were written by any version. */
function opened(first: PageState, given: unknown): PageState {
  const state = merged(first, given);
  state.patches.document = readDocument(state.patches.document).document;
  return state;
}

function firstPatchesOf([file]: PatchFile[]): PatchesState {
  if (!file) return firstPatches();
  if (file.document === null) return {...firstPatches(), file: 0};
  const {document, divisions} = readDocument(file.document);
  return {...firstPatches(), document, divisions: Math.min(128, divisions ?? 24)};
}

/** What a link restores: the state in the address's fragment. */
function linkedState(first: PageState): PageState {
  const match = /^#view=([\w-]+)$/.exec(location.hash);
  if (!match) return first;
  try {
    return opened(first, decoded(match[1]));
  } catch {
    return first;
  }
}

async function start(): Promise<void> {
  page.replaceChildren(make('main', {class: 'failure'}, make('p', {}, 'Asking the program what it has opened …')));
  let files: FileInfo[], tetraFiles: TetraFile[], clouds: TetraFile[], curveFiles: CurveFile[], patchFiles: PatchFile[], view: ViewName;
  try {
    await openSession();
    const {words} = await ask('/api/terrain/files');
    files = words.files as FileInfo[];
    view = words.first_view as ViewName;
    const tetra = (await ask('/api/tetraquads/files')).words;
    tetraFiles = tetra.files as TetraFile[];
    clouds = tetra.clouds as TetraFile[];
    curveFiles = (await ask('/api/curves/files')).words.files as CurveFile[];
    patchFiles = (await ask('/api/patches/files')).words.files as PatchFile[];
  } catch (error) {
    return fail(error instanceof CallError ? `${error.message}.` : String(error));
  }
  const first: PageState = {theme: 'auto', view, terrain: firstLook(0, files[0]), curves: {...firstCurves(), ...(curveFiles[0] ? {document: curveFiles[0].document} : {})}, patches: firstPatchesOf(patchFiles), tetraquads: {...firstTetraQuads(), file: tetraFiles.length > 0 ? 0 : -1, cloud: tetraFiles.length === 0 && clouds.length > 0 ? 0 : -1}};
  const history = new History<PageState>(linkedState(first));
  if (!files[history.state.terrain.file]) history.change((s) => { s.terrain = first.terrain; }, {silent: true});
  if (history.state.patches.file >= patchFiles.length) history.change((s) => { s.patches = first.patches; }, {silent: true});

  const tasks = new Tasks(() => showStatus());
  const aside = make('aside'), stages = make('main');
  const place = ({element, stage}: {element: HTMLElement; stage: HTMLElement}) => { aside.append(element); stages.append(stage); };
  const terrain = lazily(() => new TerrainView(files, history.state.terrain,
    (change, group) => history.change((s) => change(s.terrain), {group}), tasks,
    (file) => history.change((s) => { s.terrain = {...firstLook(file, files[file]), exaggeration: s.terrain.exaggeration}; }),
    (camera) => history.change((s) => { s.terrain.camera = camera; }, {silent: true})), (view) => place({element: view.controls.element, stage: view.stage}));
  const patches = lazily(() => new PatchesView(patchFiles, history.state.patches, (change, options) => history.change((s) => change(s.patches), options), tasks), place);
  const tetraquads = lazily(() => new TetraQuadsView(tetraFiles, clouds, history.state.tetraquads, (change, options) => history.change((s) => change(s.tetraquads), options), tasks), place);
  const curves = lazily(() => new CurvesView(curveFiles, history.state.curves, (change, options) => history.change((s) => change(s.curves), options), tasks), place);
  const views = {terrain, curves, patches, tetraquads};
  const count = (n: number, one: string, many: string) => `${n} ${n === 1 ? one : many}`;
  const cards = (view: ViewName, list: {name: string; described: string}[], open: (k: number) => void) =>
    list.map(({name, described}, k): Card => ({name, described, open: () => { open(k); go(view); }}));
  const starting = startPage([
    {title: 'Terrains', words: 'A grid becomes a surface of polynomial patches: fit it, see its errors, ask it, set surfaces side by side.',
      cards: cards('terrain', files, (file) => history.change((s) => { if (s.terrain.file !== file) s.terrain = firstLook(file, files[file]); }))},
    {title: 'Curves', words: 'Draw and drag control points, walk through de Casteljau’s triangle, read the continuity of each join.',
      cards: [...cards('curves', curveFiles, (k) => curves.get()?.openFile(k)),
        ...cards('curves', PRESETS.map(([name, document]) => ({name, described: [...new Set(document.curves.map((spec) => spec.kind))].join(', ')})), (k) => curves.get()?.open(PRESETS[k][1]))]},
    {title: 'Triangular surfaces', words: 'Three space curves span a surface: drag their points, change its recovery, look at zebra stripes and curvature.',
      cards: [...cards('patches', patchFiles, (k) => patches.get()?.openFile(k)),
        ...cards('patches', PATCH_PRESETS.map(([name, document]) => ({name, described: `${count(document.patches.length, 'patch', 'patches')}, ${document.curves.length} curves`})), (k) => patches.get()?.open(PATCH_PRESETS[k][1]))]},
    {title: 'TetraQuads', words: 'A quadric at each vertex of tetrahedra, one implicit cubic in each: ray cast from the quadrics themselves.',
      cards: [...cards('tetraquads', tetraFiles, (k) => tetraquads.get()?.openFile('file', k)), ...cards('tetraquads', clouds, (k) => tetraquads.get()?.openFile('cloud', k)),
        ...cards('tetraquads', TETRA_PRESETS.map(([name, document]) => ({name, described: count(document.tetrahedra.length, 'tetrahedron', 'tetrahedra')})), (k) => tetraquads.get()?.open(TETRA_PRESETS[k][1]))]},
  ]);

  function go(view: ViewName): void {
    history.change((s) => { s.view = view; }, {silent: true});
  }
  const tabs = new Map<ViewName, HTMLButtonElement>();
  const tabBar = make('div', {class: 'tabs', role: 'tablist', 'aria-label': 'View'}, ...VIEWS.map(([view, words]) => {
    const tab = make('button', {type: 'button', role: 'tab', click: () => go(view)}, words);
    tabs.set(view, tab);
    return tab;
  }));
  tabBar.addEventListener('keydown', (event) => {
    const step = event.key === 'ArrowRight' ? 1 : event.key === 'ArrowLeft' ? -1 : 0;
    if (step === 0) return;
    const at = VIEWS.findIndex(([view]) => view === history.state.view);
    const [next] = VIEWS[(at + step + VIEWS.length) % VIEWS.length];
    go(next);
    tabs.get(next)?.focus();
  });

  const status = make('div', {class: 'status', role: 'status', 'aria-live': 'polite'});
  const cancel = make('button', {type: 'button', click: () => tasks.cancel()}, 'Stop');
  const undo = make('button', {type: 'button', title: 'Ctrl+Z', click: () => history.undo()}, 'Undo');
  const redo = make('button', {type: 'button', title: 'Ctrl+Shift+Z', click: () => history.redo()}, 'Redo');
  const theme = make('button', {type: 'button', click: () => history.change((s) => { s.theme = s.theme === 'auto' ? 'dark' : s.theme === 'dark' ? 'light' : 'auto'; }, {silent: true})});
  const link = make('button', {type: 'button', title: 'Puts what is shown into the address of this tab', click: () => {
    location.replace('#view=' + encoded(history.state));
    note('The address of this tab now holds what is shown: it restores it in this tab, while the program runs.');
  }}, 'Link');
  const picture = make('button', {type: 'button', click: async () => {
    const {view} = history.state;
    const blob = await (view === 'curves' ? curves.made?.picture() : (view === 'patches' ? patches : view === 'tetraquads' ? tetraquads : terrain).made?.scene.picture());
    if (blob) download(`${view}.png`, blob);
  }}, 'Save picture');
  const save = make('button', {type: 'button', title: 'What is shown, as a file that Open view reads', click: () => download('view.json', new Blob([JSON.stringify(history.state, null, 1)], {type: 'application/json'}))}, 'Save view');
  const tab = make('button', {type: 'button', title: 'The page once more, beside this one', click: async () => {
    try {
      open(await newTabAddress(), '_blank', 'noopener');
    } catch (error) {
      note(error instanceof Error ? error.message : String(error));
    }
  }}, 'New tab');
  const input: HTMLInputElement = make('input', {type: 'file', class: 'open-view', accept: '.json', hidden: true, change: async () => {
    const file = input.files?.[0];
    if (!file) return;
    try {
      const state = opened(first, JSON.parse(await file.text()));
      if (!files[state.terrain.file]) throw new Error(`it shows file ${state.terrain.file + 1}, which is not open`);
      history.change((s) => { Object.assign(s, state); });
    } catch (error) {
      note(`${file.name} cannot be opened: ${error instanceof Error ? error.message : String(error)}`);
    }
    input.value = '';
  }});
  const openView = make('button', {type: 'button', click: () => input.click()}, 'Open view');
  const header = make('header', {}, make('h1', {}, 'Retalho'), tabBar, undo, redo, make('div', {class: 'space'}), picture, link, save, openView, input, tab, theme);
  stages.append(starting, ...Object.values(views).map((view) => view.failure));
  page.replaceChildren(header, aside, stages, make('footer', {}, status, cancel));

  let noted = '';
  function note(words: string): void {
    noted = words;
    showStatus();
    setTimeout(() => { if (noted === words) { noted = ''; showStatus(); } }, 8000);
  }
  function showStatus(): void {
    // Words and the button come after a quarter of a second, and nothing in the page moves for them: a dragged point
    // would jump away from under the pointer.
    const all = tasks.states, running = all.filter((one) => performance.now() - one.since > 250);
    status.dataset.busy = String(all.length > 0);
    if (all.length > running.length) setTimeout(showStatus, 260);
    cancel.classList.toggle('away', running.length === 0);
    const errors = [...tasks.errors.values()];
    status.classList.toggle('error', errors.length > 0 && running.length === 0);
    if (running.length > 0) {
      const done = running.reduce((sum, one) => sum + one.fraction, 0) / running.length;
      status.replaceChildren(make('progress', {max: 1, ...(done > 0 ? {value: done} : {})}), make('span', {}, running[0].words + ' …'));
    } else {
      status.replaceChildren(make('span', {}, errors.length > 0 ? [...new Set(errors)].join('; ') : noted || 'Ready'));
    }
  }
  function show(): void {
    const state = history.state;
    if (state.theme === 'auto') document.documentElement.removeAttribute('data-theme');
    else document.documentElement.dataset.theme = state.theme;
    theme.textContent = `Theme: ${state.theme}`;
    undo.disabled = !history.canUndo;
    redo.disabled = !history.canRedo;
    for (const [view, tab] of tabs) {
      tab.setAttribute('aria-selected', String(view === state.view));
      tab.tabIndex = view === state.view ? 0 : -1;
    }
    page.dataset.view = state.view;
    starting.hidden = state.view !== 'start';
    aside.hidden = state.view === 'start';
    picture.hidden = state.view === 'start';
    for (const [name, view] of Object.entries(views)) {
      const shown = name === state.view;
      const made = shown ? view.get() : view.made;
      view.failure.hidden = !shown || made !== null;
    }
    terrain.made?.show(state.terrain, state.view === 'terrain');
    curves.made?.show(state.curves, state.view === 'curves');
    patches.made?.show(state.patches, state.view === 'patches');
    tetraquads.made?.show(state.tetraquads, state.view === 'tetraquads');
  }
  history.listen(show);
  matchMedia('(prefers-color-scheme: dark)').addEventListener('change', show);
  addEventListener('keydown', (event) => {
    const typing = event.target instanceof HTMLInputElement && (event.target.type === 'number' || event.target.type === 'text');
    if (!(event.ctrlKey || event.metaKey) || typing) return;
    const key = event.key.toLowerCase();
    if (key === 'z' && !event.shiftKey) history.undo();
    else if (key === 'y' || (key === 'z' && event.shiftKey)) history.redo();
    else return;
    event.preventDefault();
  });
  showStatus();
  // The page's frame is one task, the first view with its graphics context another.
  await new Promise((done) => setTimeout(done));
  show();
}

void start();
