// The terrain's picture: one canvas, panels side by side, one camera for all of them, drawn when something has changed.
import {PerspectiveCamera, Raycaster, Scene, Vector2, Vector3, type WebGLRenderer} from 'three';
import {OrbitControls} from 'three/examples/jsm/controls/OrbitControls.js';
import {make} from '../dom';
import {cameraKeys, KEY_WORDS} from '../keys';
import {isSoftware, rendererOf} from '../renderer';
import type {Panel} from './panel';
import type {Place} from './state';

export class TerrainScene {
  readonly element = make('div', {class: 'stage'});
  readonly canvas = make('canvas', {tabindex: 0, 'aria-label': `The terrain. Drag turns, right drag moves, the wheel zooms. ${KEY_WORDS}`});
  readonly software: boolean;
  private readonly renderer: WebGLRenderer;
  private readonly camera = new PerspectiveCamera(40, 1, 1, 1e6);
  private readonly scene = new Scene();
  private readonly controls: OrbitControls;
  private readonly raycaster = new Raycaster();
  private panels: Panel[] = [];
  private dirty = true;
  private shown = false;
  private drawn = false;

  constructor(cameraMoved: (camera: number[]) => void) {
    this.renderer = rendererOf(this.canvas, true);
    this.software = isSoftware(this.renderer);
    this.camera.up.set(0, 0, 1);
    this.element.append(this.canvas);
    this.controls = new OrbitControls(this.camera, this.canvas);
    this.controls.maxPolarAngle = Math.PI * 0.495;
    this.controls.screenSpacePanning = false;
    this.controls.addEventListener('change', () => this.redraw());
    const moved = () => cameraMoved(this.cameraState());
    this.controls.addEventListener('end', moved);
    cameraKeys(this.canvas, this.camera, this.controls, moved);
    // The first size is taken as soon as there is one, and the shaders are made while the program is at work: else the first
    // picture pays for both in one task.
    new ResizeObserver(() => {
      if (!this.drawn) this.takeSize();
      this.redraw();
    }).observe(this.element);
    const frame = () => {
      requestAnimationFrame(frame);
      if (this.dirty && this.shown) this.draw();
    };
    frame();
  }

  setPanels(panels: Panel[]): void {
    for (const panel of this.panels) this.scene.remove(panel.group);
    this.panels = panels;
    for (const panel of panels) this.scene.add(panel.group);
    this.element.replaceChildren(this.canvas, ...panels.map((panel) => panel.overlay));
    this.element.dataset.panels = String(panels.length);
    if (!this.drawn) setTimeout(() => this.renderer.compile(this.scene, this.camera));
    this.redraw();
  }

  visible(on: boolean): void {
    this.shown = on;
    this.redraw();
  }

  redraw(): void {
    this.dirty = true;
  }

  /** Looks at the whole terrain from the south. */
  frame(width: number, height: number, middle: number): void {
    const size = Math.max(width, height);
    this.camera.near = size / 1000;
    this.camera.far = size * 20;
    this.controls.target.set(0, 0, middle);
    this.camera.position.set(0, -size * 1.2, middle + size * 1.0);
    this.controls.minDistance = size / 200;
    this.controls.maxDistance = size * 6;
    this.controls.update();
    this.redraw();
  }

  cameraState(): number[] {
    return [...this.camera.position.toArray(), ...this.controls.target.toArray()].map((v) => Number(v.toPrecision(7)));
  }
  setCamera(state: number[]): void {
    if (state.length !== 6 || !state.every(Number.isFinite)) return;
    this.camera.position.fromArray(state);
    this.controls.target.fromArray(state, 3);
    this.controls.update();
    this.redraw();
  }

