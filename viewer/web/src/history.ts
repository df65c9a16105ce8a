// One state for the whole page, as plain data: what is drawn follows from it, undo and redo walk through it, a link and
// a saved file are it.

export interface Change {
  /** Changes of the same group that follow each other quickly (a slider's) are undone together. */
  group?: string;
  /** Not worth an undo step of its own (the camera, which tool is in hand). */
  silent?: boolean;
}

const TOGETHER_MS = 700;
const MOST = 200;

export class History<S extends object> {
  private past: S[] = [];
  private future: S[] = [];
  private listeners: ((state: S, before: S) => void)[] = [];
  private lastGroup = '';
  private lastTime = 0;

  constructor(private current: S, private now: () => number = () => performance.now()) {}

  get state(): S {
    return this.current;
  }
  get canUndo(): boolean {
    return this.past.length > 0;
  }
  get canRedo(): boolean {
    return this.future.length > 0;
  }

  listen(listener: (state: S, before: S) => void): void {
    this.listeners.push(listener);
  }

  /** The state becomes `change(a copy of it)`. */
  change(change: (copy: S) => void, {group = '', silent = false}: Change = {}): void {
    const copy = structuredClone(this.current);
    change(copy);
    if (JSON.stringify(copy) === JSON.stringify(this.current)) return;
    if (!silent) {
      const together = group !== '' && group === this.lastGroup && this.now() - this.lastTime < TOGETHER_MS;
      if (!together) {
        this.past.push(this.current);
        if (this.past.length > MOST) this.past.shift();
      }
      this.future = [];
      this.lastGroup = group;
      this.lastTime = this.now();
    }
    this.go(copy);
  }

  undo(): void {
    const before = this.past.pop();
    if (!before) return;
    this.future.push(this.current);
    this.lastGroup = '';
    this.go(before);
  }

  redo(): void {
    const after = this.future.pop();
    if (!after) return;
    this.past.push(this.current);
    this.lastGroup = '';
    this.go(after);
  }

  private go(state: S): void {
    const before = this.current;
    this.current = state;
    for (const listener of this.listeners) listener(state, before);
  }
}
