// The heights along a drawn line, as a chart: one line a surface, and the grid's own cells.
import {make, say, svg} from '../dom';

export interface ProfileLine {
  name: string;
  distance: Float64Array;
  height: Float64Array;
}

const WIDTH = 900, HEIGHT = 150, LEFT = 64, RIGHT = 12, TOP = 12, BOTTOM = 30;

/** Rounded values from low to high, about `count` of them. */
export function ticks(low: number, high: number, count: number): number[] {
  const raw = (high - low) / count, power = 10 ** Math.floor(Math.log10(raw));
  const step = [1, 2, 5, 10].map((k) => k * power).find((s) => s >= raw) ?? raw;
  const out: number[] = [];
  for (let v = Math.ceil(low / step) * step; v <= high + step * 1e-9; v += step) out.push(Number(v.toPrecision(12)));
  return out;
}

export function profileChart(lines: ProfileLine[], unit: string): HTMLElement {
  let low = Infinity, high = -Infinity, length = 0;
  for (const line of lines) {
    length = Math.max(length, line.distance[line.distance.length - 1]);
    for (const h of line.height) if (Number.isFinite(h)) { low = Math.min(low, h); high = Math.max(high, h); }
  }
  if (!(high >= low)) return make('p', {}, 'There is no data along this line.');
  if (high === low) high = low + 1;
  const x = (d: number) => LEFT + (d / length) * (WIDTH - LEFT - RIGHT), y = (h: number) => TOP + ((high - h) / (high - low)) * (HEIGHT - TOP - BOTTOM);
  const chart = svg('svg', {viewBox: `0 0 ${WIDTH} ${HEIGHT}`, class: 'chart', role: 'img', 'aria-label': `Profile of ${say(length)} ${unit}, heights ${say(low)} to ${say(high)} ${unit}`});
  for (const h of ticks(low, high, 4)) {
    chart.append(svg('line', {class: 'rule', x1: LEFT, x2: WIDTH - RIGHT, y1: y(h), y2: y(h)}), svg('text', {x: LEFT - 6, y: y(h) + 4, 'text-anchor': 'end'}, say(h)));
  }
  for (const d of ticks(0, length, 7)) chart.append(svg('text', {x: x(d), y: HEIGHT - 12, 'text-anchor': 'middle'}, say(d)));
  chart.append(svg('text', {x: WIDTH - RIGHT, y: HEIGHT - 1, 'text-anchor': 'end'}, `distance and height in ${unit}`));
  lines.forEach((line, k) => {
    let path = '', down = false;
    line.height.forEach((h, i) => {
      if (!Number.isFinite(h)) { down = false; return; }
      path += `${down ? 'L' : 'M'}${x(line.distance[i]).toFixed(2)} ${y(h).toFixed(2)}`;
      down = true;
    });
    chart.append(svg('path', {class: `series s${k}`, d: path}));
    chart.append(svg('text', {class: `name s${k}`, x: LEFT + 8 + k * 210, y: TOP + 2}, line.name));
  });
  return make('figure', {class: 'profile'}, chart);
}
