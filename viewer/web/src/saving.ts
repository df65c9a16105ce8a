// Surfaces as files: the program makes the bytes, the browser saves them.
import {work} from './api';
import {download, make} from './dom';
import type {Tasks} from './tasks';

export type SavedFormat = 'retalho' | 'obj' | 'glb';
const FORMATS: [format: SavedFormat, words: string, hint: string][] = [
  ['retalho', 'Save model', 'The model file that the program reads (.retalho)'],
  ['obj', 'Save OBJ', 'Triangles, as text'],
  ['glb', 'Save GLB', 'Triangles, as binary glTF'],
];

export function saveButtons(save: (format: SavedFormat) => void): HTMLElement[] {
  return FORMATS.map(([format, words, hint]) => make('button', {type: 'button', title: hint, click: () => save(format)}, words));
}

/** `name` may have an ending of its own, which is left out. */
export function saveFile(tasks: Tasks, path: string, what: Record<string, unknown>, name: string, format: SavedFormat): void {
  tasks.once(`save ${path}`, `Writing ${format === 'retalho' ? 'the model' : format.toUpperCase()}`, async (signal, progress) => {
    const {arrays} = await work(path, {...what, format}, progress, signal);
    download(`${name.replace(/\.[^.]*$/, '') || 'surface'}.${format}`, new Blob([arrays.file]));
  });
}
