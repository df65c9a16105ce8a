// The picture of a TetraQuad surface: tetrahedra whose fragments are rays (shader.ts), their edges, the chosen vertex.
import {BackSide, BufferAttribute, BufferGeometry, DataTexture, FloatType, GLSL3, LineBasicMaterial, LineSegments, Mesh, MeshBasicMaterial, NearestFilter, RGBAFormat, RGBAIntegerFormat, ShaderMaterial, SphereGeometry, UnsignedIntType, Vector3, WebGLRenderTarget} from 'three';
import type {Answer} from '../api';
import {isSoftware} from '../renderer';
import {Stage} from '../stage';
import {FRAGMENT, VERTEX} from './shader';
import type {TetraQuadsState} from './state';

const WIDTH = 1024;  // of the data textures

function padded<T extends Float32Array | Uint32Array>(values: T, kind: {new (n: number): T}, perTexel: number): {data: T; rows: number} {
  const rows = Math.max(1, Math.ceil(values.length / (perTexel * WIDTH)));
  const data = new kind(rows * WIDTH * perTexel);
  data.set(values as never);
  return {data, rows};
}

export class TetraQuadScene extends Stage {
  private readonly material = new ShaderMaterial({glslVersion: GLSL3, vertexShader: VERTEX, fragmentShader: FRAGMENT.replace('uniform mat4 projectionMatrix, modelViewMatrix;', 'uniform mat4 projectionMatrix;\nuniform mat4 modelViewMatrix;'), side: BackSide,
    uniforms: {corners: {value: null}, vertices: {value: null}, cornerWidth: {value: WIDTH}, vertexWidth: {value: WIDTH}, eye: {value: new Vector3()}, cutNormal: {value: new Vector3()}, cutOffset: {value: 1},
      onSurface: {value: false}, hitsOnly: {value: false}, dark: {value: false}}});
  private readonly tets = new Mesh(new BufferGeometry(), this.material);
  private readonly edges = new LineSegments(new BufferGeometry(), new LineBasicMaterial({color: 0x77828a, transparent: true, opacity: 0.55}));
  private readonly pin = new Mesh(new SphereGeometry(1, 16, 12), new MeshBasicMaterial({color: 0xffb000}));
  private readonly mark = new Mesh(new SphereGeometry(1, 16, 12), new MeshBasicMaterial({color: 0x1c2329}));
  private low = new Vector3();
  private high = new Vector3();
  private readonly ratio: number;

  constructor(element: HTMLElement, cameraMoved: (camera: number[]) => void, clicked: (event: MouseEvent) => void) {
    super(element, 'The surface. Drag turns, right drag moves, the wheel zooms.', false, cameraMoved);
    // A processor that plays a graphics card casts a quarter of the rays.
    this.ratio = isSoftware(this.renderer) ? 0.5 : Math.min(2, devicePixelRatio);
    for (const object of [this.tets, this.edges]) object.frustumCulled = false;
    this.pin.visible = this.mark.visible = false;
    this.scene.add(this.tets, this.edges, this.pin, this.mark);
    this.canvas.addEventListener('click', clicked);
  }

  take({arrays}: Answer): void {
    const vertices = arrays.vertices as Float32Array, quadrics = arrays.quadrics as Float32Array, tets = arrays.tets as Uint32Array, crossed = arrays.crossed as Uint32Array;
    const count = vertices.length / 3, parts = new Float32Array(count * 16);
    this.low.set(Infinity, Infinity, Infinity);
    this.high.set(-Infinity, -Infinity, -Infinity);
    for (let v = 0; v < count; ++v) {
      parts.set(vertices.subarray(3 * v, 3 * v + 3), 16 * v);
      parts.set(quadrics.subarray(10 * v, 10 * v + 10), 16 * v + 4);
      const p = new Vector3().fromArray(vertices, 3 * v);
      this.low.min(p);
      this.high.max(p);
    }
    const cornersOfCrossed = new Uint32Array(crossed.length * 4);
    crossed.forEach((t, k) => cornersOfCrossed.set(tets.subarray(4 * t, 4 * t + 4), 4 * k));
    this.replaceTexture('vertices', padded(parts, Float32Array, 4), true);
    this.replaceTexture('corners', padded(cornersOfCrossed, Uint32Array, 4), false);

    // Corners are right-handed: these triangles look outwards.
    const faces = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
    const position = new Float32Array(crossed.length * 36), which = new Float32Array(crossed.length * 12);
    crossed.forEach((t, k) => faces.flat().forEach((corner, i) => {
      const v = tets[4 * t + corner];
      position.set(vertices.subarray(3 * v, 3 * v + 3), 36 * k + 3 * i);
      which[12 * k + i] = k;
    }));
    this.tets.geometry.dispose();
    this.tets.geometry = new BufferGeometry();
    this.tets.geometry.setAttribute('position', new BufferAttribute(position, 3));
    this.tets.geometry.setAttribute('tet', new BufferAttribute(which, 1));

    const seen = new Set<number>(), lines: number[] = [];
    for (let t = 0; t < tets.length; t += 4) {
      for (let a = 0; a < 4; ++a) for (let b = a + 1; b < 4; ++b) {
        const [i, j] = [tets[t + a], tets[t + b]].sort((x, y) => x - y), key = i * count + j;
        if (seen.has(key)) continue;
        seen.add(key);
        lines.push(...vertices.subarray(3 * i, 3 * i + 3), ...vertices.subarray(3 * j, 3 * j + 3));
      }
    }
    this.edges.geometry.dispose();
    this.edges.geometry = new BufferGeometry();
    this.edges.geometry.setAttribute('position', new BufferAttribute(new Float32Array(lines), 3));
    this.redraw();
  }

