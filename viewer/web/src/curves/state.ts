// What the curve view shows: a document as `retalho curve` reads it (docs/curves.md), and how it is looked at.
import bspline from '../../../../examples/curves/bspline.json';
import casteljau from '../../../../examples/curves/casteljau.json';
import course from '../../../../examples/curves/course.json';
import hermite from '../../../../examples/curves/hermite.json';
import lemniscate from '../../../../examples/curves/lemniscate.json';
import parameters from '../../../../examples/curves/parameters.json';
import poles from '../../../../examples/curves/poles.json';
import runge from '../../../../examples/curves/runge.json';
import slide6 from '../../../../examples/curves/slide6.json';
import slide9 from '../../../../examples/curves/slide9.json';

export type Point = number[];

export interface CurveSpec {
  kind: string;
  name?: string;
  points?: Point[];
  tangents?: Point[];
  weights?: number[];
  knots?: number[];
  degree?: number;
  f?: string;
  box?: number[];
  from?: number;
  to?: number;
  [key: string]: unknown;
}

export interface CurveDocument {
  curves: CurveSpec[];
}

export interface CurvesState {
  document: CurveDocument;
  selected: number;
  point: number;
  t: number;
  polygon: boolean;
  casteljau: boolean;
  comb: boolean;
  hodograph: boolean;
  joins: boolean;
  combScale: number;
  tool: 'move' | 'draw';
  snap: number;
  window: number[] | null;
}

const asDocument = (given: unknown): CurveDocument => given as CurveDocument;

/** The cases of the slides, as the program's own examples (examples/curves). */
export const PRESETS: [name: string, document: CurveDocument][] = [
  ['De Casteljau’s triangle', asDocument(casteljau)],
  ['Slide 6: a curve with a cusp', asDocument(slide6)],
  ['Slide 9', asDocument(slide9)],
  ['Hermite', asDocument(hermite)],
  ['B-spline', asDocument(bspline)],
  ['Parameters of a spline', asDocument(parameters)],
  ['Lagrange against splines (Runge)', asDocument(runge)],
  ['Lemniscate (implicit)', asDocument(lemniscate)],
  ['Poles (explicit)', asDocument(poles)],
  ['A course', asDocument(course)],
];

export const NEW_KINDS: [kind: string, words: string][] = [
  ['bezier', 'Bézier (each point raises the degree)'],
  ['spline', 'cubic spline through points'],
  ['lagrange', 'Lagrange through points'],
  ['polyline', 'polyline'],
];

export function firstCurves(): CurvesState {
  return {
    document: structuredClone(PRESETS[0][1]), selected: 0, point: -1, t: 0.4, polygon: true, casteljau: true, comb: false, hodograph: false, joins: true,
    combScale: 1, tool: 'move', snap: 0, window: null,
  };
}

/** The chosen curve, when there is one. */
export const chosen = (state: CurvesState): CurveSpec | undefined => state.document.curves[state.selected];

export const rounded = (v: number): number => Number(v.toPrecision(10));

export function snapped(v: number, step: number): number {
  return step > 0 ? rounded(Math.round(v / step) * step) : rounded(v);
}

/** Adds a point at the end of the curve; weights follow with 1. */
export function addPoint(spec: CurveSpec, at: Point): void {
  (spec.points ??= []).push(at);
  if (spec.weights) spec.weights.push(1);
}

/** A kind whose points can be added and removed one at a time. */
export function growable(spec: CurveSpec | undefined): boolean {
  return spec !== undefined && NEW_KINDS.some(([kind]) => kind === spec.kind) && !(spec.kind === 'bezier' && spec.degree !== undefined);
}

export function removePoint(spec: CurveSpec, index: number): boolean {
  if (!growable(spec) || !spec.points || spec.points.length <= 2 || index < 0 || index >= spec.points.length) return false;
  spec.points.splice(index, 1);
  spec.weights?.splice(index, 1);
  return true;
}

export function moveTo(spec: CurveSpec, index: number, x: number, y: number): void {
  const point = spec.points?.[index];
  if (point) [point[0], point[1]] = [x, y];
}

export interface Drawn {
  kind: string;
  name: string;
  dimension: number;
  error?: string;
  degree?: number;
  segments?: number;
  length?: number;
  bounds?: number[];
  lines?: Point[][];
  control?: Point[][];
  joins?: {at: number; point: Point; C: string; G: string; gap: number; angle: number; curvature_left: number; curvature_right: number; curvature_gap: number; speed_ratio: number; kind: string}[];
  inflections?: Point[];
  comb?: Point[][];
  hodograph?: Point[][];
  casteljau?: {u: number; segment: number; t: number; rows: Point[][]; point: Point; derivative: Point; curvature: number};
  cells?: number[][];
  breaks?: number[];
  certified?: boolean;
}

/** The part of the segment a b inside of the square |x|, |y| <= limit (Liang and Barsky 1984), or nothing. */
export function clipped(a: Point, b: Point, limit: number): [Point, Point] | null {
  let from = 0, to = 1;
  for (const k of [0, 1]) {
    for (const sign of [-1, 1]) {
      const step = sign * (b[k] - a[k]), room = limit - sign * a[k];
      if (step === 0) {
        if (room < 0) return null;
      } else if (step > 0) to = Math.min(to, room / step);
      else from = Math.max(from, room / step);
    }
  }
  if (!(from <= to)) return null;
  const at = (t: number): Point => [a[0] + (b[0] - a[0]) * t, a[1] + (b[1] - a[1]) * t];
  return [from === 0 ? a : at(from), to === 1 ? b : at(to)];
}

/** Lines through points as an SVG path. */
export function clippedPath(points: Point[], limit: number): string {
  let path = '', pen: Point | null = null;
  const say = (p: Point) => `${p[0].toFixed(2)} ${p[1].toFixed(2)}`;
  for (let i = 0; i + 1 < points.length; ++i) {
    const part = clipped(points[i], points[i + 1], limit);
    if (!part) continue;
    if (pen !== part[0]) path += 'M' + say(part[0]);
    path += 'L' + say(part[1]);
    pen = part[1] === points[i + 1] ? part[1] : null;
  }
  return path;
}

/** The box of everything drawn and held, with room around. */
export function boxOf(state: CurvesState, drawn: Drawn[]): number[] {
  let [x0, y0, x1, y1] = [Infinity, Infinity, -Infinity, -Infinity];
  const add = (x: number, y: number) => {
    if (!Number.isFinite(x) || !Number.isFinite(y)) return;
    [x0, y0, x1, y1] = [Math.min(x0, x), Math.min(y0, y), Math.max(x1, x), Math.max(y1, y)];
  };
  for (const curve of drawn) if (curve.bounds) { add(curve.bounds[0], curve.bounds[1]); add(curve.bounds[2], curve.bounds[3]); }
  for (const spec of state.document.curves) for (const point of spec.points ?? []) add(point[0], point[1]);
  if (!(x1 >= x0)) return [-1, -1, 1, 1];
  const pad = 0.08 * Math.max(x1 - x0, y1 - y0, 1e-9);
  return [x0 - pad, y0 - pad, x1 + pad, y1 + pad];
}
