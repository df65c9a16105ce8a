// Colour scales that people with any colour vision can read, and their legends.
import {make, say} from './dom';

type Stop = [number, number, number];

// The program's own ramps (src/retalho/render/color.cpp): batlow (F. Crameri, 2018), raised to leave room for shading,
// and RdBu (ColorBrewer); slopes: cividis (Nuñez, Anderton and Renslow, 2018).
const BATLOW: Stop[] = [[1, 25, 89], [16, 63, 96], [28, 90, 98], [60, 109, 86], [104, 123, 62], [157, 137, 43], [210, 147, 67], [248, 161, 123], [253, 183, 188], [250, 204, 250]];
const RD_BU: Stop[] = [[33, 102, 172], [67, 147, 195], [146, 197, 222], [209, 229, 240], [247, 247, 247], [253, 219, 199], [244, 165, 130], [214, 96, 77], [178, 24, 43]];
const CIVIDIS: Stop[] = [[0, 32, 76], [0, 48, 110], [49, 68, 107], [87, 92, 109], [124, 123, 120], [158, 155, 117], [195, 187, 104], [231, 220, 82], [255, 233, 69]];

export type RampName = 'heights' | 'difference' | 'amount' | 'plain';

const RAMPS: Record<RampName, Stop[]> = {
  heights: BATLOW.map(([r, g, b]): Stop => [r * 0.8 + 51, g * 0.8 + 51, b * 0.8 + 51]),
  difference: RD_BU,
  amount: CIVIDIS,
  plain: [[225, 225, 220]],
};

export function rampColour(name: RampName, t: number): Stop {
  const stops = RAMPS[name];
  const place = Math.min(1, Math.max(0, Number.isFinite(t) ? t : 0)) * (stops.length - 1);
  const below = Math.min(stops.length - 1, Math.floor(place)), above = Math.min(stops.length - 1, below + 1);
  const f = place - below;
  return [0, 1, 2].map((k) => stops[below][k] * (1 - f) + stops[above][k] * f) as Stop;
}

/** RGBA, 256 steps: a texture's bytes. */
export function rampBytes(name: RampName): Uint8Array {
  const bytes = new Uint8Array(256 * 4);
  for (let i = 0; i < 256; ++i) bytes.set([...rampColour(name, i / 255).map(Math.round), 255], 4 * i);
  return bytes;
}

/** A bar with its numbers and unit. */
export function legend(name: RampName, title: string, unit: string, low: number, high: number): HTMLElement {
  const canvas = make('canvas', {width: 160, height: 10, role: 'img', 'aria-label': `${title}: from ${say(low, 4)} to ${say(high, 4)} ${unit}`});
  const context = canvas.getContext('2d');
  if (context) {
    for (let x = 0; x < 160; ++x) {
      context.fillStyle = `rgb(${rampColour(name, x / 159).map(Math.round).join(',')})`;
      context.fillRect(x, 0, 1, 10);
    }
  }
  const ticks = make('div', {class: 'ticks'}, ...[low, (low + high) / 2, high].map((v) => make('span', {}, say(v, 4))));
  return make('div', {class: 'legend'}, make('div', {}, unit ? `${title}, ${unit}` : title), canvas, ticks);
}
