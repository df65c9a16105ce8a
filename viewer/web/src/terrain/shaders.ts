// How a surface is coloured: light on the true normals, a ramp by height, slope or error, and what is seen from a point.
import {DataTexture, DoubleSide, FloatType, GLSL3, NearestFilter, LinearFilter, RedFormat, RGBAFormat, ShaderMaterial, UnsignedByteType, Vector2, Vector3, Vector4} from 'three';
import {rampBytes, type RampName} from '../ramps';

const VERTEX = `
out vec3 at;
out vec3 up;
out vec3 world;
void main() {
  at = position;
  up = normal;
  vec4 w = modelMatrix * vec4(position, 1.0);
  world = w.xyz;
  gl_Position = projectionMatrix * viewMatrix * w;
}`;

// The light is on the picture's own shape: with a vertical exaggeration the normals are those of the stretched surface.
const FRAGMENT = `
precision highp float;
in vec3 at;
in vec3 up;
in vec3 world;
out vec4 colour;
uniform sampler2D ramp, values, seen;
uniform vec4 valuesBox, seenBox;
uniform vec2 range;
uniform vec3 sun;
uniform float stretch;
uniform int mode;
uniform bool flatFaces, hasValues, hasSeen;
void main() {
  vec3 n = normalize(vec3(up.xy * stretch, up.z));
  vec3 slopeNormal = normalize(up);
  if (flatFaces) {
    n = normalize(cross(dFdx(world), dFdy(world)));
    if (n.z < 0.0) n = -n;
    slopeNormal = normalize(vec3(n.xy / stretch, n.z));
  }
  float v = at.z;
  bool known = true;
  if (mode == 1) {
    vec2 uv = vec2((at.x - valuesBox.x) / valuesBox.z, (valuesBox.y - at.y) / valuesBox.w);
    v = hasValues ? texture(values, uv).r : 0.0;
    known = hasValues && !isnan(v);
  }
  if (mode == 2) v = degrees(acos(clamp(slopeNormal.z, 0.0, 1.0)));
  vec3 base = known ? texture(ramp, vec2(clamp((v - range.x) / (range.y - range.x), 0.0, 1.0) * 255.0 / 256.0 + 0.5 / 256.0, 0.5)).rgb : vec3(0.6);
  if (hasSeen) {
    vec2 uv = vec2((at.x - seenBox.x) / seenBox.z, (seenBox.y - at.y) / seenBox.w);
    base = texture(seen, uv).r > 0.5 ? mix(base, vec3(1.0, 0.78, 0.25), 0.62) : mix(base, vec3(0.16, 0.2, 0.32), 0.62);
  }
  float light = 0.32 + 0.68 * max(dot(n, sun), 0.0) / max(sun.z, 0.2) * 0.78;
  colour = vec4(base * min(light, 1.12), 1.0);
}`;

export const MODES = {heights: 0, error: 1, slope: 2, plain: 3} as const;
const RAMP_OF: Record<keyof typeof MODES, RampName> = {heights: 'heights', error: 'difference', slope: 'amount', plain: 'plain'};
export const rampOf = (colour: keyof typeof MODES): RampName => RAMP_OF[colour];

const ramps = new Map<RampName, DataTexture>();
export function rampTexture(name: RampName): DataTexture {
  let texture = ramps.get(name);
  if (!texture) {
    texture = new DataTexture(rampBytes(name), 256, 1, RGBAFormat, UnsignedByteType);
    texture.magFilter = texture.minFilter = LinearFilter;
    texture.needsUpdate = true;
    ramps.set(name, texture);
  }
  return texture;
}

/** A grid of numbers over [west, north, width, height] of the page's coordinates; NaN: no data. */
export function numberTexture(values: Float32Array, columns: number, rows: number): DataTexture {
  const texture = new DataTexture(values, columns, rows, RedFormat, FloatType);
  texture.magFilter = texture.minFilter = NearestFilter;
  texture.needsUpdate = true;
  return texture;
}

export function byteTexture(values: Uint8Array, columns: number, rows: number): DataTexture {
  const texture = new DataTexture(values, columns, rows, RedFormat, UnsignedByteType);
  texture.magFilter = texture.minFilter = NearestFilter;
  texture.unpackAlignment = 1;
  texture.needsUpdate = true;
  return texture;
}

export function surfaceMaterial(): ShaderMaterial {
  const none = numberTexture(new Float32Array([0]), 1, 1);
  return new ShaderMaterial({
    glslVersion: GLSL3,
    vertexShader: VERTEX,
    fragmentShader: FRAGMENT,
    side: DoubleSide,
    polygonOffset: true,
    polygonOffsetFactor: 1,
    polygonOffsetUnits: 1,
    uniforms: {
      ramp: {value: rampTexture('heights')}, values: {value: none}, seen: {value: none},
      valuesBox: {value: new Vector4()}, seenBox: {value: new Vector4()},
      range: {value: new Vector2(0, 1)}, sun: {value: new Vector3(0, 0, 1)}, stretch: {value: 1},
      mode: {value: 0}, flatFaces: {value: false}, hasValues: {value: false}, hasSeen: {value: false},
    },
  });
}

export function setColours(material: ShaderMaterial, colour: keyof typeof MODES, low: number, high: number): void {
  material.uniforms.mode.value = MODES[colour];
  material.uniforms.ramp.value = rampTexture(RAMP_OF[colour]);
  (material.uniforms.range.value as Vector2).set(low, high > low ? high : low + 1);
}

export function setLight(material: ShaderMaterial, azimuthDegrees: number, stretch: number): void {
  const azimuth = (azimuthDegrees * Math.PI) / 180, altitude = Math.PI / 4;
  (material.uniforms.sun.value as Vector3).set(Math.sin(azimuth) * Math.cos(altitude), Math.cos(azimuth) * Math.cos(altitude), Math.sin(altitude));
  material.uniforms.stretch.value = stretch;
}
