// Small pieces of page: elements with attributes and children, and the controls that all views share.

type Child = Node | string;
type Attributes = Record<string, string | number | boolean | ((event: Event) => void)>;

function fill(element: Element, attributes: Attributes, children: Child[]): void {
  for (const [name, value] of Object.entries(attributes)) {
    if (typeof value === 'function') element.addEventListener(name, value);
    else if (value === true) element.setAttribute(name, '');
    else if (value !== false) element.setAttribute(name, String(value));
  }
  element.append(...children);
}

export function make<K extends keyof HTMLElementTagNameMap>(tag: K, attributes: Attributes = {}, ...children: Child[]): HTMLElementTagNameMap[K] {
  const element = document.createElement(tag);
  fill(element, attributes, children);
  return element;
}

export function svg<K extends keyof SVGElementTagNameMap>(tag: K, attributes: Attributes = {}, ...children: Child[]): SVGElementTagNameMap[K] {
  const element = document.createElementNS('http://www.w3.org/2000/svg', tag);
  fill(element, attributes, children);
  return element;
}

/** A number as a person reads it: at most `digits` significant ones, no trailing zeros, a true minus. */
export function say(value: unknown, digits = 6): string {
  if (typeof value !== 'number' || !Number.isFinite(value)) return 'no data';
  if (value !== 0 && (Math.abs(value) < 1e-4 || Math.abs(value) >= 1e15)) return value.toExponential(3).replace('-', '−');
  const text = Math.abs(value) >= 10 ** digits ? value.toFixed(0) : String(Number(value.toPrecision(digits)));
  return text.replace('-', '−');
}

export interface Control {
  element: HTMLElement;
  /** Shows what the state says. */
  show(value: never): void;
}

let labels = 0;

function labelled(words: string, ...inputs: HTMLElement[]): HTMLElement {
  const id = `control-${++labels}`;
  inputs[0].id = id;
  for (const other of inputs.slice(1)) other.setAttribute('aria-label', words);
  return make('div', {class: 'control'}, make('label', {for: id}, words), make('div', {class: 'inputs'}, ...inputs));
}

/** One of several words. */
export function choice(words: string, options: [value: string, text: string][], changed: (value: string) => void) {
  const select: HTMLSelectElement = make('select', {change: () => changed(select.value)}, ...options.map(([value, text]) => make('option', {value}, text)));
  return {
    element: labelled(words, select),
    show(value: string) { select.value = value; },
    /** Other words to choose from, where they are others. */
    options(list: [value: string, text: string][]) {
      if (JSON.stringify([...select.options].map((option) => [option.value, option.text])) !== JSON.stringify(list)) select.replaceChildren(...list.map(([value, text]) => make('option', {value}, text)));
    },
    enable(value: string, on: boolean) {
      for (const option of select.options) if (option.value === value) option.disabled = !on;
    },
  };
}

export function toggle(words: string, changed: (on: boolean) => void) {
  const box: HTMLInputElement = make('input', {type: 'checkbox', change: () => changed(box.checked)});
  return {
    element: make('label', {class: 'toggle'}, box, make('span', {}, words)),
    show(on: boolean) { box.checked = on; },
  };
}

/**
 * A slider with a number beside it. With `logarithmic`, equal steps of the slider are equal ratios. The number takes
 * any value from low to high, the slider 1000 steps.
 */
export function slider(words: string, unit: string, changed: (value: number) => void, logarithmic = false) {
  let low = 0, high = 1, step = 0;
  const to = (t: number) => logarithmic ? low * (high / low) ** t : low + (high - low) * t;
  const from = (v: number) => Math.min(1, Math.max(0, logarithmic ? Math.log(v / low) / Math.log(high / low) : (v - low) / (high - low)));
  const round = (v: number) => step > 0 ? Math.round(v / step) * step : Number(v.toPrecision(3));
  const range: HTMLInputElement = make('input', {type: 'range', min: 0, max: 1000, step: 1, input: () => commit(round(to(Number(range.value) / 1000)))});
  const number: HTMLInputElement = make('input', {type: 'number', step: 'any', change: () => {
    const v = Number(number.value);
    if (number.value === '' || !Number.isFinite(v)) return;
    commit(Math.min(high, Math.max(low, v)));
  }});
  function commit(v: number) {
    show(v);
    changed(v);
  }
  function show(v: number) {
    range.value = String(Math.round(1000 * from(v)));
    number.value = String(Number(v.toPrecision(9)));
  }
  return {
    element: labelled(unit ? `${words} (${unit})` : words, range, number),
    show,
    limits(newLow: number, newHigh: number, newStep = 0) {
      low = newLow;
      high = newHigh;
      step = newStep;
    },
  };
}

