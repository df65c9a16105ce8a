// What the triangular-surface view shows: three curves as `retalho patch` reads them, and how the surface is looked at.
import octant from '../../../../examples/patches/octant.json';
import saddle from '../../../../examples/patches/saddle.json';

export type Vec3 = [number, number, number];
export type Recovery = 'barycentric' | 'spr' | 'smooth';
export type Style = 'light' | 'lines' | 'zebra' | 'isophotes' | 'error' | 'gaussian' | 'mean';

export interface Side {
  kind: 'bezier';
  points: Vec3[];
  weights?: number[];
}

export interface PatchDocument {
  patches: {name: string; sides: Side[]}[];
}

export interface PatchesState {
  document: PatchDocument;
  divisions: number;
  recovery: Recovery;
  style: Style;
  mesh: boolean;
  polygons: boolean;
  cursor: [u: number, v: number] | null;
  point: [side: number, index: number] | null;
  camera: number[] | null;
}

type Given = {patches: {name?: string; sides: unknown[]}[]};

/** A document's first patch where all of its sides are written out as Bézier curves; else nothing: the page drags no others. */
export function editable(given: unknown): PatchDocument | null {
  const patch = (given as Given | null)?.patches?.[0];
  if (!patch || !Array.isArray(patch.sides) || patch.sides.length !== 3) return null;
  const sides: Side[] = [];
  for (const side of patch.sides as Partial<Side>[]) {
    const good = side?.kind === 'bezier' && Array.isArray(side.points) && side.points.every((p) => Array.isArray(p) && p.length === 3 && p.every(Number.isFinite));
    if (!good || !side.points || Object.keys(side).some((key) => !['kind', 'points', 'weights', 'name'].includes(key))) return null;
    sides.push({kind: 'bezier', points: side.points.map((p) => [...p]), ...(side.weights ? {weights: [...side.weights]} : {})});
  }
  return {patches: [{name: patch.name ?? 'patch', sides}]};
}

export const PATCH_PRESETS: [name: string, document: PatchDocument][] = ([['Saddle', saddle], ['Octant of a sphere', octant]] as [string, unknown][])
  .flatMap(([name, given]): [string, PatchDocument][] => { const document = editable(given); return document ? [[name, document]] : []; });

export function firstPatches(): PatchesState {
  return {document: structuredClone(PATCH_PRESETS[0][1]), divisions: 24, recovery: 'smooth', style: 'light', mesh: false, polygons: true, cursor: null, point: null, camera: null};
}

/** Moves a control point; a corner moves with the end of the side beside it. */
export function movePoint(document: PatchDocument, side: number, index: number, to: Vec3): void {
  const {sides} = document.patches[0];
  sides[side].points[index] = [...to];
  const last = sides[side].points.length - 1;
  if (index === 0) { const before = sides[(side + 2) % 3].points; before[before.length - 1] = [...to]; }
  if (index === last) sides[(side + 1) % 3].points[0] = [...to];
}

/** Every handle once: corners belong to the side that starts there. */
export function handles(document: PatchDocument): [side: number, index: number][] {
  return document.patches[0].sides.flatMap((side, k) => side.points.slice(0, -1).map((_, i): [number, number] => [k, i]));
}

export function boundsOf(document: PatchDocument): {centre: Vec3; size: number} {
  const points = document.patches[0].sides.flatMap((side) => side.points);
  const low = [0, 1, 2].map((k) => Math.min(...points.map((p) => p[k]))), high = [0, 1, 2].map((k) => Math.max(...points.map((p) => p[k])));
  return {centre: low.map((v, k) => (v + high[k]) / 2) as Vec3, size: Math.hypot(...low.map((v, k) => high[k] - v)) || 1};
}

/** The range that a legend shows: without the wildest 2 % on either side, and the same to both sides of 0 where `even`. */
export function robustRange(values: Float32Array, even: boolean): [number, number] {
  const sorted = Float32Array.from(values).filter(Number.isFinite).sort();
  if (sorted.length === 0) return [0, 1];
  const low = sorted[Math.floor(0.02 * (sorted.length - 1))], high = sorted[Math.ceil(0.98 * (sorted.length - 1))];
  if (!even) return [Math.min(0, low), Math.max(high, 1e-300)];
  const most = Math.max(Math.abs(low), Math.abs(high), 1e-300);
  return [-most, most];
}
