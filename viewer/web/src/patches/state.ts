// What the triangular-surface view shows: curves and the patches between them as `retalho patch` reads them, and how the
// surface is looked at.
import blade from '../../../../examples/patches/blade.json';
import hull from '../../../../examples/patches/hull.json';
import octant from '../../../../examples/patches/octant.json';
import saddle from '../../../../examples/patches/saddle.json';

export type Vec3 = [number, number, number];
export type Recovery = 'barycentric' | 'spr' | 'smooth';
export type Style = 'light' | 'lines' | 'zebra' | 'isophotes' | 'error' | 'gaussian' | 'mean';

/** A curve as docs/curves.md has it. */
export interface PatchCurve {
  kind: string;
  name?: string;
  points?: Vec3[];
  [key: string]: unknown;
}

export interface Side {
  curve: number;
  reversed: boolean;
}

/** Every curve once, and the patches by the numbers of their curves: what two patches share is moved in both. */
export interface PatchDocument {
  curves: PatchCurve[];
  patches: {name: string; sides: Side[]}[];
}

export interface PatchesState {
  file: number;  // a model of the command line; -1: the document
  document: PatchDocument;
  divisions: number;
  recovery: Recovery;
  style: Style;
  mesh: boolean;
  polygons: boolean;
  patch: number;  // the one that the parameter triangle shows
  cursor: [u: number, v: number] | null;
  point: Handle | null;
  snap: number;
  camera: number[] | null;
}

export type Handle = [curve: number, index: number];

/** Kinds whose points are places in space, so that they can be dragged. */
const DRAGGABLE = ['bezier', 'bspline', 'spline', 'catmull-rom', 'lagrange', 'polyline', 'hermite'];

const isVec3 = (p: unknown): p is Vec3 => Array.isArray(p) && p.length === 3 && p.every(Number.isFinite);

export function pointsOf(curve: PatchCurve): Vec3[] {
  return DRAGGABLE.includes(curve.kind) && Array.isArray(curve.points) && curve.points.every(isVec3) ? curve.points : [];
}

function same(a: PatchCurve, b: PatchCurve, turned: boolean): boolean {
  const {name: _a, points: p, ...restA} = a, {name: _b, points: q, ...restB} = b;
  if (!p || !q || (turned && (a.kind !== 'bezier' || a.weights !== undefined))) return false;
  return JSON.stringify([restA, turned ? [...p].reverse() : p]) === JSON.stringify([restB, q]);
}

/** The document with every curve once. Throws Error in words for what is no document of patches. */
export function readDocument(given: unknown): {document: PatchDocument; divisions: number | null} {
  const whole = (given ?? {}) as {curves?: unknown; patches?: unknown};
  const listed = Array.isArray(whole.curves) ? whole.curves as PatchCurve[] : [];
  const wanted = Array.isArray(whole.patches) ? whole.patches as {name?: string; sides?: unknown; divisions?: unknown}[] : listed.length === 3 ? [{sides: [0, 1, 2]}] : null;
  if (!wanted) throw new Error('expected {"patches": [{"sides": [three curves]}]}, or three "curves"');
  const document: PatchDocument = {curves: listed.map((curve) => structuredClone(curve)), patches: []};
  const place = (curve: PatchCurve): Side => {
    for (const turned of [false, true]) {
      const at = document.curves.findIndex((one) => same(one, curve, turned));
      if (at >= 0) return {curve: at, reversed: turned};
    }
    document.curves.push(structuredClone(curve));
    return {curve: document.curves.length - 1, reversed: false};
  };
  const find = (name: unknown, where: string): number => {
    const at = typeof name === 'number' ? name : listed.findIndex((curve) => curve.name === name);
    if (!listed[at]) throw new Error(`${where} names the curve ${JSON.stringify(name)}, which "curves" has not`);
    return at;
  };
  wanted.forEach((patch, k) => {
    if (!Array.isArray(patch.sides) || patch.sides.length !== 3) throw new Error(`patches[${k}].sides: expected three curves`);
    const sides = patch.sides.map((side: unknown, i): Side => {
      const where = `patches[${k}].sides[${i}]`;
      if (typeof side === 'number' || typeof side === 'string') return {curve: find(side, where), reversed: false};
      if (typeof side !== 'object' || side === null) throw new Error(`${where}: expected a curve`);
      const {reversed = false, ...rest} = side as PatchCurve & {reversed?: boolean; curve?: unknown};
      if (rest.curve !== undefined) return {curve: find(rest.curve, where), reversed};
      const at = place(rest);
      return {curve: at.curve, reversed: at.reversed !== reversed};
    });
    document.patches.push({name: patch.name ?? `patch ${k + 1}`, sides});
  });
  const divisions = wanted[0]?.divisions, first = Array.isArray(divisions) ? divisions[0] : divisions;
  return {document, divisions: typeof first === 'number' ? first : null};
}

