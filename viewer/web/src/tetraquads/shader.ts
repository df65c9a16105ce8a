// The ray caster: a fragment of a tetrahedron's back face is a ray through it, along which the function is one cubic
// polynomial. Its first root is the hit, from the quadrics themselves; depth and normal are the surface's own.

export const VERTEX = `
in float tet;
flat out int which;
out vec3 at;
void main() {
  which = int(tet + 0.5);
  at = position;
  gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
}`;

export const FRAGMENT = `
precision highp float;
precision highp int;
precision highp sampler2D;
precision highp usampler2D;
flat in int which;
in vec3 at;
out vec4 colour;
uniform usampler2D corners;   // four vertices a tetrahedron
uniform sampler2D vertices;   // four texels a vertex: place and the ten factors
uniform int cornerWidth, vertexWidth;
uniform vec3 eye, cutNormal;
uniform float cutOffset;
uniform bool onSurface, hitsOnly, dark;
uniform mat4 projectionMatrix, modelViewMatrix;

vec4 part(int vertex, int k) {
  int n = 4 * vertex + k;
  return texelFetch(vertices, ivec2(n % vertexWidth, n / vertexWidth), 0);
}

vec3 place[4];
vec3 gradB[4];
float b0[4];
vec4 f0[4];
vec4 f1[4];
vec4 f2[4];

float quadric(int i, vec3 p, out vec3 gradient) {
  vec3 d = p - place[i];
  // 1 u v w | uu vv ww uv | uw vw
  gradient = vec3(f0[i].y + 2.0 * f1[i].x * d.x + f1[i].w * d.y + f2[i].x * d.z,
                  f0[i].z + 2.0 * f1[i].y * d.y + f1[i].w * d.x + f2[i].y * d.z,
                  f0[i].w + 2.0 * f1[i].z * d.z + f2[i].x * d.x + f2[i].y * d.y);
  return f0[i].x + dot(f0[i].yzw, d) + dot(f1[i].xyz, d * d) + f1[i].w * d.x * d.y + f2[i].x * d.x * d.z + f2[i].y * d.y * d.z;
}

void field(vec3 p, vec3 base, out vec3 gradient) {
  gradient = vec3(0.0);
  for (int i = 0; i < 4; ++i) {
    vec3 g;
    float q = quadric(i, p, g);
    float b = b0[i] + dot(gradB[i], p - base);
    gradient += gradB[i] * q + b * g;
  }
}

void main() {
  uvec4 c = texelFetch(corners, ivec2(which % cornerWidth, which / cornerWidth), 0);
  for (int i = 0; i < 4; ++i) {
    int v = int(c[i]);
    place[i] = part(v, 0).xyz;
    f0[i] = part(v, 1);
    f1[i] = part(v, 2);
    f2[i] = part(v, 3);
  }
  vec3 base = place[0];
  vec3 e1 = place[1] - base, e2 = place[2] - base, e3 = place[3] - base;
  float volume = dot(e1, cross(e2, e3));
  gradB[1] = cross(e2, e3) / volume;
  gradB[2] = cross(e3, e1) / volume;
  gradB[3] = cross(e1, e2) / volume;
  gradB[0] = -(gradB[1] + gradB[2] + gradB[3]);
  b0[0] = 1.0; b0[1] = 0.0; b0[2] = 0.0; b0[3] = 0.0;

  // The ray from the fragment backwards to the eye: distances stay small, and floats keep their digits.
  vec3 d = normalize(at - eye);
  float reach = distance(at, eye);
  float from = -reach, to = 1e9;
  // Pixels are snapped to a fraction of themselves before they are drawn: a ray that runs along a face could miss the
  // tetrahedra on both sides. Each looks a little beyond its faces; there the neighbour's cubic differs by less still.
  const float beyond = 4e-4;
  for (int i = 0; i < 4; ++i) {
    float b = b0[i] + dot(gradB[i], at - base) + beyond, slope = dot(gradB[i], d);
    if (slope > 1e-12) from = max(from, -b / slope);
    else if (slope < -1e-12) to = min(to, -b / slope);
  }
  float side = cutOffset - dot(cutNormal, at), lean = dot(cutNormal, d);
  if (lean > 1e-9) to = min(to, side / lean);
  else if (lean < -1e-9) from = max(from, side / lean);
  else if (side < 0.0) discard;
  if (!(from < to)) discard;

  // Along the ray each b_i is linear and each quadric a parabola in s in [0, 1]: their products are the cubic's powers.
  vec3 p0 = at + from * d, way = (to - from) * d;
  float a0 = 0.0, a1 = 0.0, a2 = 0.0, a3 = 0.0;
  for (int i = 0; i < 4; ++i) {
    vec3 slope;
    float c0 = quadric(i, p0, slope), c1 = dot(slope, way);
    float c2 = dot(f1[i].xyz, way * way) + f1[i].w * way.x * way.y + f2[i].x * way.x * way.z + f2[i].y * way.y * way.z;
    float e0 = b0[i] + dot(gradB[i], p0 - base), e1 = dot(gradB[i], way);
    a0 += e0 * c0;
    a1 += e0 * c1 + e1 * c0;
    a2 += e0 * c2 + e1 * c1;
    a3 += e1 * c2;
  }
  // Bernstein's bound: with all four ordinates of one sign there is no root.
  vec4 ordinates = vec4(a0, a0 + a1 / 3.0, a0 + (2.0 * a1 + a2) / 3.0, a0 + a1 + a2 + a3);
  if (all(lessThan(ordinates, vec4(0.0))) || all(greaterThanEqual(ordinates, vec4(0.0)))) discard;
  // It is monotone between the roots of its derivative: the first interval with a change of sign has the first root.
  float r1 = 1.0, r2 = 1.0, A = 3.0 * a3, B = 2.0 * a2, C = a1;
  float disc = B * B - 4.0 * A * C;
  if (disc > 0.0) {
    float w = -0.5 * (B + (B >= 0.0 ? sqrt(disc) : -sqrt(disc)));
    float x = abs(A) > 1e-20 ? w / A : 2.0, y = abs(w) > 1e-20 ? C / w : 2.0;
    r1 = min(x, y);
    r2 = max(x, y);
    r1 = r1 > 0.0 && r1 < 1.0 ? r1 : (r2 > 0.0 && r2 < 1.0 ? r2 : 1.0);
    r2 = r2 > r1 && r2 < 1.0 ? r2 : 1.0;
  }
  float lo = 0.0, hi = -1.0, flo = a0;
  for (int k = 0; k < 3; ++k) {
    float end = k == 0 ? r1 : k == 1 ? r2 : 1.0;
    float fend = ((a3 * end + a2) * end + a1) * end + a0;
    if ((flo < 0.0) != (fend < 0.0)) { hi = end; break; }
    lo = end;
    flo = fend;
    if (end >= 1.0) break;
  }
  if (hi < 0.0) discard;
  bool rising = flo < 0.0;
  float s = 0.5 * (lo + hi);
  for (int k = 0; k < 24; ++k) {
    float f = ((a3 * s + a2) * s + a1) * s + a0, slope = (3.0 * a3 * s + 2.0 * a2) * s + a1;
    if ((f < 0.0) == rising) lo = s; else hi = s;
    float next = s - f / slope;
    s = next > lo && next < hi ? next : 0.5 * (lo + hi);
  }
  vec3 hit = p0 + s * way, g;
  field(hit, base, g);
  vec4 clip = projectionMatrix * modelViewMatrix * vec4(hit, 1.0);
  gl_FragDepth = 0.5 * clip.z / clip.w + 0.5;
  if (hitsOnly) { colour = vec4(hit, 1.0); return; }
  vec3 n = normalize(g);
  bool outside = dot(n, d) < 0.0;
  if (!outside) n = -n;
  vec3 tint = outside ? vec3(0.87, 0.72, 0.47) : vec3(0.35, 0.55, 0.72);
  float light = 0.3 + 0.7 * max(dot(n, normalize(-d + vec3(0.25, -0.15, 0.6))), 0.0);
  if (onSurface) {
    float nearest = 1.0;
    for (int i = 0; i < 4; ++i) nearest = min(nearest, abs(b0[i] + dot(gradB[i], hit - base)) / length(gradB[i]));
    float width = fwidth(dot(hit, vec3(1.0))) * 1.2 + 1e-5;
    tint = mix(vec3(0.08), tint, smoothstep(0.0, max(0.008, width), nearest));
  }
  colour = vec4(tint * light, 1.0);
}`;
