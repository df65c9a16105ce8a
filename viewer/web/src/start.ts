// The start page: what is open, and examples to begin with.
import {PRESETS} from './curves/state';
import {make} from './dom';
import {PATCH_PRESETS} from './patches/state';
import type {FileInfo} from './terrain/state';
import {TETRA_PRESETS} from './tetraquads/state';

export function startPage(files: FileInfo[], openTerrain: (file: number) => void, openCurves: (preset: number) => void, openPatch: (preset: number) => void, openTetra: (preset: number) => void): HTMLElement {
  const button = (words: string, detail: string, click: () => void) => make('button', {type: 'button', class: 'card', click}, make('strong', {}, words), make('span', {}, detail));
  return make('div', {class: 'start'},
    make('section', {}, make('h2', {}, 'Terrains'), make('p', {}, 'A grid becomes a surface of polynomial patches: fit it, see its errors, ask it, set surfaces side by side.'),
      make('div', {class: 'cards'}, ...files.map((info, k) => button(info.name, info.described, () => openTerrain(k))))),
    make('section', {}, make('h2', {}, 'Curves'), make('p', {}, 'Draw and drag control points, walk through de Casteljau’s triangle, read the continuity of each join.'),
      make('div', {class: 'cards'}, ...PRESETS.map(([name, document], k) => button(name, document.curves.map((spec) => spec.kind).filter((kind, i, all) => all.indexOf(kind) === i).join(', '), () => openCurves(k))))),
    make('section', {}, make('h2', {}, 'Triangular surfaces'), make('p', {}, 'Three space curves span a surface: drag their points, change its recovery, look at zebra stripes and curvature.'),
      make('div', {class: 'cards'}, ...PATCH_PRESETS.map(([name, document], k) => button(name, `three curves of degree ${document.patches[0].sides.map((side) => side.points.length - 1).join(', ')}`, () => openPatch(k))))),
    make('section', {}, make('h2', {}, 'TetraQuads'), make('p', {}, 'A quadric at each vertex of tetrahedra, one implicit cubic in each: ray cast from the quadrics themselves.'),
      make('div', {class: 'cards'}, ...TETRA_PRESETS.map(([name, document], k) => button(name, `${document.tetrahedra.length} ${document.tetrahedra.length === 1 ? 'tetrahedron' : 'tetrahedra'}`, () => openTetra(k))))),
    make('p', {class: 'hint'}, 'Files are named on the command line: retalho view FILE… Nothing leaves this machine.'));
}