const presets: [string, unknown][] = [['Saddle', saddle], ['Octant of a sphere', octant], ['Blade', blade], ['Hull', hull]];
export const PATCH_PRESETS: [name: string, document: PatchDocument][] = presets.map(([name, given]) => [name, readDocument(given).document]);

export function firstPatches(): PatchesState {
  return {file: -1, document: structuredClone(PATCH_PRESETS[0][1]), divisions: 24, recovery: 'smooth', style: 'light', mesh: false, polygons: true, patch: 0, cursor: null, point: null, snap: 0, camera: null};
}

/** Curves that a patch has as a side. */
function used(document: PatchDocument): number[] {
  return [...new Set(document.patches.flatMap((patch) => patch.sides.map((side) => side.curve)))].sort((a, b) => a - b);
}

const isEnd = (curve: PatchCurve, index: number) => index === 0 || index === (curve.points?.length ?? 0) - 1;

/** What moves together: a point inside of a curve alone; an end with all ends that lie at the same place. */
function together(document: PatchDocument, [curve, index]: Handle): Handle[] {
  const points = pointsOf(document.curves[curve]);
  if (!isEnd(document.curves[curve], index)) return [[curve, index]];
  const {size} = boundsOf(document), at = points[index];
  return used(document).flatMap((k) => pointsOf(document.curves[k]).flatMap((p, i): Handle[] =>
    isEnd(document.curves[k], i) && Math.hypot(...p.map((v, c) => v - at[c])) <= 1e-9 * size ? [[k, i]] : []));
}

/** Moves a control point; a corner moves in all of its curves. */
export function movePoint(document: PatchDocument, handle: Handle, to: Vec3): void {
  for (const [curve, index] of together(document, handle)) pointsOf(document.curves[curve])[index] = [...to];
}

/** Every handle once: a corner belongs to the first of its curves. */
export function handles(document: PatchDocument): {handle: Handle; corner: boolean}[] {
  const taken = new Set<string>();
  return used(document).flatMap((curve) => pointsOf(document.curves[curve]).flatMap((_, index) => {
    if (taken.has(`${curve} ${index}`)) return [];
    const group = together(document, [curve, index]);
    for (const [c, i] of group) taken.add(`${c} ${i}`);
    return [{handle: [curve, index] as Handle, corner: group.length > 1}];
  }));
}

/** What a curve is called: by its name, or by the side that it is first. */
export function curveName(document: PatchDocument, curve: number): string {
  const name = document.curves[curve]?.name;
  if (name) return name;
  const patch = document.patches.findIndex((one) => one.sides.some((side) => side.curve === curve));
  const side = document.patches[patch]?.sides.findIndex((one) => one.curve === curve) ?? 0;
  return document.patches.length > 1 ? `${document.patches[patch]?.name}, side ${side + 1}` : `Side ${side + 1}`;
}

export function handleName(document: PatchDocument, [curve, index]: Handle): string {
  return `${curveName(document, curve)}, point ${index + 1}`;
}

export function boundsOf(document: PatchDocument): {centre: Vec3; size: number} {
  const points = used(document).flatMap((k) => pointsOf(document.curves[k]));
  return boundsOfPoints(points);
}
export function boundsOfPoints(points: Vec3[]): {centre: Vec3; size: number} {
  if (points.length === 0) return {centre: [0, 0, 0], size: 1};
  const low = [0, 1, 2].map((k) => Math.min(...points.map((p) => p[k]))), high = [0, 1, 2].map((k) => Math.max(...points.map((p) => p[k])));
  return {centre: low.map((v, k) => (v + high[k]) / 2) as Vec3, size: Math.hypot(...low.map((v, k) => high[k] - v)) || 1};
}

export const snapped = (to: Vec3, step: number): Vec3 => (step > 0 ? to.map((v) => Number((Math.round(v / step) * step).toPrecision(12))) as Vec3 : to);

/** The range that a legend shows: without the wildest 2 % on either side, and the same to both sides of 0 where `even`. */
export function robustRange(values: Float32Array, even: boolean): [number, number] {
  const sorted = Float32Array.from(values).filter(Number.isFinite).sort();
  if (sorted.length === 0) return [0, 1];
  const low = sorted[Math.floor(0.02 * (sorted.length - 1))], high = sorted[Math.ceil(0.98 * (sorted.length - 1))];
  if (!even) return [Math.min(0, low), Math.max(high, 1e-300)];
  const most = Math.max(Math.abs(low), Math.abs(high), 1e-300);
  return [-most, most];
}
