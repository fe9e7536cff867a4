// SPDX-License-Identifier: AGPL-3.0-or-later
// Shades the hits of the rays in the colours of tissues or of skin weights, or as an X-ray ghost.
#include "rays.glsl"
#if defined(POSED) && !defined(LIT)
#include "posed.glsl"
#endif

in vec2 ndc;
uniform sampler2D u_depth, u_normal;
uniform usampler2D u_label, u_looks;
#ifdef LIT
uniform sampler2D u_light;  // light computed by light.frag: fractions of the key light (r) and of the sky (g)
uniform int u_every;        // light.frag computed the light of every n-th pixel along each axis
uniform ivec2 u_offset;     // the first pixel for which light was computed
uniform vec2 u_pixel;       // a pixel is x + y * depth wide, mm
#else
uniform sampler3D u_occupancy;
uniform vec3 u_occupancy_texel;
uniform mat3 u_padded_from_view;   // converts directions; a unit normal becomes one brick (4 voxels) long
#endif
uniform uint u_layer;
uniform int u_line;  // width of contour lines, and of the outlines of tissues on cut faces, pixels
layout(location = 0) out vec4 colour;

const vec3 kKey = vec3(-0.428, 0.556, 0.713);
const float kFold = 0.7;  // openness() in the crease of a fold, where two parts of a posed body touch

// Returns the light on a surface that nothing occludes, without gloss and rim light.
vec3 open_light(vec3 normal) {
  float toward = clamp(normal.z, 0.0, 1.0);
  float key = clamp(dot(normal, kKey) * 0.86 + 0.14, 0.0, 1.0);
  float sky = 0.5 + 0.5 * normal.y;
  return (0.92 * key * vec3(1.0, 0.975, 0.945) + mix(0.06, 0.18, sky) * vec3(0.95, 0.97, 1.03)) *
         (0.72 + 0.28 * toward);
}

float gloss_of(vec3 normal) {
  float gloss = clamp(dot(normal, normalize(kKey + vec3(0, 0, 1))), 0.0, 1.0);
  gloss *= gloss; gloss *= gloss; gloss *= gloss; gloss *= gloss;
  return 0.04 * gloss;
}

float rim_of(vec3 normal) {
  float away = 1.0 - clamp(normal.z, 0.0, 1.0);
  return 0.06 * away * away * (0.5 + 0.5 * normal.y);
}

#ifdef LIT
// Averages the light over 4 x 4 texels around a pixel, which together contain all ray directions. Only texels of the
// same surface are averaged: those near the tangent plane at the pixel, with a similar normal.
vec2 light_at(ivec2 at, vec4 stored, vec3 normal) {
  float depth = texelFetch(u_depth, at, 0).r, pixel = (u_pixel.x + u_pixel.y * depth) * float(u_every);
  ivec2 last = textureSize(u_depth, 0) - 1, last_texel = textureSize(u_light, 0) - 1;
  ivec2 first = (at - u_offset + u_every) / u_every - 3;
  vec2 sum = vec2(0.0), sum_of_all = vec2(0.0);
  float count = 0.0, count_of_all = 0.0;
  for (int y = 0; y < 4; ++y)
    for (int x = 0; x < 4; ++x) {
      ivec2 texel = clamp(first + ivec2(x, y), ivec2(0), last_texel), beside = min(texel * u_every + u_offset, last);
      vec4 other = texelFetch(u_normal, beside, 0);
      if (abs(other.a - stored.a) > 0.1) continue;
      vec2 light = texelFetch(u_light, texel, 0).rg;
      sum_of_all += light;
      count_of_all += 1.0;
      vec3 step = vec3(vec2(beside - at) * (pixel / float(u_every)), depth - texelFetch(u_depth, beside, 0).r);
      if (dot(normal, other.xyz * 2.0 - 1.0) < 0.8 || abs(dot(step, normal)) > 2.0 * pixel) continue;
      sum += light;
      count += 1.0;
    }
  return count > 0.0 ? sum / count : count_of_all > 0.0 ? sum_of_all / count_of_all : vec2(1.0);
}

// Returns true if an outline of a tissue runs through this pixel of a cut face.
bool outlined(ivec2 at, uint label) {
  ivec2 last = textureSize(u_depth, 0) - 1;
  for (int i = 0; i < 2; ++i) {
    ivec2 beside = min(at + ivec2(1 - i, i) * u_line, last);
    if (texelFetch(u_normal, beside, 0).a > 0.7 && texelFetch(u_label, beside, 0).r != label) return true;
  }
  return false;
}
const float kCutLine = 0.45;  // factor on the brightness where outlines of tissues are drawn on cut faces

// Share of the key light in the light of an unoccluded surface; the rest comes from the sky. With this value, a still
// picture of a body has the same mean brightness as a picture of the moving body.
const float kKeyShare = 0.5;

