// One of the surfaces side by side: its geometry, its colours, what is drawn on it.
import {BufferAttribute, BufferGeometry, Color, Group, LineBasicMaterial, LineSegments, Mesh, MeshBasicMaterial, SphereGeometry, type ShaderMaterial, Vector4} from 'three';
import {Line2} from 'three/examples/jsm/lines/Line2.js';
import {LineGeometry} from 'three/examples/jsm/lines/LineGeometry.js';
import {LineMaterial} from 'three/examples/jsm/lines/LineMaterial.js';
import type {Answer} from '../api';
import {legend} from '../ramps';
import {make, say, table} from '../dom';
import {byteTexture, numberTexture, rampOf, setColours, setLight, surfaceMaterial} from './shaders';
import {FITS, SURFACES, type FileInfo, type PanelState, type TerrainState} from './state';

export type Vec3 = [x: number, y: number, z: number];

/** What is drawn of a surface: how many triangles, and the error as a share of the distance from the eye. */
export interface Detail {
  triangles: number;
  angle: number;
  finest: number;
  cut: number;
}

export interface Report {
  model: string;
  surface: string;
  vertices: number;
  triangles: number;
  coefficients: number;
  tiles?: number;  // of a tiled model that is not joined
  rmse?: number;
  max_error?: number;
  slope_rmse?: number;
  violations?: number;
  valid_cells?: number;
  seconds: number;
  detail: Detail;
  range: [number, number];
}

/** Lines lie on the surface, which is drawn as triangles about it: they are drawn a little nearer than they are. */
function liftedLines(): LineBasicMaterial {
  const material = new LineBasicMaterial({vertexColors: false, transparent: true});
  material.onBeforeCompile = (shader) => {
    shader.vertexShader = shader.vertexShader.replace('#include <project_vertex>', '#include <project_vertex>\ngl_Position.z -= 0.0012 * gl_Position.w;');
  };
  return material;
}

/** The profile's line, some pixels wide: it must be seen on every colour, and where the triangles lie over it a little. */
function wideLine(): LineMaterial {
  const material = new LineMaterial({color: 0xffffff, linewidth: 3});
  material.vertexShader = material.vertexShader.replace('gl_Position = clip;', 'clip.z -= 0.004 * clip.w;\n gl_Position = clip;');
  return material;
}

export class Panel {
  readonly group = new Group();
  readonly overlay = make('div', {class: 'overlay'});
  private open = !matchMedia('(max-width: 800px)').matches;  // on a phone the words would hide the terrain
  readonly material: ShaderMaterial = surfaceMaterial();
  readonly surface = new Mesh(new BufferGeometry(), this.material);
  report: Report | null = null;
  detail: Detail | null = null;
  errorRange = 0;
  contourWords = '';
  contours: [minor: Float32Array, major: Float32Array] | null = null;
  private readonly edges = new LineSegments(new BufferGeometry(), liftedLines());
  private readonly minor = new LineSegments(new BufferGeometry(), liftedLines());
  private readonly major = new LineSegments(new BufferGeometry(), liftedLines());
  private readonly path = new Line2(new LineGeometry(), wideLine());
  private readonly pins = new Group();

  constructor() {
    (this.edges.material as LineBasicMaterial).color = new Color(0x101820);
    (this.edges.material as LineBasicMaterial).opacity = 0.45;
    (this.minor.material as LineBasicMaterial).color = new Color(0x3a2414);
    (this.minor.material as LineBasicMaterial).opacity = 0.75;
    (this.major.material as LineBasicMaterial).color = new Color(0x120a04);
    this.path.visible = false;
    for (const object of [this.surface, this.edges, this.minor, this.major, this.path]) object.frustumCulled = false;
    this.group.add(this.surface, this.edges, this.minor, this.major, this.path, this.pins);
  }

  takeSurface({words, arrays}: Answer): void {
    this.report = words as unknown as Report;
    this.detail = this.report.detail;
    this.takeTriangles(arrays);
    this.replace(this.edges, lineGeometry(arrays.edges as Float32Array));
    this.material.uniforms.flatFaces.value = this.report.surface === 'linear';
    this.dropErrors();
    this.dropContours();
  }

  /** The same surface as triangles for another eye. */
  takeDetail({words, arrays}: Answer): void {
    this.detail = words as unknown as Detail;
    this.takeTriangles(arrays);
  }

  private takeTriangles(arrays: Answer['arrays']): void {
    const geometry = new BufferGeometry();
    geometry.setAttribute('position', new BufferAttribute(arrays.position, 3));
    geometry.setAttribute('normal', new BufferAttribute(arrays.normal, 3));
    geometry.setIndex(new BufferAttribute(arrays.index, 1));
    this.replace(this.surface, geometry);
  }

  takeErrors({words, arrays}: Answer): void {
    const values = arrays.error as Float32Array;
    this.errorRange = 0;
    for (const v of values) if (Math.abs(v) > this.errorRange) this.errorRange = Math.abs(v);
    this.material.uniforms.values.value = numberTexture(values, words.columns as number, words.rows as number);
    (this.material.uniforms.valuesBox.value as Vector4).fromArray(words.box as number[]);
    this.material.uniforms.hasValues.value = true;
  }

