// The page: its frame, its state, and which view is shown.
import {ask, CallError, takeToken} from './api';
import {download, make} from './dom';
import {History} from './history';
import {Tasks} from './tasks';
import {firstLook, type FileInfo, type TerrainState} from './terrain/state';
import {TerrainView} from './terrain/view';
import './style.css';

interface PageState {
  theme: 'auto' | 'light' | 'dark';
  terrain: TerrainState;
}

const page = document.getElementById('page') as HTMLElement;

function fail(words: string): void {
  page.replaceChildren(make('main', {class: 'failure', role: 'alert'}, make('h1', {}, 'Retalho'), make('p', {}, words)));
}

/** What a link restores: the state in the address's fragment. */
function linkedState(first: PageState): PageState {
  const match = /^#view=([\w-]+)$/.exec(location.hash);
  if (!match) return first;
  try {
    const text = new TextDecoder().decode(Uint8Array.from(atob(match[1].replace(/-/g, '+').replace(/_/g, '/')), (c) => c.charCodeAt(0)));
    return merged(first, JSON.parse(text));
  } catch {
    return first;
  }
}

/** The values of `given` where they are of the kind that `first` has. */
function merged<T>(first: T, given: unknown): T {
  if (Array.isArray(first)) return (Array.isArray(given) ? given : first) as T;
  if (first === null) return given as T;
  if (typeof first !== 'object') return (typeof given === typeof first ? given : first) as T;
  const out = {...first};
  if (typeof given !== 'object' || given === null) return out;
  for (const name of Object.keys(first) as (keyof T)[]) {
    const value = (given as Record<string, unknown>)[name as string];
    if (value !== undefined) out[name] = merged(first[name], value);
  }
  return out;
}

function encoded(state: PageState): string {
  const bytes = new TextEncoder().encode(JSON.stringify(state));
  return btoa(String.fromCharCode(...bytes)).replace(/\+/g, '-').replace(/\//g, '_').replace(/=+$/, '');
}

async function start(): Promise<void> {
  if (!takeToken()) return fail('This address lacks its token. Use the whole address that `retalho view` printed.');
  page.replaceChildren(make('main', {class: 'failure'}, make('p', {}, 'Asking the program what it has opened …')));
  let files: FileInfo[];
  try {
    files = (await ask('/api/terrain/files')).words.files as FileInfo[];
  } catch (error) {
    return fail(error instanceof CallError ? `${error.message}.` : String(error));
  }
  const first: PageState = {theme: 'auto', terrain: firstLook(0, files[0])};
  const history = new History<PageState>(linkedState(first));
  if (!files[history.state.terrain.file]) history.change((s) => { s.terrain = first.terrain; }, {silent: true});

  const status = make('div', {class: 'status', role: 'status', 'aria-live': 'polite'});
  const cancel = make('button', {type: 'button', click: () => tasks.cancel()}, 'Stop');
  const tasks = new Tasks(() => showStatus());
  let view: TerrainView;
  try {
    view = new TerrainView(files, history.state.terrain,
      (change, group) => history.change((s) => change(s.terrain), {group}), tasks,
      (file) => history.change((s) => { s.terrain = {...firstLook(file, files[file]), exaggeration: s.terrain.exaggeration}; }),
      (camera) => history.change((s) => { s.terrain.camera = camera; }, {silent: true}));
  } catch {
    return fail('This browser gives no WebGL 2 here, which the pictures need. Another browser, or its hardware acceleration, may help.');
  }
  const undo = make('button', {type: 'button', title: 'Ctrl+Z', click: () => history.undo()}, 'Undo');
  const redo = make('button', {type: 'button', title: 'Ctrl+Shift+Z', click: () => history.redo()}, 'Redo');
  const theme = make('button', {type: 'button', click: () => history.change((s) => { s.theme = s.theme === 'auto' ? 'dark' : s.theme === 'dark' ? 'light' : 'auto'; }, {silent: true})});
  const link = make('button', {type: 'button', title: 'Puts what is shown into the address of this tab', click: () => {
    location.replace('#view=' + encoded(history.state));
    note('The address of this tab now holds what is shown: it restores it in this tab, while the program runs.');
  }}, 'Link');
  const picture = make('button', {type: 'button', click: async () => {
    const blob = await view.scene.picture();
    if (blob) download('terrain.png', blob);
  }}, 'Save picture');
  const save = make('button', {type: 'button', title: 'What is shown, as a file that Open reads', click: () => download('view.json', new Blob([JSON.stringify(history.state, null, 1)], {type: 'application/json'}))}, 'Save view');
  const input = make('input', {type: 'file', accept: '.json', hidden: true, change: async () => {
    const file = input.files?.[0];
    if (!file) return;
    try {
      const given = merged(first, JSON.parse(await file.text()));
      if (!files[given.terrain.file]) throw new Error(`it shows file ${given.terrain.file + 1}, which is not open`);
      history.change((s) => { Object.assign(s, given); });
    } catch (error) {
      note(`${file.name} cannot be opened: ${error instanceof Error ? error.message : String(error)}`);
    }
    input.value = '';
  }});
  const open = make('button', {type: 'button', click: () => input.click()}, 'Open view');
  const header = make('header', {}, make('h1', {}, 'Retalho'), undo, redo, make('span', {class: 'gap'}), status, cancel, make('span', {class: 'gap'}), link, save, open, input, picture, theme);
  page.replaceChildren(header, make('aside', {}, view.controls.element), make('main', {}, view.stage));

  let noted = '';
  function note(words: string): void {
    noted = words;
    showStatus();
    setTimeout(() => { if (noted === words) { noted = ''; showStatus(); } }, 8000);
  }
  function showStatus(): void {
    const running = tasks.states;
    cancel.hidden = running.length === 0;
    const errors = [...tasks.errors.values()];
    status.classList.toggle('error', errors.length > 0 && running.length === 0);
    if (running.length > 0) {
      const done = running.reduce((sum, one) => sum + one.fraction, 0) / running.length;
      status.replaceChildren(make('progress', {max: 1, ...(done > 0 ? {value: done} : {})}), make('span', {}, running[0].words + ' …'));
    } else {
      status.replaceChildren(make('span', {}, errors.length > 0 ? [...new Set(errors)].join('; ') : noted || 'Ready'));
    }
    status.dataset.busy = String(running.length > 0);
  }
  function show(): void {
    const {theme: chosen, terrain} = history.state;
    if (chosen === 'auto') document.documentElement.removeAttribute('data-theme');
    else document.documentElement.dataset.theme = chosen;
    theme.textContent = `Theme: ${chosen}`;
    undo.disabled = !history.canUndo;
    redo.disabled = !history.canRedo;
    view.show(terrain, true);
  }
  history.listen(show);
  matchMedia('(prefers-color-scheme: dark)').addEventListener('change', show);
  addEventListener('keydown', (event) => {
    if (!(event.ctrlKey || event.metaKey) || event.target instanceof HTMLInputElement && event.target.type === 'number') return;
    const key = event.key.toLowerCase();
    if (key === 'z' && !event.shiftKey) history.undo();
    else if (key === 'y' || (key === 'z' && event.shiftKey)) history.redo();
    else return;
    event.preventDefault();
  });
  showStatus();
  show();
}

void start();
