// The drawing of the curves: an SVG whose lines keep their width at any zoom, with points that are dragged.
import {make, say, svg} from '../dom';
import {ticks} from '../terrain/profile';
import {chosen, clippedPath, type CurvesState, type Drawn, type Point} from './state';

const COLOURS = 6;

export interface CanvasEvents {
  drag(index: number, at: Point, tangent: boolean): void;
  select(curve: number, point: number): void;
  draw(at: Point): void;
  window(box: number[]): void;
}

export class CurveCanvas {
  readonly element = svg('svg', {class: 'curves', tabindex: 0, role: 'application', 'aria-label': 'The curves. Tab reaches the points, arrow keys move them.'});
  private box = [-1, -1, 1, 1];
  private state: CurvesState | null = null;
  private dragging: {index: number; tangent: boolean} | {from: Point; box: number[]} | {tap: Point} | {pinched: [Point, Point]} | null = null;
  private readonly fingers = new Map<number, Point>();

  constructor(private events: CanvasEvents) {
    this.element.addEventListener('pointerdown', (event) => this.touched(event), {capture: true});
    this.element.addEventListener('pointerdown', (event) => this.down(event));
    this.element.addEventListener('pointermove', (event) => this.moved(event));
    this.element.addEventListener('pointerup', (event) => this.lifted(event, true));
    this.element.addEventListener('pointercancel', (event) => this.lifted(event, false));
    this.element.addEventListener('wheel', (event) => this.wheel(event), {passive: false});
    this.element.addEventListener('keydown', (event) => this.key(event));
  }

  /** Screen to the curves' own coordinates. */
  private place(event: {clientX: number; clientY: number}): Point {
    const rect = this.element.getBoundingClientRect(), [x0, y0, x1, y1] = this.shownBox();
    return [x0 + ((event.clientX - rect.left) / rect.width) * (x1 - x0), y1 - ((event.clientY - rect.top) / rect.height) * (y1 - y0)];
  }

  /** Where a place is on the screen, in CSS pixels of the drawing. */
  private screen(p: Point): Point {
    const [x0, y0, x1, y1] = this.shownBox(), width = this.element.clientWidth || 1, height = this.element.clientHeight || 1;
    return [((p[0] - x0) / (x1 - x0)) * width, ((y1 - p[1]) / (y1 - y0)) * height];
  }

  /** The box, widened to the drawing's own shape: circles stay round. */
  private shownBox(): number[] {
    const [x0, y0, x1, y1] = this.box, width = this.element.clientWidth || 1, height = this.element.clientHeight || 1;
    const unit = Math.max((x1 - x0) / width, (y1 - y0) / height), cx = (x0 + x1) / 2, cy = (y0 + y1) / 2;
    return [cx - (unit * width) / 2, cy - (unit * height) / 2, cx + (unit * width) / 2, cy + (unit * height) / 2];
  }

  show(state: CurvesState, drawn: Drawn[], box: number[]): void {
    this.state = state;
    this.box = box;
    const focused = (document.activeElement as Element | null)?.getAttribute('data-index');
    const parts: Element[] = [...this.grid()];
    drawn.forEach((curve, k) => parts.push(...this.curve(state, curve, k)));
    parts.push(...this.handles(state));
    this.element.replaceChildren(...parts);
    this.element.dataset.tool = state.tool;
    if (focused) this.element.querySelector<SVGElement>(`[data-index="${focused}"]`)?.focus();
  }

  private grid(): Element[] {
    const [x0, y0, x1, y1] = this.shownBox(), parts: Element[] = [];
    for (const x of ticks(x0, x1, 9)) {
      const [sx] = this.screen([x, 0]);
      parts.push(svg('line', {class: x === 0 ? 'axis' : 'rule', x1: sx, x2: sx, y1: 0, y2: '100%'}), svg('text', {x: sx + 3, y: this.element.clientHeight - 5}, say(x)));
    }
    for (const y of ticks(y0, y1, 7)) {
      const [, sy] = this.screen([0, y]);
      parts.push(svg('line', {class: y === 0 ? 'axis' : 'rule', x1: 0, x2: '100%', y1: sy, y2: sy}), svg('text', {x: 3, y: sy - 3}, say(y)));
    }
    return parts;
  }

  /** What lies far outside is cut off: browsers need minutes to dash a line of a million pixels. */
  private path(points: Point[]): string {
    return clippedPath(points.map((p) => this.screen(p)), 3000);
  }

