// The picture of a triangular surface: the surface, its three curves, their control points to drag, the cursor.
import {BufferAttribute, BufferGeometry, Color, DoubleSide, GLSL3, Group, Line, LineBasicMaterial, LineSegments, Mesh, MeshBasicMaterial, Plane, Raycaster, ShaderMaterial, SphereGeometry, Vector2, Vector3, WireframeGeometry} from 'three';
import type {Answer} from '../api';
import {make, say} from '../dom';
import {Stage} from '../stage';
import {rampTexture} from '../terrain/shaders';
import {handleName, handles, pointsOf, type Handle, type PatchesState, type Style, type Vec3} from './state';

const VERTEX = `
in vec2 parameters;
in float value;
out vec3 up;
out vec3 eye;
out vec2 uv2;
out float v;
void main() {
  up = normalMatrix * normal;
  vec4 p = modelViewMatrix * vec4(position, 1.0);
  eye = -p.xyz;
  uv2 = parameters;
  v = value;
  gl_Position = projectionMatrix * p;
}`;

const FRAGMENT = `
precision highp float;
in vec3 up;
in vec3 eye;
in vec2 uv2;
in float v;
out vec4 colour;
uniform int style;
uniform sampler2D ramp;
uniform vec2 range;
uniform bool flatFaces;
float stripe(float x) {
  float w = fwidth(x) * 0.75;
  float f = abs(fract(x) - 0.5);
  return smoothstep(0.25 - w, 0.25 + w, f);
}
float line(float x) {
  float f = abs(fract(x - 0.5) - 0.5) / fwidth(x);
  return 1.0 - smoothstep(0.6, 1.5, f);
}
void main() {
  vec3 e = normalize(eye);
  vec3 n = flatFaces ? normalize(cross(dFdx(eye), dFdy(eye))) : normalize(up);
  if (dot(n, e) < 0.0) n = -n;
  vec3 base = vec3(0.79, 0.75, 0.66);
  if (style >= 4) base = texture(ramp, vec2(clamp((v - range.x) / (range.y - range.x), 0.0, 1.0) * 255.0 / 256.0 + 0.5 / 256.0, 0.5)).rgb;
  float light = 0.25 + 0.45 * max(dot(n, normalize(vec3(0.35, 0.55, 0.8))), 0.0) + 0.3 * max(dot(n, e), 0.0);
  if (style == 2) base = mix(vec3(0.1), vec3(0.97), stripe(5.0 * (reflect(-e, n).y + 1.0)));
  if (style == 3) base = mix(vec3(0.12, 0.3, 0.45), vec3(0.95), stripe(8.0 * dot(n, normalize(vec3(0.35, 0.55, 0.8)))));
  if (style == 2 || style == 3) light = 0.75 + 0.25 * light;
  if (style == 1) {
    base = mix(base, vec3(0.7, 0.12, 0.1), line(uv2.x * 12.0));
    base = mix(base, vec3(0.1, 0.35, 0.6), line(uv2.y * 12.0));
    base = mix(base, vec3(0.1, 0.45, 0.2), line((1.0 - uv2.x - uv2.y) * 12.0));
  }
  colour = vec4(base * light, 1.0);
}`;

const STYLES: Style[] = ['light', 'lines', 'zebra', 'isophotes', 'error', 'gaussian', 'mean'];

export interface PatchSceneEvents {
  drag(handle: Handle, to: Vec3): void;
  dropped(): void;
  focused(handle: Handle): void;
  hover(patch: number, uv: [number, number] | null): void;
  cameraMoved(camera: number[]): void;
}

