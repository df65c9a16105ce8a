// The camera by the keyboard, in every view in space: arrow keys move, with Shift they turn, + and - zoom.
import {type PerspectiveCamera, Vector3} from 'three';
import type {OrbitControls} from 'three/examples/jsm/controls/OrbitControls.js';

const TURN = (5 * Math.PI) / 180, ZOOM = 1.15;
const UP = new Vector3(0, 0, 1);
const ARROWS: Record<string, [aside: number, up: number]> = {ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1]};
const ZOOMS: Record<string, number> = {'+': 1 / ZOOM, '=': 1 / ZOOM, '-': ZOOM, _: ZOOM};

export const KEY_WORDS = 'Arrow keys move, with Shift they turn, plus and minus zoom.';

/** The way from the target to the camera after a turn; `lowest`: the largest angle from straight up. */
export function turned(way: Vector3, aside: number, up: number, lowest: number): Vector3 {
  const length = way.length(), polar = Math.acos(Math.min(1, Math.max(-1, way.z / length)));
  const next = Math.min(Math.min(lowest, Math.PI - 0.01), Math.max(0.01, polar + up * TURN));
  const azimuth = Math.atan2(way.y, way.x) + aside * TURN;
  return new Vector3(Math.sin(next) * Math.cos(azimuth), Math.sin(next) * Math.sin(azimuth), Math.cos(next)).multiplyScalar(length);
}

/** `moved` is told when the keys are let go. The camera's up is z. */
export function cameraKeys(canvas: HTMLCanvasElement, camera: PerspectiveCamera, controls: OrbitControls, moved: () => void): void {
  canvas.addEventListener('keydown', (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const way = camera.position.clone().sub(controls.target), zoom = ZOOMS[event.key], turn = event.shiftKey ? ARROWS[event.key] : undefined;
    if (zoom) way.setLength(Math.min(controls.maxDistance, Math.max(controls.minDistance, way.length() * zoom)));
    else if (turn) way.copy(turned(way, ...turn, controls.maxPolarAngle));
    else return;
    camera.position.copy(controls.target).add(way);
    camera.up.copy(UP);
    controls.update();
    event.preventDefault();
    event.stopImmediatePropagation();
  });
  controls.listenToKeyEvents(canvas);
  canvas.addEventListener('keyup', (event) => { if (event.key in ARROWS || event.key in ZOOMS) moved(); });
}