  private curve(state: CurvesState, curve: Drawn, k: number): Element[] {
    const parts: Element[] = [], colour = `c${k % COLOURS}`;
    if (state.comb && curve.comb) {
      const strongest = Math.max(1e-300, ...curve.comb.flat().map((tooth) => Math.hypot(tooth[2], tooth[3])));
      const size = Math.hypot(this.box[2] - this.box[0], this.box[3] - this.box[1]);
      const scale = (0.13 * size * state.combScale) / strongest;
      for (const teeth of curve.comb) {
        const ends = teeth.map(([x, y, kx, ky]) => [x + scale * kx, y + scale * ky]);
        parts.push(svg('path', {class: 'comb', d: teeth.map((tooth, i) => this.path([tooth, ends[i]])).join('')}), svg('path', {class: 'comb edge', d: this.path(ends)}));
      }
    }
    for (const cell of curve.cells ?? []) {
      const [x, y] = this.screen([cell[0], cell[3]]), [x1, y1] = this.screen([cell[2], cell[1]]);
      parts.push(svg('rect', {class: 'cell', x: x - 2, y: y - 2, width: x1 - x + 4, height: y1 - y + 4}));
    }
    if (state.polygon) for (const control of curve.control ?? []) parts.push(svg('path', {class: 'polygon', d: this.path(control)}));
    if (state.hodograph && curve.hodograph) for (const line of curve.hodograph) parts.push(svg('path', {class: 'hodograph', d: this.path(line)}));
    const d = (curve.lines ?? []).map((line) => this.path(line)).join('');
    const hit = svg('path', {class: 'hit', d});
    hit.addEventListener('pointerdown', (event) => {
      if (this.state?.tool !== 'move') return;
      event.stopPropagation();
      this.events.select(k, -1);
    });
    parts.push(svg('path', {class: `curve ${colour}${k === state.selected ? ' chosen' : ''}`, d}), hit);
    if (k === state.selected && state.casteljau && curve.casteljau) {
      const {rows} = curve.casteljau;
      rows.forEach((row, r) => {
        if (r > 0 && row.length > 1) parts.push(svg('path', {class: 'casteljau', d: this.path(row)}));
        if (r > 0) for (const p of row) { const [x, y] = this.screen(p); parts.push(svg('circle', {class: r === rows.length - 1 ? 'answer' : 'between', cx: x, cy: y, r: r === rows.length - 1 ? 5 : 2.5})); }
      });
    }
    if (state.joins) {
      for (const join of curve.joins ?? []) {
        const [x, y] = this.screen(join.point);
        const words = join.kind === 'regular' ? `${join.C} ${join.G}` : `${join.kind} ${join.C} ${join.G}`;
        parts.push(svg('g', {class: `badge ${colour}`}, svg('circle', {cx: x, cy: y, r: 4}), svg('text', {x: x + 7, y: y - 7}, words)));
      }
      for (const p of curve.inflections ?? []) { const [x, y] = this.screen(p); parts.push(svg('rect', {class: 'inflection', x: x - 3, y: y - 3, width: 6, height: 6})); }
    }
    return parts;
  }

  private handles(state: CurvesState): Element[] {
    const spec = chosen(state), parts: Element[] = [];
    (spec?.points ?? []).forEach((p, index) => {
      const [x, y] = this.screen(p);
      const tangent = spec?.tangents?.[index];
      if (tangent) {
        const end = [p[0] + tangent[0] / 3, p[1] + tangent[1] / 3], [tx, ty] = this.screen(end);
        parts.push(svg('line', {class: 'tangent', x1: x, y1: y, x2: tx, y2: ty}), this.handle('tangent-end', index, [tx, ty], end, true));
      }
      parts.push(this.handle(index === state.point ? 'point chosen' : 'point', index, [x, y], p, false));
    });
    return parts;
  }

  private handle(kind: string, index: number, [cx, cy]: Point, value: Point, tangent: boolean): Element {
    const circle = svg('circle', {class: kind, cx, cy, r: tangent ? 5 : 6, tabindex: 0, 'data-index': tangent ? `t${index}` : index, role: 'button', 'aria-label': `${tangent ? 'Tangent at point' : 'Point'} ${index + 1}: ${say(value[0])}, ${say(value[1])}`});
    circle.addEventListener('pointerdown', (event) => {
      if (!this.state || this.state.tool !== 'move') return;
      event.stopPropagation();
      this.element.setPointerCapture(event.pointerId);
      this.dragging = {index, tangent};
      this.events.select(this.state.selected, index);
    });
    return circle;
  }