  /** Where a click lies on the surface of the panel under it, in the page's coordinates; and which panel. */
  pick(event: MouseEvent): {panel: number; at: Place; height: number} | null {
    const box = this.canvas.getBoundingClientRect();
    const share = box.width / this.panels.length;
    const panel = Math.min(this.panels.length - 1, Math.max(0, Math.floor((event.clientX - box.left) / share)));
    if (!this.panels[panel]?.report) return null;
    this.setAspect(share / box.height);
    const x = ((event.clientX - box.left - panel * share) / share) * 2 - 1, y = 1 - ((event.clientY - box.top) / box.height) * 2;
    this.raycaster.setFromCamera(new Vector2(x, y), this.camera);
    this.panels[panel].group.updateMatrixWorld();
    const hit = this.raycaster.intersectObject(this.panels[panel].surface, false)[0];
    return hit ? {panel, at: [hit.point.x, hit.point.y], height: hit.point.z / this.panels[panel].group.scale.z} : null;
  }

  /** Where a place of panel 0 is on the screen, in CSS pixels of the page: for tests and for the keyboard. */
  toScreen(at: [number, number, number]): [number, number] {
    const box = this.canvas.getBoundingClientRect();
    const share = box.width / Math.max(1, this.panels.length);
    this.setAspect(share / box.height);
    const p = new Vector3(...at).project(this.camera);
    return [box.left + ((p.x + 1) / 2) * share, box.top + ((1 - p.y) / 2) * box.height];
  }

  /** Where the camera is, and half a pixel as an angle: what the program needs to know for the level of detail. */
  get target(): [number, number, number] {
    return this.controls.target.toArray();
  }
  get look(): {eye: [number, number, number]; forward: [number, number, number]; angle: number} {
    const height = this.element.clientHeight || 800;
    this.setAspect((this.element.clientWidth || 1200) / Math.max(1, this.panels.length) / height);
    return {eye: this.camera.position.toArray(), forward: this.camera.getWorldDirection(new Vector3()).toArray(), angle: Math.tan((this.camera.fov * Math.PI) / 360) / height};
  }

  /** The canvas at the element's size, which is returned; [0, 0] where it has none. */
  private takeSize(): [number, number] {
    const width = this.element.clientWidth, height = this.element.clientHeight;
    if (width === 0 || height === 0) return [0, 0];
    const ratio = this.software ? 1 : Math.min(2, devicePixelRatio);
    if (this.renderer.getPixelRatio() !== ratio) this.renderer.setPixelRatio(ratio);
    const size = this.renderer.getSize(new Vector2());
    if (size.x !== width || size.y !== height) this.renderer.setSize(width, height, false);
    return [width, height];
  }

  draw(): void {
    this.dirty = false;
    const [width, height] = this.takeSize(), n = this.panels.length;
    if (width === 0 || n === 0) return;
    this.drawn = true;
    const background = getComputedStyle(this.element).getPropertyValue('--sky').trim() || '#e8edf2';
    this.renderer.setClearColor(background);
    this.renderer.setScissorTest(true);
    this.panels.forEach((panel, k) => {
      const left = Math.round((width * k) / n), right = Math.round((width * (k + 1)) / n);
      for (const other of this.panels) other.group.visible = other === panel;
      this.setAspect((right - left) / height);
      panel.size(right - left, height);
      this.renderer.setViewport(left, 0, right - left, height);
      this.renderer.setScissor(left, 0, right - left - (k + 1 < n ? 2 : 0), height);
      this.renderer.render(this.scene, this.camera);
    });
  }

  /** The picture as it is now. */
  picture(): Promise<Blob | null> {
    this.draw();
    return new Promise((resolve) => this.canvas.toBlob(resolve, 'image/png'));
  }

  private setAspect(aspect: number): void {
    // A narrow panel sees as much from side to side as a wide one.
    this.camera.aspect = aspect;
    this.camera.fov = (360 / Math.PI) * Math.atan(Math.tan((20 * Math.PI) / 180) * Math.max(1, 1.25 / aspect));
    this.camera.updateProjectionMatrix();
    this.camera.updateMatrixWorld();
  }
}
