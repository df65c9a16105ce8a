// A picture in space that is turned by dragging, and drawn again only when something has changed: what the views of
// triangular surfaces and of TetraQuads share.
import {Color, PerspectiveCamera, Scene, Vector2, type WebGLRenderer} from 'three';
import {OrbitControls} from 'three/examples/jsm/controls/OrbitControls.js';
import {make} from './dom';
import {cameraKeys, KEY_WORDS} from './keys';
import {rendererOf} from './renderer';

export abstract class Stage {
  readonly canvas: HTMLCanvasElement;
  protected readonly renderer: WebGLRenderer;
  protected readonly camera = new PerspectiveCamera(35, 1, 0.01, 1000);
  protected readonly scene = new Scene();
  protected readonly controls: OrbitControls;
  private dirty = true;
  private shown = false;

  /** `cameraMoved` is told the camera's position and target after a drag, to seven digits. */
  protected constructor(protected readonly element: HTMLElement, label: string, antialias: boolean, cameraMoved: (camera: number[]) => void) {
    this.canvas = make('canvas', {tabindex: 0, 'aria-label': `${label} ${KEY_WORDS}`});
    this.renderer = rendererOf(this.canvas, antialias);
    this.camera.up.set(0, 0, 1);
    element.append(this.canvas);
    this.controls = new OrbitControls(this.camera, this.canvas);
    this.controls.addEventListener('change', () => this.redraw());
    const moved = () => cameraMoved([...this.camera.position.toArray(), ...this.controls.target.toArray()].map((v) => Number(v.toPrecision(7))));
    this.controls.addEventListener('end', moved);
    cameraKeys(this.canvas, this.camera, this.controls, moved);
    new ResizeObserver(() => this.redraw()).observe(element);
    const frame = () => {
      requestAnimationFrame(frame);
      if (this.dirty && this.shown) this.draw();
    };
    frame();
  }

  /** Draws one picture now; by render(). */
  protected abstract draw(): void;

  visible(on: boolean): void {
    this.shown = on;
    this.redraw();
  }
  redraw(): void {
    this.dirty = true;
  }
  setCamera(state: number[]): void {
    if (state.length !== 6 || !state.every(Number.isFinite)) return;
    this.camera.position.fromArray(state);
    this.controls.target.fromArray(state, 3);
    this.controls.update();
  }
  picture(): Promise<Blob | null> {
    this.draw();
    return new Promise((resolve) => this.canvas.toBlob(resolve, 'image/png'));
  }

  /** A colour of the page's theme: "--ink". */
  protected theme(name: string, otherwise: string): Color {
    return new Color(getComputedStyle(this.element).getPropertyValue(name).trim() || otherwise);
  }
  /** The camera for the element's shape. */
  protected prepare(): void {
    const aspect = (this.element.clientWidth || 1) / (this.element.clientHeight || 1);
    this.camera.aspect = aspect;
    // A narrow picture (a phone's) sees as much from side to side as a wide one.
    this.camera.fov = (360 / Math.PI) * Math.atan(Math.tan((17.5 * Math.PI) / 180) * Math.max(1, 1.25 / aspect));
    this.camera.updateProjectionMatrix();
    this.camera.updateMatrixWorld();
  }
  /** The scene on the page's sky, `ratio` pixels of the picture for one of the page. False: the element has no size. */
  protected render(ratio: number): boolean {
    this.dirty = false;
    const width = this.element.clientWidth, height = this.element.clientHeight;
    if (width === 0 || height === 0) return false;
    if (this.renderer.getPixelRatio() !== ratio) this.renderer.setPixelRatio(ratio);
    const size = this.renderer.getSize(new Vector2());
    if (size.x !== width || size.y !== height) this.renderer.setSize(width, height, false);
    this.prepare();
    this.renderer.setClearColor(this.theme('--sky', '#e8edf2'), 1);
    this.renderer.render(this.scene, this.camera);
    return true;
  }
}