  takeContours({words, arrays}: Answer): void {
    const segments = arrays.segments as Float32Array, major = arrays.major as Uint8Array;
    const parts: [number[], number[]] = [[], []];
    for (let i = 0; i < major.length; ++i) parts[major[i] > 0 ? 1 : 0].push(segments[3 * i], segments[3 * i + 1], segments[3 * i + 2]);
    this.contours = parts.map((part) => new Float32Array(part)) as [Float32Array, Float32Array];
    this.replace(this.minor, lineGeometry(this.contours[0]));
    this.replace(this.major, lineGeometry(this.contours[1]));
    this.contourWords = `${say(words.lines)} lines on ${say(words.levels)} levels`;
  }

  takeSeen(answer: Answer | null): void {
    this.material.uniforms.hasSeen.value = answer !== null;
    if (!answer) return;
    const {words, arrays} = answer;
    this.material.uniforms.seen.value = byteTexture(arrays.seen as Uint8Array, words.columns as number, words.rows as number);
    (this.material.uniforms.seenBox.value as Vector4).fromArray(words.box as number[]);
  }

  dropErrors(): void {
    this.material.uniforms.hasValues.value = false;
    this.errorRange = 0;
  }
  dropContours(): void {
    this.replace(this.minor, new BufferGeometry());
    this.replace(this.major, new BufferGeometry());
    this.contourWords = '';
    this.contours = null;
  }

  show(state: TerrainState, info: FileInfo, errorRange: number): void {
    this.edges.visible = state.triangles;
    this.minor.visible = this.major.visible = state.contours;
    this.group.scale.z = state.exaggeration;
    setLight(this.material, state.light, state.exaggeration);
    const [low, high] = this.rangeOf(state, info, errorRange);
    setColours(this.material, state.colour, low, high);
  }

  private rangeOf(state: TerrainState, info: FileInfo, errorRange: number): [number, number] {
    if (state.colour === 'error') return [-errorRange, errorRange];
    if (state.colour === 'slope') return [0, 60];
    return [info.low, info.high];
  }

  /** Words and legend over the picture. */
  describe(state: TerrainState, panel: PanelState, info: FileInfo, errorRange: number): void {
    const surface = SURFACES.find(([name]) => name === (this.report?.surface ?? panel.surface))?.[1] ?? '';
    const fit = info.kind === 'model' ? 'as in the file' : FITS.find(([name]) => name === panel.fit)?.[1] ?? '';
    const rows: [string, string][] = [];
    if (this.report) {
      const r = this.report;
      rows.push(['vertices', say(r.vertices)], ['coefficients', say(r.coefficients)]);
      if (r.rmse !== undefined) rows.push(['RMSE', `${say(r.rmse, 4)} ${info.unit}`], ['largest error', `${say(r.max_error, 4)} ${info.unit}`], ['slope RMSE', say(r.slope_rmse, 3)]);
      if (state.contours && this.contourWords) rows.push(['contours', this.contourWords]);
    }
    const details: HTMLDetailsElement = make('details', {open: this.open, toggle: () => { this.open = details.open; }}, make('summary', {}, make('h2', {}, surface)), make('p', {}, fit), table(rows));
    const children: Node[] = [details];
    const [low, high] = this.rangeOf(state, info, errorRange);
    if (state.colour === 'heights') children.push(legend(rampOf('heights'), 'height', info.unit, low, high));
    if (state.colour === 'error' && info.kind === 'grid' && errorRange > 0) children.push(legend(rampOf('error'), 'above (red), below (blue) the grid', info.unit, low, high));
    if (state.colour === 'slope') children.push(legend(rampOf('slope'), 'slope', 'degrees', low, high));
    if (this.detail) this.overlay.dataset.detail = JSON.stringify(this.detail);
    this.overlay.replaceChildren(...children);
  }

  /** Pins and the profile's line, at the heights that the program gave for this panel's surface. */
  mark(pins: {at: Vec3; colour: number}[], path: Float32Array, size: number, stretch: number): void {
    this.pins.clear();
    for (const {at, colour} of pins) {
      const pin = new Mesh(new SphereGeometry(size, 16, 12), new MeshBasicMaterial({color: colour}));
      pin.position.set(...at);
      pin.scale.z = 1 / stretch;  // the group is stretched, the pin stays round
      this.pins.add(pin);
    }
    this.path.visible = path.length >= 6;
    this.path.geometry.dispose();
    this.path.geometry = new LineGeometry();
    if (this.path.visible) this.path.geometry.setPositions(path);
  }

  /** The picture's size in pixels of the page, for what is measured in them. */
  size(width: number, height: number): void {
    this.path.material.resolution.set(width, height);
  }

  dispose(): void {
    for (const object of [this.surface, this.edges, this.minor, this.major, this.path]) object.geometry.dispose();
    this.material.dispose();
    this.overlay.remove();
  }

  private replace(object: {geometry: BufferGeometry}, geometry: BufferGeometry): void {
    object.geometry.dispose();
    object.geometry = geometry;
  }
}

function lineGeometry(points: Float32Array): BufferGeometry {
  const geometry = new BufferGeometry();
  if (points.length > 0) geometry.setAttribute('position', new BufferAttribute(points, 3));
  return geometry;
}
