// The state of the whole page, as a link and a saved file hold it.
import type {CurvesState} from './curves/state';
import type {PatchesState} from './patches/state';
import type {TerrainState} from './terrain/state';
import type {TetraQuadsState} from './tetraquads/state';

export type ViewName = 'start' | 'terrain' | 'curves' | 'patches' | 'tetraquads';

export interface PageState {
  theme: 'auto' | 'light' | 'dark';
  view: ViewName;
  terrain: TerrainState;
  curves: CurvesState;
  patches: PatchesState;
  tetraquads: TetraQuadsState;
}

/** The values of `given` where they are of the kind that `first` has. */
export function merged<T>(first: T, given: unknown): T {
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

/** As letters that may stand in an address's fragment. */
export function encoded(state: unknown): string {
  const bytes = new TextEncoder().encode(JSON.stringify(state));
  let text = '';
  for (const byte of bytes) text += String.fromCharCode(byte);
  return btoa(text).replace(/\+/g, '-').replace(/\//g, '_').replace(/=+$/, '');
}

export function decoded(text: string): unknown {
  return JSON.parse(new TextDecoder().decode(Uint8Array.from(atob(text.replace(/-/g, '+').replace(/_/g, '/')), (c) => c.charCodeAt(0))));
}
