// SPDX-License-Identifier: AGPL-3.0-or-later
// Computes the light that reaches the surface point that each pixel shows: the fraction of the rays to the key light
// that leave the body, and the fraction of the rays into the sky that do. Neighbouring texels follow different rays.
// shade.frag averages squares of 4 x 4 texels, which together contain all ray directions.
#include "rays.glsl"
#include "trace.glsl"

uniform sampler2D u_depth, u_normal;
uniform int u_every;     // light is computed for every n-th pixel along each axis
uniform ivec2 u_offset;  // the first pixel for which light is computed
uniform mat3 u_padded_from_view;  // converts directions; a unit normal becomes one brick (4 voxels) long
uniform int u_picture;            // number of pictures that were averaged before this one
layout(location = 0) out vec2 light;

// Number of rays of one texel in one picture. Rays through the map of a posed body take several times as long, so
// there are fewer.
#ifdef POSED
const int kSkyRays = 2, kKeyRays = 1;
#else
const int kSkyRays = 4, kKeyRays = 2;
#endif
const vec3 kKey = vec3(-0.428, 0.556, 0.713);
const float kKeyRadius = 0.16;  // angular radius of the key light's disc as seen from the body, radians (9 degrees)
const float kFold = 0.7;        // light in the crease of a fold, where two parts of a posed body touch, [0, 1]
// Distance from the surface at which rays start, voxels. At this distance the steps between voxels are not visible.
const float kOff = 0.5;

// Returns element i of the sequence R2, any run of which covers the unit square evenly: M. Roberts, "The unreasonable
// effectiveness of quasirandom sequences" (2018).
vec2 spread(int i) { return fract(0.5 + float(i) * vec2(0.7548776662, 0.5698402910)); }

// Returns 1 if a ray leaves the body, 0 if it hits the body.
//   from  start of the ray, padded coordinates
//   view  direction of the ray, view axes
float leaves(vec3 from, vec3 view) {
  vec3 d = u_padded_from_view * view;
  d /= max(max(abs(d.x), abs(d.y)), abs(d.z));
  vec3 inverse_d = 1.0 / mix(d, vec3(1e-9), lessThan(abs(d), vec3(1e-9)));
  vec3 t0 = (u_low - from) * inverse_d, t1 = (u_high - from) * inverse_d;
  vec3 nearer = min(t0, t1), farther = max(t0, t1);
  float s_start = max(max(max(nearer.x, nearer.y), nearer.z), 0.0), s_end = min(min(farther.x, farther.y), farther.z);
  // Tissue that the clip plane hides casts no shadow and does not cover the sky, so the ray ends at the plane.
  float rate = dot(u_plane.xyz, d), room = u_plane.w - dot(u_plane.xyz, from);
  if (rate > 0.0) s_end = min(s_end, room / rate);
  if (s_end <= s_start) return 1.0;
#ifdef POSED
  Piece piece;
  Meeting met = trace(from, d, s_start, s_end, piece);
#else
  Meeting met = trace(from, d, s_start, s_end);
#endif
  return met.s > -1e29 && met.s <= s_end ? 0.0 : 1.0;
}

void main() {
  ivec2 texel = ivec2(gl_FragCoord.xy), size = textureSize(u_depth, 0), at = min(texel * u_every + u_offset, size - 1);
  vec2 ndc = (vec2(at) + 0.5) / vec2(size) * 2.0 - 1.0;
  vec4 stored = texelFetch(u_normal, at, 0);
  light = vec2(stored.a > 0.5 && stored.a < 0.7 ? kFold : 1.0);
  // No visible tissue lies in front of a cut face, so nothing can shade it.
  if (stored.a == 0.0 || stored.a > 0.5) return;
  float depth = texelFetch(u_depth, at, 0).r;
  vec3 p = u_base + ndc.x * u_base_x + ndc.y * u_base_y + depth * (u_toward + ndc.x * u_toward_x + ndc.y * u_toward_y);
  vec3 normal = normalize(stored.xyz * 2.0 - 1.0);
  vec3 out_of = u_padded_from_view * normal;
  p += out_of * (kOff / max(max(abs(out_of.x), abs(out_of.y)), abs(out_of.z)));
  vec3 across = normalize(abs(normal.z) < 0.7 ? cross(normal, vec3(0, 0, 1)) : cross(normal, vec3(1, 0, 0)));
  vec3 along = cross(normal, across);
  vec3 key_across = normalize(cross(kKey, vec3(0, 0, 1))), key_along = cross(kKey, key_across);

  // Number of the texel in its square of 4 x 4 texels. The bits of x and y are interleaved, so that neighbouring
  // texels follow very different rays.
  ivec2 cell = texel & 3;
  int place = ((cell.x ^ cell.y) & 1) << 3 | (cell.y & 1) << 2 | ((cell.x ^ cell.y) & 2) | (cell.y >> 1);
  float sky = 0.0, key = 0.0;
  for (int i = 0; i < kSkyRays; ++i) {
    vec2 u = spread((u_picture * kSkyRays + i) * 16 + place);
    float turn = 6.2831853 * u.y, radius = sqrt(u.x);  // density proportional to the cosine, so all rays count the same
    sky += leaves(p, radius * (cos(turn) * across + sin(turn) * along) + sqrt(1.0 - u.x) * normal);
  }
  for (int i = 0; i < kKeyRays; ++i) {
    vec2 u = spread((u_picture * kKeyRays + i) * 16 + place);
    float turn = 6.2831853 * u.y, radius = sqrt(u.x) * kKeyRadius;
    vec3 toward = normalize(kKey) + radius * (cos(turn) * key_across + sin(turn) * key_along);
    // On a surface that faces away from the key light, shade.frag darkens the key light itself, so no ray is followed.
    key += dot(toward, normal) > 0.0 ? leaves(p, toward) : 1.0;
  }
  light = vec2(key / float(kKeyRays), sky / float(kSkyRays));
}