  private replaceTexture(name: 'vertices' | 'corners', {data, rows}: {data: Float32Array | Uint32Array; rows: number}, floats: boolean): void {
    (this.material.uniforms[name].value as DataTexture | null)?.dispose();
    const texture = floats ? new DataTexture(data as Float32Array, WIDTH, rows, RGBAFormat, FloatType) : new DataTexture(data as Uint32Array, WIDTH, rows, RGBAIntegerFormat, UnsignedIntType);
    if (!floats) texture.internalFormat = 'RGBA32UI';
    texture.magFilter = texture.minFilter = NearestFilter;
    texture.needsUpdate = true;
    this.material.uniforms[name].value = texture;
  }

  get size(): number {
    return this.high.distanceTo(this.low) || 1;
  }
  frame(): void {
    const middle = this.low.clone().add(this.high).multiplyScalar(0.5), size = this.size;
    this.controls.target.copy(middle);
    this.camera.position.copy(middle).add(new Vector3(0.8, -1.2, 0.7).multiplyScalar(size * 0.9));
    this.camera.near = size / 200;
    this.camera.far = size * 20;
    this.controls.minDistance = size / 50;
    this.controls.maxDistance = size * 8;
    this.controls.update();
    this.redraw();
  }

  /** The cut: what is kept has normal . p <= offset. */
  cutOf(state: TetraQuadsState): {normal: number[]; offset: number} {
    if (state.cutAxis === 'none') return {normal: [0, 0, 0], offset: 1};
    const k = 'xyz'.indexOf(state.cutAxis), low = this.low.getComponent(k), high = this.high.getComponent(k);
    return {normal: [0, 1, 2].map((i) => (i === k ? 1 : 0)), offset: low + (high - low) * state.cut};
  }

  show(state: TetraQuadsState, vertexAt: number[] | null, point: number[] | null): void {
    this.edges.visible = state.edges;
    this.material.uniforms.onSurface.value = state.onSurface;
    const cut = this.cutOf(state);
    (this.material.uniforms.cutNormal.value as Vector3).fromArray(cut.normal);
    this.material.uniforms.cutOffset.value = cut.offset;
    this.pin.visible = vertexAt !== null;
    if (vertexAt) this.pin.position.fromArray(vertexAt);
    this.mark.visible = point !== null;
    if (point) this.mark.position.fromArray(point);
    this.mark.material.color = this.theme('--ink', '#1c2329');
    this.pin.scale.setScalar(this.size * 0.016);
    this.mark.scale.setScalar(this.size * 0.008);
    this.canvas.dataset.tool = state.ask ? 'ask' : 'look';
    this.redraw();
  }

  /** The ray under the mouse, in doubles. */
  ray(event: MouseEvent): {origin: number[]; direction: number[]} {
    const box = this.canvas.getBoundingClientRect();
    this.prepare();
    const far = new Vector3(((event.clientX - box.left) / box.width) * 2 - 1, 1 - ((event.clientY - box.top) / box.height) * 2, 0.5).unproject(this.camera);
    return {origin: this.camera.position.toArray(), direction: far.sub(this.camera.position).normalize().toArray()};
  }

  /** The shader's own hit on a ray: one pixel, drawn through a camera that looks along it. */
  shaderHit(ray: {origin: number[]; direction: number[]}): number[] | null {
    const eye = this.camera.clone();
    eye.position.fromArray(ray.origin);
    eye.lookAt(new Vector3().fromArray(ray.origin).add(new Vector3().fromArray(ray.direction)));
    eye.aspect = 1;
    eye.fov = 0.01;
    eye.updateProjectionMatrix();
    eye.updateMatrixWorld();
    const target = new WebGLRenderTarget(1, 1, {type: FloatType, format: RGBAFormat, minFilter: NearestFilter, magFilter: NearestFilter});
    const shown = [this.edges, this.pin, this.mark].map((object) => object.visible);
    [this.edges, this.pin, this.mark].forEach((object) => { object.visible = false; });
    this.material.uniforms.hitsOnly.value = true;
    (this.material.uniforms.eye.value as Vector3).copy(eye.position);
    this.renderer.setRenderTarget(target);
    this.renderer.setClearColor(0x000000, 0);
    this.renderer.render(this.scene, eye);
    const pixel = new Float32Array(4);
    this.renderer.readRenderTargetPixels(target, 0, 0, 1, 1, pixel);
    this.renderer.setRenderTarget(null);
    target.dispose();
    this.material.uniforms.hitsOnly.value = false;
    [this.edges, this.pin, this.mark].forEach((object, k) => { object.visible = shown[k]; });
    this.redraw();
    return pixel[3] > 0.5 ? [...pixel.subarray(0, 3)] : null;
  }

  protected draw(): void {
    if (!this.material.uniforms.vertices.value) return;
    (this.material.uniforms.eye.value as Vector3).copy(this.camera.position);
    this.render(this.ratio);
  }
}
