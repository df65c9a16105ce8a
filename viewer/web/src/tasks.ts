// Work that the page has asked the program for: for each name the newest request counts, an older one is ended.
import {CallError, type Progress} from './api';

export interface TaskState {
  name: string;
  words: string;
  fraction: number;
  since: number;
}

export class Tasks {
  private running = new Map<string, {key: string; abort: AbortController; state: TaskState}>();
  private done = new Map<string, string>();
  readonly errors = new Map<string, string>();
  private count = 0;

  constructor(private changed: () => void) {}

  /** Runs `job` unless it has been run, or is running, for the same key. With key null, what runs is ended. */
  want(name: string, words: string, key: string | null, job: (signal: AbortSignal, progress: Progress) => Promise<void>): void {
    const now = this.running.get(name);
    if (now ? now.key === key : this.done.get(name) === (key ?? '')) return;
    now?.abort.abort();
    this.running.delete(name);
    this.done.set(name, '');
    this.errors.delete(name);
    if (key !== null) {
      const abort = new AbortController();
      const state: TaskState = {name, words, fraction: 0, since: performance.now()};
      this.running.set(name, {key, abort, state});
      const progress: Progress = (stage, fraction) => {
        state.words = `${words}: ${stage}`;
        state.fraction = fraction;
        this.changed();
      };
      job(abort.signal, progress).then(
        () => this.finish(name, key, abort, null),
        (error: unknown) => this.finish(name, key, abort, error),
      );
    }
    this.changed();
  }

  /** Runs `job` now, whatever was run under this name before. */
  once(name: string, words: string, job: (signal: AbortSignal, progress: Progress) => Promise<void>): void {
    this.want(name, words, String(++this.count), job);
  }

  /** Ends everything that runs; it counts as not done. */
  cancel(): void {
    for (const {abort} of this.running.values()) abort.abort();
    for (const [name, {state}] of this.running) this.errors.set(name, `${state.words}: stopped`);
    for (const [name, {key}] of this.running) this.done.set(name, key);
    this.running.clear();
    this.changed();
  }

  /** Forgets what was done, so that it is asked for again. */
  forget(name: string): void {
    this.done.delete(name);
  }

  get states(): TaskState[] {
    return [...this.running.values()].map((one) => one.state);
  }

  private finish(name: string, key: string, abort: AbortController, error: unknown): void {
    const now = this.running.get(name);
    if (now?.abort !== abort) return;
    this.running.delete(name);
    this.done.set(name, key);
    if (error !== null && !abort.signal.aborted) {
      this.errors.set(name, error instanceof CallError ? error.message : `the page failed: ${String(error)}`);
    }
    this.changed();
  }
}