vec3 lit(vec3 albedo, vec3 normal, vec2 light) {
  // Approximates the light that surrounding surfaces reflect onto a position. [Jimenez, Wu, Pesce, Jarabo, "Practical
  // real-time strategies for accurate indirect occlusion", SIGGRAPH courses 2016]
  vec3 a = 2.0404 * albedo - 0.3324, b = -4.7951 * albedo + 0.6417, c = 2.7552 * albedo + 0.6903;
  vec3 sky = max(vec3(light.y), ((light.y * a + b) * light.y + c) * light.y);
  // Surfaces that face away from the key light are already dark in open_light(), so shadows fade out there.
  float key = mix(1.0, light.x, smoothstep(0.0, 0.3, dot(normal, kKey)));
  return albedo * (open_light(normal) * (kKeyShare * key + (1.0 - kKeyShare) * sky) + rim_of(normal) * light.y) +
         gloss_of(normal) * key;
}
#else
// Returns how open a position is: 1 on a flat or convex surface, less in a crease.
float openness(float depth, vec3 normal) {
  vec3 p = u_base + ndc.x * u_base_x + ndc.y * u_base_y + depth * (u_toward + ndc.x * u_toward_x + ndc.y * u_toward_y);
  vec3 out_of = u_padded_from_view * normal;
#ifdef POSED
  // Converts position and direction to rest. The direction is taken from the rest positions of a short step.
  vec3 rest = rest_of(p);
  vec3 turned = (rest - rest_of(p - 0.35 * out_of)) / 0.35;
  if (length(turned) > 4.0 * length(out_of)) return kFold;  // the step crossed a fold
  out_of = turned * min(1.0, 1.5 * length(out_of) / max(length(turned), 1e-3));
  p = rest;
#endif
  float near = textureLod(u_occupancy, (p + out_of * 1.25) * u_occupancy_texel, 0.0).r;
  float far = textureLod(u_occupancy, (p + out_of * 3.0) * u_occupancy_texel, 0.0).r;
  return 1.0 - clamp(1.5 * (near - 0.14) + 0.8 * far, 0.0, 0.75);
}

vec3 lit(vec3 albedo, vec3 normal, float open) {
  // Shadows get a warmer colour, like light that has passed through flesh.
  vec3 shade = mix(vec3(0.55, 0.42, 0.38), vec3(1.0), open);
  return albedo * (open_light(normal) * shade * open + rim_of(normal)) + gloss_of(normal) * open;
}
#endif

#ifdef WEIGHTS
uniform sampler2D u_weight;
uniform usampler2D u_place;
// Lines to draw; 0: no lines; 1: lines between ranges of the weight; 2: lines between different colours.
uniform int u_lines;
// Two pixels that are the width of a line apart lie on one surface if their rest positions differ by less than
// u_joined.x + u_joined.y * their distance, in steps of u_place.
uniform vec2 u_joined;
const float kLine = 0.55;

// Returns true if a line runs between pixels with these weight colours.
bool differs(vec4 weight, vec4 other) {
  return other.a != 0.0 && (u_lines == 1 ? other.a != weight.a : other.rgb != weight.rgb);
}

// Returns true if two pixels lie on one surface.
bool joined(ivec2 at, ivec2 beside) {
  vec3 apart = vec3(texelFetch(u_place, at, 0).xyz) - vec3(texelFetch(u_place, beside, 0).xyz);
  float most = u_joined.x + u_joined.y * float(u_line) * length(u_base_x + texelFetch(u_depth, at, 0).r * u_toward_x);
  return dot(apart, apart) < most * most;
}

vec3 colour_of(ivec2 at, vec3 tissue) {
  vec4 weight = texelFetch(u_weight, at, 0);
  ivec2 last = textureSize(u_weight, 0) - 1;
  ivec2 right = min(at + ivec2(u_line, 0), last), above = min(at + ivec2(0, u_line), last);
  bool to_right = differs(weight, texelFetch(u_weight, right, 0)),
       to_above = differs(weight, texelFetch(u_weight, above, 0));
  bool line = u_lines != 0 && ((to_right && joined(at, right)) || (to_above && joined(at, above)));
  return weight.a == 0.0 ? tissue : weight.rgb * (line ? kLine : 1.0);
}
#endif

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  vec4 normal = texelFetch(u_normal, at, 0);
  uint label = texelFetch(u_label, at, 0).r;
  uvec4 look = texelFetch(u_looks, ivec2(label & 255u, label >> 8), 0);
  vec3 srgb = vec3(look.rgb) / 255.0;
#ifdef WEIGHTS
  srgb = colour_of(at, srgb);
#endif
  bool cap = normal.a > 0.7;
  float alpha = normal.a == 0.0 || (look.a & 7u) > u_layer + 1u ? 0.0 : 1.0;
#ifdef GHOST
  float steep = clamp(1.0 - abs(normal.z * 2.0 - 1.0), 0.0, 1.0);
  // In X-ray, a cut face through flesh stays transparent.
  alpha *= cap ? 0.30 : 0.10 + 0.62 * steep * steep * steep;
  vec3 rgb = cap ? srgb : vec3(0.624, 0.722, 0.839);
#else
  alpha *= float(look.a >> 3) / 255.0;
  vec3 n = normalize(normal.xyz * 2.0 - 1.0);
#ifdef LIT
  vec2 light = light_at(at, normal, n);
#else
  float light = normal.a > 0.5 ? kFold : openness(texelFetch(u_depth, at, 0).r, n);
#endif
#if defined(LIT) && !defined(WEIGHTS)
  if (cap && outlined(at, label)) srgb *= kCutLine;
#endif
  vec3 rgb = cap ? srgb : sqrt(clamp(lit(srgb * srgb, n, light), 0.0, 1.0));
#endif
  colour = vec4(rgb * alpha, alpha);
}