export class PatchScene extends Stage {
  private readonly raycaster = new Raycaster();
  private readonly material = new ShaderMaterial({glslVersion: GLSL3, vertexShader: VERTEX, fragmentShader: FRAGMENT, side: DoubleSide, polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1,
    uniforms: {style: {value: 0}, ramp: {value: rampTexture('difference')}, range: {value: new Vector2(0, 1)}, flatFaces: {value: false}}});
  private readonly surface = new Mesh(new BufferGeometry(), this.material);
  private readonly wires = new LineSegments(new BufferGeometry(), new LineBasicMaterial({color: 0x1c2329, transparent: true, opacity: 0.4}));
  private readonly sides = [0x2a8ac4, 0xd5700a, 0x0a9e76].map((color) => new Line(new BufferGeometry(), new LineBasicMaterial({color, linewidth: 2})));
  private readonly polygons = new LineSegments(new BufferGeometry(), new LineBasicMaterial({color: 0x808890}));
  private readonly others = new LineSegments(new BufferGeometry(), new LineBasicMaterial({color: 0x5b666e}));
  private readonly dots = new Group();
  /** One button a point, where it lies in the picture: for the keyboard. The mouse goes through to the canvas. */
  private readonly buttons = make('div', {class: 'handles', role: 'group', 'aria-label': 'Control points. Arrow keys move in the plane of the screen, Page Up and Page Down away and nearer, X, Y and Z along the axes (with Shift backwards); Shift with an arrow is ten steps.'});
  private handles: Handle[] = [];
  private firstTriangles: number[] = [0];
  private size = 1;
  private step = 0;
  private readonly cursor = new Mesh(new SphereGeometry(1, 16, 12), new MeshBasicMaterial({color: 0xffb000}));
  private held: {handle: Handle; plane: Plane; first: PointerEvent} | null = null;
  private passing = false;

  constructor(element: HTMLElement, private events: PatchSceneEvents) {
    super(element, 'The surface. Drag a point to move it; drag elsewhere to turn, right drag moves, the wheel zooms.', true, (camera) => events.cameraMoved(camera));
    this.cursor.visible = false;
    for (const object of [this.surface, this.wires, this.polygons, this.others, ...this.sides]) object.frustumCulled = false;
    this.scene.add(this.surface, this.wires, this.polygons, this.others, this.dots, this.cursor, ...this.sides);
    element.append(this.buttons);
    this.canvas.addEventListener('pointerdown', (event) => this.down(event), {capture: true});
    this.canvas.addEventListener('pointermove', (event) => this.moved(event));
    this.canvas.addEventListener('pointerup', () => this.up());
    this.canvas.addEventListener('pointercancel', () => this.up());
    this.canvas.addEventListener('pointerleave', () => events.hover(-1, null));
    this.buttons.addEventListener('keydown', (event) => this.key(event));
    this.buttons.addEventListener('keyup', () => events.dropped());
  }

  frame(centre: Vec3, size: number): void {
    this.controls.target.set(...centre);
    this.camera.position.set(centre[0] + 0.75 * size, centre[1] - 1.05 * size, centre[2] + 0.75 * size);
    this.camera.near = size / 100;
    this.camera.far = size * 50;
    this.controls.minDistance = size / 20;
    this.controls.maxDistance = size * 12;
    this.controls.update();
    this.redraw();
  }

  takeSurface({words, arrays}: Answer): void {
    const geometry = new BufferGeometry();
    geometry.setAttribute('position', new BufferAttribute(arrays.position, 3));
    geometry.setAttribute('normal', new BufferAttribute(arrays.normal, 3));
    geometry.setAttribute('parameters', new BufferAttribute(arrays.parameters, 2));
    geometry.setAttribute('value', new BufferAttribute(arrays.value ?? new Float32Array(arrays.position.length / 3), 1));
    geometry.setIndex(new BufferAttribute(arrays.index, 1));
    this.surface.geometry.dispose();
    this.surface.geometry = geometry;
    this.material.uniforms.flatFaces.value = words.flat as boolean;
    this.firstTriangles = words.first_triangles as number[];
    this.wires.geometry.dispose();
    this.wires.geometry = this.wires.visible ? new WireframeGeometry(geometry) : new BufferGeometry();
    this.sidePoints = arrays.sides as Float32Array;
    this.redraw();
  }
  private sidePoints = new Float32Array();

  /** The sides of one patch in the colours of the parameter triangle, those of the others in grey. */
  private showSides(patch: number): void {
    const each = 65 * 3, rest: number[] = [];
    for (let k = 0; k * each < this.sidePoints.length; ++k) {
      const points = this.sidePoints.slice(k * each, (k + 1) * each);
      if (Math.floor(k / 3) === patch) this.put(this.sides[k % 3], points);
      else for (let i = 0; i + 3 < each; i += 3) rest.push(...points.subarray(i, i + 6));
    }
    this.put(this.others, new Float32Array(rest));
  }

  private put(object: {geometry: BufferGeometry}, points: Float32Array): void {
    object.geometry.dispose();
    object.geometry = new BufferGeometry();
    if (points.length > 0) object.geometry.setAttribute('position', new BufferAttribute(points, 3));
  }

