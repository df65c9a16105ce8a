// The contours as a drawing seen from above, with a scale: a file of its own.
import {say} from '../dom';
import {roundStep} from './state';

const SIZE = 1000, MARGIN = 20;  // of the drawing

/** Pairs of points [x, y, z] as SVG paths: pairs that go on where the last one ended are one line. */
export function planPath(segments: Float32Array, place: (x: number, y: number) => [number, number]): string {
  let path = '', last = '';
  for (let i = 0; i + 5 < segments.length; i += 6) {
    const [from, to] = [i, i + 3].map((k) => place(segments[k], segments[k + 1]).map((v) => v.toFixed(2)).join(' '));
    path += (from === last ? '' : 'M' + from) + 'L' + to;
    last = to;
  }
  return path;
}

/** `minor` and `major` contours (page's coordinates), on a terrain of `width` by `height` about the origin. */
export function planDrawing(minor: Float32Array, major: Float32Array, width: number, height: number, unit: string, words: string): string {
  const scale = (SIZE - 2 * MARGIN) / Math.max(width, height), w = width * scale, h = height * scale;
  const place = (x: number, y: number): [number, number] => [MARGIN + (x + width / 2) * scale, MARGIN + (height / 2 - y) * scale];
  const bar = roundStep(width / 4), bottom = MARGIN + h + 26;
  const line = (x1: number, y1: number, x2: number, y2: number) => `<path d="M${x1.toFixed(2)} ${y1.toFixed(2)}L${x2.toFixed(2)} ${y2.toFixed(2)}" stroke="#1c2329" stroke-width="1.5"/>`;
  const escaped = (text: string) => text.replace(/&/g, '&amp;').replace(/</g, '&lt;');
  return `<svg xmlns="http://www.w3.org/2000/svg" width="${(w + 2 * MARGIN).toFixed(0)}" height="${(h + 2 * MARGIN + 30).toFixed(0)}" font-family="sans-serif" font-size="13" fill="none">
<rect width="100%" height="100%" fill="#ffffff"/>
<rect x="${MARGIN}" y="${MARGIN}" width="${w.toFixed(2)}" height="${h.toFixed(2)}" stroke="#9aa5ab"/>
<path class="minor" stroke="#8a5a2b" stroke-width="0.6" stroke-linejoin="round" d="${planPath(minor, place)}"/>
<path class="major" stroke="#5d3716" stroke-width="1.3" stroke-linejoin="round" d="${planPath(major, place)}"/>
${line(MARGIN, bottom, MARGIN + bar * scale, bottom)}${line(MARGIN, bottom - 4, MARGIN, bottom + 4)}${line(MARGIN + bar * scale, bottom - 4, MARGIN + bar * scale, bottom + 4)}
<text x="${(MARGIN + bar * scale + 8).toFixed(2)}" y="${(bottom + 4).toFixed(2)}" fill="#1c2329">${escaped(`${say(bar)} ${unit}; ${words}`)}</text>
</svg>
`;
}
