// What the TetraQuad view shows: quadrics at the vertices of tetrahedra, by hand (docs/tetraquad.md) or out of a model.
import ellipsoids from '../../../../examples/tetraquads/ellipsoids-4.json';
import hyperboloid from '../../../../examples/tetraquads/hyperboloid.json';
import jump from '../../../../examples/tetraquads/jump.json';
import large from '../../../../examples/tetraquads/sphere-hyperboloid-large.json';
import small from '../../../../examples/tetraquads/sphere-hyperboloid-small.json';
import sphere from '../../../../examples/tetraquads/sphere.json';

export const TERMS = ['1', 'x', 'y', 'z', 'xx', 'yy', 'zz', 'xy', 'xz', 'yz'] as const;
export type Term = (typeof TERMS)[number];
export type Terms = Partial<Record<Term, number>>;

export interface QuadricDocument {
  tetrahedra: number[][];
  everywhere?: Terms;
  quadrics?: (Terms & {vertex: number[]})[];
  [key: string]: unknown;
}

export interface TetraQuadsState {
  file: number;  // of the command line; -1: the document
  cloud: number;  // of the command line; -1: none
  resolution: number;
  document: QuadricDocument;
  vertex: number[] | null;
  edges: boolean;
  onSurface: boolean;
  cutAxis: 'none' | 'x' | 'y' | 'z';
  cut: number;  // a share of the box
  ask: boolean;
  asked: {origin: number[]; direction: number[]} | null;
  camera: number[] | null;
}

const asDocument = (given: unknown): QuadricDocument => given as QuadricDocument;
export const TETRA_PRESETS: [name: string, document: QuadricDocument][] = [
  ['A sphere', asDocument(sphere)],
  ['A hyperboloid', asDocument(hyperboloid)],
  ['Sphere and hyperboloid, far apart', asDocument(large)],
  ['Sphere and hyperboloid, near', asDocument(small)],
  ['Four ellipsoids', asDocument(ellipsoids)],
  ['Normals that jump', asDocument(jump)],
];

export function firstTetraQuads(): TetraQuadsState {
  return {file: -1, cloud: -1, resolution: 24, document: structuredClone(TETRA_PRESETS[0][1]), vertex: null, edges: true, onSurface: false, cutAxis: 'none', cut: 0.5, ask: false, asked: null, camera: null};
}

/** From coarse to fine: the resolutions at which a cloud is reconstructed until `last`. */
export function coarseToFine(last: number): number[] {
  const steps: number[] = [];
  for (let r = 8; r < last; r *= 1.6) steps.push(Math.round(r));
  return [...steps.filter((r) => r < 0.85 * last), last];
}

/** The quadric of a lattice vertex as the document has it. */
export function termsOf(document: QuadricDocument, vertex: number[]): Terms {
  const own = document.quadrics?.find((one) => one.vertex.every((v, k) => v === vertex[k]));
  const terms: Terms = {};
  for (const term of TERMS) {
    const value = own ? own[term] : document.everywhere?.[term];
    if (value !== undefined) terms[term] = value;
  }
  return terms;
}

/** Sets one term of one vertex's quadric: it gets one of its own if it had none. */
export function setTerm(document: QuadricDocument, vertex: number[], term: Term, value: number): void {
  const list = (document.quadrics ??= []);
  let own = list.find((one) => one.vertex.every((v, k) => v === vertex[k]));
  if (!own) {
    own = {vertex: [...vertex], ...termsOf(document, vertex)};
    list.push(own);
  }
  own[term] = value;
}
