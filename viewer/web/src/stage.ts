// A picture in space that is turned by dragging, and drawn again only when something has changed: what the views of
// triangular surfaces and of TetraQuads share.
import {Color, PerspectiveCamera, Scene, Vector2, WebGLRenderer} from 'three';
import {OrbitControls} from 'three/examples/jsm/controls/OrbitControls.js';
import {make} from './dom';

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
    this.canvas = make('canvas', {tabindex: 0, 'aria-label': label});
    this.renderer = new WebGLRenderer({canvas: this.canvas, antialias});
    this.camera.up.set(0, 0, 1);
    element.append(this.canvas);
    this.controls = new OrbitControls(this.camera, this.canvas);
    this.controls.addEventListener('change', () => this.redraw());
    this.controls.addEventListener('end', () => cameraMoved([...this.camera.position.toArray(), ...this.controls.target.toArray()].map((v) => Number(v.toPrecision(7)))));
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

  /** The camera for the element's shape. */
  protected prepare(): void {
    this.camera.aspect = (this.element.clientWidth || 1) / (this.element.clientHeight || 1);
    this.camera.updateProjectionMatrix();
    this.camera.updateMatrixWorld();
  }
  /** The scene on the page's sky, `ratio` pixels of the picture for one of the page. False: the element has no size. */
  protected render(ratio: number): boolean {
    this.dirty = false;
    const width = this.element.clientWidth, height = this.element.clientHeight;
    if (width === 0 || height === 0) return false;
    this.renderer.setPixelRatio(ratio);
    const size = this.renderer.getSize(new Vector2());
    if (size.x !== width || size.y !== height) this.renderer.setSize(width, height, false);
    this.prepare();
    this.renderer.setClearColor(new Color(getComputedStyle(this.element).getPropertyValue('--sky').trim() || '#e8edf2'), 1);
    this.renderer.render(this.scene, this.camera);
    return true;
  }
}