/** Numbers beside their names. */
export function table(rows: [name: string, value: string][]): HTMLElement {
  return make('dl', {}, ...rows.flatMap(([name, value]) => [make('dt', {}, name), make('dd', {}, value)]));
}

/** A drawing as a file of its own: with the colours that the page's style gives. */
export function svgFile(element: SVGElement): Blob {
  const copy = element.cloneNode(true) as SVGElement;
  const from = [element, ...element.querySelectorAll('*')], to = [copy, ...copy.querySelectorAll('*')];
  from.forEach((one, k) => {
    const style = getComputedStyle(one);
    for (const name of ['fill', 'stroke', 'stroke-width', 'stroke-dasharray', 'font-size', 'font-family', 'opacity']) to[k].setAttribute(name, style.getPropertyValue(name));
  });
  for (const hit of copy.querySelectorAll('.hit')) hit.remove();
  const box = element.getBoundingClientRect();
  copy.setAttribute('xmlns', 'http://www.w3.org/2000/svg');
  copy.setAttribute('width', String(box.width));
  copy.setAttribute('height', String(box.height));
  return new Blob([copy.outerHTML], {type: 'image/svg+xml'});
}

function shapeOf(element: Element): Path2D | null {
  if (element instanceof SVGPathElement) return new Path2D(element.getAttribute('d') ?? '');
  const path = new Path2D();
  if (element instanceof SVGLineElement) {
    path.moveTo(element.x1.baseVal.value, element.y1.baseVal.value);
    path.lineTo(element.x2.baseVal.value, element.y2.baseVal.value);
  } else if (element instanceof SVGCircleElement) {
    path.arc(element.cx.baseVal.value, element.cy.baseVal.value, element.r.baseVal.value, 0, 2 * Math.PI);
  } else if (element instanceof SVGRectElement) {
    path.rect(element.x.baseVal.value, element.y.baseVal.value, element.width.baseVal.value, element.height.baseVal.value);
  } else return null;
  return path;
}

/** A drawing in pixels (of lines, paths, circles, rectangles and texts) as a PNG, twice as fine as the screen: drawn anew,
 * since the page's security policy lets no picture in that the program did not send. */
export function svgPicture(element: SVGSVGElement, background: string): Promise<Blob | null> {
  const box = element.getBoundingClientRect(), ratio = 2;
  const canvas = make('canvas', {width: Math.max(1, Math.round(box.width * ratio)), height: Math.max(1, Math.round(box.height * ratio))});
  const context = canvas.getContext('2d');
  if (!context) return Promise.resolve(null);
  context.scale(ratio, ratio);
  context.fillStyle = background;
  context.fillRect(0, 0, box.width, box.height);
  for (const one of element.querySelectorAll('*')) {
    const style = getComputedStyle(one), shape = shapeOf(one);
    if (one.classList.contains('hit')) continue;
    context.globalAlpha = Number(style.opacity);
    if (one instanceof SVGTextElement) {
      context.font = `${style.fontSize} ${style.fontFamily}`;
      context.fillStyle = style.fill;
      context.fillText(one.textContent ?? '', Number(one.getAttribute('x')), Number(one.getAttribute('y')));
    }
    if (!shape) continue;
    if (style.fill !== 'none') {
      context.fillStyle = style.fill;
      context.fill(shape);
    }
    if (style.stroke === 'none') continue;
    context.strokeStyle = style.stroke;
    context.lineWidth = parseFloat(style.strokeWidth);
    context.setLineDash(style.strokeDasharray === 'none' ? [] : style.strokeDasharray.split(/[\s,]+/).map(parseFloat));
    context.stroke(shape);
  }
  return new Promise((resolve) => canvas.toBlob(resolve, 'image/png'));
}

/** Gives the browser a file to save. */
export function download(name: string, content: Blob): void {
  const address = URL.createObjectURL(content);
  const link = make('a', {href: address, download: name});
  document.body.append(link);
  link.click();
  link.remove();
  setTimeout(() => URL.revokeObjectURL(address), 10_000);
}