  /** Two fingers hold two places of the drawing: it moves and zooms with them. */
  private touched(event: PointerEvent): void {
    if (event.pointerType !== 'touch') return;
    this.fingers.set(event.pointerId, [event.clientX, event.clientY]);
    if (this.fingers.size !== 2) return;
    const [a, b] = [...this.fingers.values()].map(([clientX, clientY]) => this.place({clientX, clientY}));
    this.dragging = {pinched: [a, b]};
    this.element.setPointerCapture(event.pointerId);
    event.stopImmediatePropagation();
  }

  private lifted(event: PointerEvent, draws: boolean): void {
    this.fingers.delete(event.pointerId);
    const held = this.dragging;
    this.dragging = null;
    if (draws && held && 'tap' in held) this.events.draw(held.tap);
  }

  private pinch([a, b]: [Point, Point]): void {
    const [p, q] = [...this.fingers.values()], rect = this.element.getBoundingClientRect();
    const apart = Math.hypot(q[0] - p[0], q[1] - p[1]);
    if (apart < 1) return;
    const unit = Math.hypot(b[0] - a[0], b[1] - a[1]) / apart;
    const x = (a[0] + b[0]) / 2 + unit * (rect.left + rect.width / 2 - (p[0] + q[0]) / 2), y = (a[1] + b[1]) / 2 - unit * (rect.top + rect.height / 2 - (p[1] + q[1]) / 2);
    this.events.window([x - (unit * rect.width) / 2, y - (unit * rect.height) / 2, x + (unit * rect.width) / 2, y + (unit * rect.height) / 2]);
  }

  private down(event: PointerEvent): void {
    if (event.button !== 0) return;
    if (this.state?.tool === 'draw') {
      // A finger draws when it is lifted: it may be the first of two.
      if (event.pointerType !== 'touch') return this.events.draw(this.place(event));
      this.dragging = {tap: this.place(event)};
      return;
    }
    this.dragging = {from: [event.clientX, event.clientY], box: [...this.box]};
    this.element.setPointerCapture(event.pointerId);
  }

  private moved(event: PointerEvent): void {
    if (this.fingers.has(event.pointerId)) this.fingers.set(event.pointerId, [event.clientX, event.clientY]);
    const held = this.dragging;
    if (!held || 'tap' in held) return;
    if ('pinched' in held) { if (this.fingers.size === 2) this.pinch(held.pinched); return; }
    if ('index' in held) return this.events.drag(held.index, this.place(event), held.tangent);
    const [x0, , x1] = this.shownBox(), unit = (x1 - x0) / (this.element.clientWidth || 1);
    const dx = (held.from[0] - event.clientX) * unit, dy = (event.clientY - held.from[1]) * unit;
    this.events.window([held.box[0] + dx, held.box[1] + dy, held.box[2] + dx, held.box[3] + dy]);
  }

  private wheel(event: WheelEvent): void {
    event.preventDefault();
    const [x, y] = this.place(event), factor = Math.exp(event.deltaY * 0.0012), [x0, y0, x1, y1] = this.box;
    this.events.window([x + (x0 - x) * factor, y + (y0 - y) * factor, x + (x1 - x) * factor, y + (y1 - y) * factor]);
  }

  private key(event: KeyboardEvent): void {
    const label = (event.target as Element).getAttribute('data-index'), state = this.state;
    const ways: Record<string, Point> = {ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1]};
    const way = ways[event.key], spec = state ? chosen(state) : undefined;
    if (!label || !state || !spec || !way) return;
    event.preventDefault();
    const tangent = label.startsWith('t'), index = Number(label.replace('t', ''));
    const step = (state.snap > 0 ? state.snap : (this.box[2] - this.box[0]) / 200) * (event.shiftKey ? 10 : 1);
    const p = spec.points?.[index], v = spec.tangents?.[index];
    if (!p) return;
    const at = tangent && v ? [p[0] + v[0] / 3, p[1] + v[1] / 3] : p;
    this.events.drag(index, [at[0] + way[0] * step, at[1] + way[1] * step], tangent);
  }
}

export const emptyWords = (): HTMLElement => make('p', {class: 'hint'}, 'No curve: choose a preset, or draw one.');
