// What the terrain view shows, as plain data.
export type Surface = 'linear' | 'powell-sabin' | 'clough-tocher';
export type Fit = 'interpolate' | 'least-squares' | 'z-only' | 'surface';
export type Colour = 'heights' | 'error' | 'slope' | 'plain';
export type Tool = 'look' | 'ask' | 'profile' | 'viewshed';
export type Place = [x: number, y: number];

export interface PanelState {
  surface: Surface;
  fit: Fit;
}

export interface TerrainState {
  file: number;
  budget: 'error' | 'vertices';
  maxError: number;
  vertices: number;
  panels: PanelState[];
  colour: Colour;
  triangles: boolean;
  contours: boolean;
  interval: number;
  exaggeration: number;
  light: number;
  tool: Tool;
  asked: Place | null;
  line: Place[];
  observer: Place | null;
  snap: boolean;  // clicks go to the centres of cells
  eye: number;
  radius: number;
  camera: number[] | null;
}

/** The three surfaces that are set side by side: flat, the terrain paper's, and fitted by its own error. */
export const SIDE_BY_SIDE: PanelState[] = [
  {surface: 'linear', fit: 'interpolate'},
  {surface: 'clough-tocher', fit: 'interpolate'},
  {surface: 'clough-tocher', fit: 'surface'},
];

export const SURFACES: [Surface, string][] = [
  ['linear', 'flat triangles'],
  ['powell-sabin', 'Powell–Sabin (degree 2)'],
  ['clough-tocher', 'Clough–Tocher (degree 3)'],
];
export const FITS: [Fit, string][] = [
  ['interpolate', 'through the vertices (the paper’s)'],
  ['least-squares', 'least squares, heights and slopes'],
  ['z-only', 'least squares, heights alone'],
  ['surface', 'refined by its own error'],
];

export interface FileInfo {
  name: string;
  described: string;
  kind: 'grid' | 'model';
  unit: string;
  crs: string;
  geographic: boolean;
  low: number;
  high: number;
  cell: number;
  cell_size?: [width: number, height: number];
  columns?: number;
  rows?: number;
  valid?: number;
}

/** 1, 2 or 5 times a power of ten, at most `value`. */
export function roundStep(value: number): number {
  if (!(value > 0) || !Number.isFinite(value)) return 1;
  const power = 10 ** Math.floor(Math.log10(value));
  const lead = value / power;
  return (lead >= 5 ? 5 : lead >= 2 ? 2 : 1) * power;
}

/** How a file is first seen: a smooth surface within 1 % of its range of heights. */
export function firstLook(file: number, info: FileInfo): TerrainState {
  const range = Math.max(info.high - info.low, 1e-6);
  return {
    file,
    budget: 'error',
    maxError: roundStep(range / 50),
    vertices: Math.max(100, Math.min(20_000, Math.round((info.valid ?? 10_000) / 100))),
    panels: [SIDE_BY_SIDE[1]],
    colour: 'heights',
    triangles: false,
    contours: false,
    interval: roundStep(range / 15),
    exaggeration: 1,
    light: 315,
    tool: 'look',
    asked: null,
    line: [],
    observer: null,
    snap: false,
    eye: 2,
    radius: 0,
    camera: null,
  };
}

/** The centre of the cell that a place (in the page's coordinates, which start in the middle) is nearest to. */
export function cellCentre([x, y]: Place, info: FileInfo): Place {
  const {cell_size: [width, height] = [0, 0], columns = 0, rows = 0} = info;
  if (!(width > 0 && height > 0 && columns > 0 && rows > 0)) return [x, y];
  const along = (v: number, step: number, count: number) => {
    const middle = (count - 1) / 2;
    return (Math.min(count - 1, Math.max(0, Math.round(v / step + middle))) - middle) * step;
  };
  return [along(x, width, columns), along(y, height, rows)];
}

/** What is asked of the program for one panel; equal requests give equal models. */
export function fitRequest(state: TerrainState, panel: PanelState, triangles: number): Record<string, unknown> {
  return {
    file: state.file,
    surface: panel.surface,
    fit: panel.fit,
    ...(state.budget === 'error' ? {max_error: state.maxError} : {vertices: Math.round(state.vertices)}),
    triangles,
  };
}