  show(state: PatchesState, size: number, range: [number, number]): void {
    this.material.uniforms.style.value = STYLES.indexOf(state.style);
    this.material.uniforms.ramp.value = rampTexture(state.style === 'error' ? 'amount' : 'difference');
    (this.material.uniforms.range.value as Vector2).set(...range);
    const wires = state.mesh && !this.wires.visible;
    this.wires.visible = state.mesh;
    this.wires.material.color = this.theme('--ink', '#1c2329');
    if (wires && this.surface.geometry.getAttribute('position')) this.wires.geometry = new WireframeGeometry(this.surface.geometry);
    this.size = size;
    this.step = state.snap;
    this.showSides(state.patch);
    const held = state.polygons && state.file < 0;
    this.polygons.visible = this.dots.visible = held;
    this.buttons.hidden = !held;
    const lines: number[] = [], wanted = handles(state.document);
    for (const curve of new Set(wanted.map(({handle}) => handle[0]))) {
      const points = pointsOf(state.document.curves[curve]);
      for (let i = 0; i + 1 < points.length; ++i) lines.push(...points[i], ...points[i + 1]);
    }
    this.put(this.polygons, new Float32Array(lines));
    this.handles = wanted.map(({handle}) => handle);
    while (this.buttons.children.length > wanted.length) this.buttons.lastChild?.remove();
    while (this.buttons.children.length < wanted.length) {
      const k = this.buttons.children.length;
      this.buttons.append(make('button', {type: 'button', focus: () => this.events.focused(this.handles[k])}));
    }
    while (this.dots.children.length > wanted.length) this.dots.remove(this.dots.children[this.dots.children.length - 1]);
    while (this.dots.children.length < wanted.length) this.dots.add(new Mesh(new SphereGeometry(1, 16, 12), new MeshBasicMaterial({color: 0xffffff})));
    wanted.forEach(({handle, corner}, k) => {
      const dot = this.dots.children[k] as Mesh, [curve, index] = handle, at = pointsOf(state.document.curves[curve])[index];
      const chosen = state.point !== null && state.point[0] === curve && state.point[1] === index;
      (dot.material as MeshBasicMaterial).color = chosen ? new Color(0xffb000) : corner ? this.theme('--ink', '#1c2329') : new Color(0x78848d);
      dot.position.set(...at);
      dot.scale.setScalar(size * (corner ? 0.014 : 0.011));
      dot.userData = {handle};
      this.buttons.children[k].setAttribute('aria-label', `${handleName(state.document, handle)}: ${at.map((v) => say(v, 5)).join(', ')}`);
    });
    this.redraw();
  }

  setCursor(point: Vec3 | null, size: number): void {
    this.cursor.visible = point !== null;
    if (point) {
      this.cursor.position.set(...point);
      this.cursor.scale.setScalar(size * 0.013);
    }
    this.redraw();
  }

  /** Where a place is on the screen, for tests. */
  toScreen(at: Vec3): [number, number] {
    const box = this.canvas.getBoundingClientRect();
    this.camera.updateMatrixWorld();
    const p = new Vector3(...at).project(this.camera);
    return [box.left + ((p.x + 1) / 2) * box.width, box.top + ((1 - p.y) / 2) * box.height];
  }

  protected draw(): void {
    if (!this.render(Math.min(2, devicePixelRatio))) return;
    // Where the points lie in the picture: for whoever cannot see it, and for tests.
    const box = this.canvas.getBoundingClientRect(), places = (this.dots.children as Mesh[]).map((dot) => this.toScreen(dot.position.toArray() as Vec3));
    this.canvas.dataset.handles = JSON.stringify(places.map((place) => place.map(Math.round)));
    places.forEach(([x, y], k) => {
      const {style} = this.buttons.children[k] as HTMLElement;
      style.left = `${x - box.left}px`;
      style.top = `${y - box.top}px`;
    });
  }

  private aim(event: PointerEvent): void {
    const box = this.canvas.getBoundingClientRect();
    this.raycaster.setFromCamera(new Vector2(((event.clientX - box.left) / box.width) * 2 - 1, 1 - ((event.clientY - box.top) / box.height) * 2), this.camera);
  }

