// SPDX-License-Identifier: AGPL-3.0-or-later
// Renders a grey image along the ray of each pixel (render/passes/image_pass.h). A position s along a ray is its depth
// from the eye along the viewing direction, mm.
#include "rays.glsl"
#include "grey.glsl"
#ifdef POSED
#include "posed.glsl"
#endif

in vec2 ndc;
uniform sampler2D u_transfer;  // colour, and opacity of a layer one millimetre thick
uniform vec2 u_values;  // x: level of the transfer function's first sample; y: 1 / (level of its last sample - x)
uniform float u_step;          // length of a ray's steps, mm
uniform float u_nearest;       // depth at which rays start, mm
uniform vec3 u_low, u_high;    // box in which the image can be visible, padded coordinates
uniform vec4 u_plane;          // points p with dot(xyz, p) <= w stay visible
uniform mat3 u_view_from_gradient;
layout(location = 0) out vec4 colour;

const vec3 kKey = vec3(-0.428, 0.556, 0.713);
const float kOpaque = 0.98;

vec3 place_of(vec3 padded) {
#ifdef POSED
  padded = rest_of(padded);
#endif
  return grey_place(padded);
}

float level_near(vec3 padded, float otherwise) {
  vec3 place = place_of(padded);
  return in_grey(place) ? grey_level(place) : otherwise;
}

// Returns the brightness of a surface at `padded`. It is lit from over the viewer's left shoulder and, more weakly,
// from the viewer.
float brightness(vec3 padded, float level) {
  const vec3 a = vec3(1, -1, -1), b = vec3(-1, -1, 1), c = vec3(-1, 1, -1), e = vec3(1);
  vec3 gradient = a * level_near(padded + a * 0.7, level) + b * level_near(padded + b * 0.7, level) +
                  c * level_near(padded + c * 0.7, level) + e * level_near(padded + e * 0.7, level);
  vec3 normal = u_view_from_gradient * gradient;
  float steep = length(normal);
  if (steep < 1e-6) return 0.8;
  normal /= -steep;
  return 0.22 + 0.58 * clamp(dot(normal, kKey), 0.0, 1.0) + 0.3 * abs(normal.z);
}

// Returns a pseudo-random offset of a pixel's ray, in steps, [0, 1). Neighbouring rays start at different depths, so
// that the steps appear as fine grain and not as rings.
float start_of(vec2 pixel) { return fract(52.9829189 * fract(dot(pixel, vec2(0.06711056, 0.00583715)))); }

void main() {
  vec3 base = u_base + ndc.x * u_base_x + ndc.y * u_base_y;
  vec3 toward = u_toward + ndc.x * u_toward_x + ndc.y * u_toward_y;
  vec3 safe = mix(toward, vec3(1e-9), lessThan(abs(toward), vec3(1e-9)));
  vec3 t0 = (u_low - base) / safe, t1 = (u_high - base) / safe;
  vec3 nearer = min(t0, t1), farther = max(t0, t1);
  float s = max(max(max(nearer.x, nearer.y), nearer.z), u_nearest);
  float s_end = min(min(farther.x, farther.y), farther.z);
  float rate = dot(u_plane.xyz, toward), room = u_plane.w - dot(u_plane.xyz, base);
  if (rate > 0.0) s_end = min(s_end, room / rate);
  if (rate < 0.0) s = max(s, room / rate);
  if (rate == 0.0 && room < 0.0) s_end = -1e30;

  vec3 rgb = vec3(0.0);
  float alpha = 0.0, largest = -1.0;
  s += start_of(gl_FragCoord.xy) * u_step;
#ifndef POSED
  // place_rate: change of the position in the image per mm along the ray. block: size of a block of 8^3 voxels. Both
  // are fractions of the image.
  vec3 place_rate = u_grey_linear * toward, block = 8.0 / u_grey_size;
  vec3 safe_rate = mix(place_rate, vec3(1e-12), lessThan(abs(place_rate), vec3(1e-12)));
#endif
  for (int i = 0; i < 4096 && s < s_end && alpha < kOpaque; ++i) {
    vec3 padded = base + toward * s;
    vec3 place = place_of(padded);
    if (!in_grey(place)) { s += 2.0 * u_step; continue; }
    float most = grey_range(place).g;
#ifdef MAXIMUM
    bool skips = most <= largest;
#else
    bool skips = most <= u_values.x;
#endif
    if (skips) {
#ifdef POSED
      s += 2.0 * u_step;
#else
      vec3 corner = (floor(place / block) + vec3(greaterThan(safe_rate, vec3(0.0)))) * block;
      vec3 leave = (corner - place) / safe_rate;
      // Advances by whole steps only, so that the picture does not depend on which blocks were skipped.
      s += max(1.0, ceil(min(min(leave.x, leave.y), leave.z) / u_step)) * u_step;
#endif
      continue;
    }
    float level = grey_level(place);
#ifdef MAXIMUM
    largest = max(largest, level);
#else
    vec4 look = textureLod(u_transfer, vec2((level - u_values.x) * u_values.y, 0.5), 0.0);
    if (level > u_values.x && look.a > 0.002) {
      float opacity = (1.0 - alpha) * (1.0 - pow(1.0 - min(look.a, 0.999), u_step));
      rgb += opacity * look.rgb * (opacity > 0.01 ? brightness(padded, level) : 0.8);
      alpha += opacity;
    }
#endif
    s += u_step;
  }
#ifdef MAXIMUM
  float grey = clamp((largest - u_values.x) * u_values.y, 0.0, 1.0);
  // Air is black in the image. It becomes transparent, so that the background is visible.
  float seen = smoothstep(0.0, 0.06, grey);
  colour = vec4(vec3(grey) * seen, seen);
#else
  if (alpha >= kOpaque) rgb /= alpha, alpha = 1.0;
  colour = vec4(min(rgb, vec3(alpha)), alpha);
#endif
}
