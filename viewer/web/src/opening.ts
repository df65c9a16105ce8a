// Opening a JSON file of the user's own: as a task, so that the page says that it works, and what is wrong in words.
import {make} from './dom';
import type {Tasks} from './tasks';

/** A hidden input; click() asks for a file. `take` checks and shows what is in it; what it throws is said in `words`. */
export function jsonInput(tasks: Tasks, words: HTMLElement, take: (parsed: unknown, signal: AbortSignal) => Promise<void>): HTMLInputElement {
  const input: HTMLInputElement = make('input', {type: 'file', accept: '.json', hidden: true, change: () => {
    const file = input.files?.[0];
    if (!file) return;
    words.textContent = '';
    tasks.once('open', `Opening ${file.name}`, async (signal) => {
      try {
        await take(JSON.parse(await file.text()), signal);
      } catch (error) {
        if (!signal.aborted) words.textContent = `${file.name}: ${error instanceof Error ? error.message : String(error)}`;
      }
      input.value = '';
    });
  }});
  return input;
}