  private down(event: PointerEvent): void {
    if (event.button !== 0 || !this.dots.visible || this.passing) return;
    if (this.held) {
      // A second finger: it was a pinch, and not the point, that the first one was for. The camera learns of both.
      const {first} = this.held;
      this.up();
      this.passing = true;
      this.canvas.dispatchEvent(new PointerEvent('pointerdown', first));
      this.passing = false;
      return;
    }
    this.aim(event);
    // A finger or a mouse that is a little beside the point means it all the same: the nearest within some pixels.
    let best: Mesh | null = null, nearest = event.pointerType === 'touch' ? 24 : 14;
    for (const dot of this.dots.children as Mesh[]) {
      const [x, y] = this.toScreen(dot.position.toArray() as Vec3), d = Math.hypot(x - event.clientX, y - event.clientY);
      if (d < nearest) { nearest = d; best = dot; }
    }
    if (!best) return;
    event.stopImmediatePropagation();
    const {handle} = best.userData as {handle: Handle};
    this.canvas.setPointerCapture(event.pointerId);
    this.held = {handle, first: event, plane: new Plane().setFromNormalAndCoplanarPoint(this.camera.getWorldDirection(new Vector3()), best.position)};
    this.controls.enabled = false;
    this.events.drag(handle, best.position.toArray() as Vec3);
  }

  private moved(event: PointerEvent): void {
    this.aim(event);
    if (this.held) {
      const at = this.raycaster.ray.intersectPlane(this.held.plane, new Vector3());
      if (at) this.events.drag(this.held.handle, at.toArray().map((v) => Number(v.toPrecision(7))) as Vec3);
      return;
    }
    if (event.buttons !== 0 || !this.surface.geometry.getAttribute('position')) return;
    const hit = this.raycaster.intersectObject(this.surface, false)[0];
    if (!hit?.face) return this.events.hover(-1, null);
    const triangle = hit.faceIndex ?? 0, patch = this.firstTriangles.filter((first) => first <= triangle).length - 1;
    const parameters = this.surface.geometry.getAttribute('parameters'), positions = this.surface.geometry.getAttribute('position');
    const {a, b, c} = hit.face, [pa, pb, pc] = [a, b, c].map((i) => new Vector3().fromBufferAttribute(positions as BufferAttribute, i));
    const area = (p: Vector3, q: Vector3, r: Vector3) => q.clone().sub(p).cross(r.clone().sub(p)).length();
    const whole = area(pa, pb, pc) || 1, weights = [area(hit.point, pb, pc) / whole, area(pa, hit.point, pc) / whole, area(pa, pb, hit.point) / whole];
    const at = (get: (i: number) => number) => weights[0] * get(a) + weights[1] * get(b) + weights[2] * get(c);
    this.events.hover(patch, [at((i) => parameters.getX(i)), at((i) => parameters.getY(i))]);
  }

  private key(event: KeyboardEvent): void {
    const k = [...this.buttons.children].indexOf(event.target as Element), handle = this.handles[k];
    if (!handle || event.ctrlKey || event.metaKey || event.altKey) return;
    const right = new Vector3().setFromMatrixColumn(this.camera.matrixWorld, 0), up = new Vector3().setFromMatrixColumn(this.camera.matrixWorld, 1), away = this.camera.getWorldDirection(new Vector3());
    const back = event.shiftKey ? -1 : 1;
    const ways: Record<string, Vector3> = {ArrowRight: right, ArrowLeft: right.clone().negate(), ArrowUp: up, ArrowDown: up.clone().negate(), PageUp: away, PageDown: away.clone().negate(),
      x: new Vector3(back, 0, 0), y: new Vector3(0, back, 0), z: new Vector3(0, 0, back)};
    const way = ways[event.key.length === 1 ? event.key.toLowerCase() : event.key];
    if (!way) return;
    event.preventDefault();
    const far = event.key.startsWith('Arrow') && event.shiftKey ? 10 : 1;
    // With a snap, a step that is shorter along each axis than half of it would lead nowhere.
    const longest = Math.max(...way.toArray().map(Math.abs)), step = this.step > 0 ? this.step / longest : this.size / 200;
    const to = (this.dots.children[k] as Mesh).position.clone().addScaledVector(way, step * far);
    this.events.drag(handle, to.toArray().map((v) => Number(v.toPrecision(7))) as Vec3);
  }

  private up(): void {
    if (!this.held) return;
    this.held = null;
    this.controls.enabled = true;
    this.events.dropped();
  }
}
