// SPDX-License-Identifier: AGPL-3.0-or-later
// Draws a slice through the labels or the skin weights, over a grey image if one is shown. It uses the volume's own
// index, since it needs every block with tissue; the index that rays use contains only blocks with visible tissue.
#include "atlases.glsl"
#ifdef POSED
#include "posed.glsl"
#endif
#ifdef WEIGHTS
#include "weights.glsl"
#endif
#ifdef GREY
#include "grey.glsl"
#endif

in vec2 ndc;
uniform usampler3D u_index;
uniform usampler2D u_looks;
uniform vec3 u_middle, u_right, u_down;  // padded coordinates of the picture's centre, and the steps of one pixel
uniform vec3 u_high;
uniform vec2 u_size;
uniform bool u_outline;
uniform float u_line;       // width of borders and contour lines, pixels
uniform uint u_outlined;
layout(location = 0) out vec4 colour;

#ifdef GREY
uniform vec2 u_window;   // the level shown as black, and the grey that one level adds
uniform float u_over;    // opacity of tissues and weights over the image
#endif
#ifdef WEIGHTS
uniform float u_contours;
const float kContour = 0.55, kTissueBorder = 0.86;
#endif

vec3 place_of(vec2 pixel) {
  vec3 p = u_middle + pixel.x * u_right + pixel.y * u_down;
#ifdef POSED
  p = rest_of(p);
#endif
  return p;
}

uint label_at_place(vec3 p) {
  if (any(lessThan(p, vec3(0.0))) || any(greaterThanEqual(p, u_high))) return 0u;
  uvec4 entry = texelFetch(u_index, ivec3(p) / BLOCK, 0);
  if (entry.w == 0u) return 0u;
  return label_at(entry.w, ivec3(p) % BLOCK + ivec3(entry.xyz) * SLOT + APRON);
}

uvec4 look_of(uint label) { return texelFetch(u_looks, ivec2(label & 255u, label >> 8), 0); }

#ifdef WEIGHTS
// Returns the fraction of the pixel that contour lines cover, [0, 1].
float contour(vec4 texel, vec3 right, vec3 below) {
#ifdef RAMP
  float level = texel.r / max(texel.a, 1e-3);
  vec2 slope = abs(vec2(dFdx(level), dFdy(level)));
  float off = min(min(abs(level - 0.25), abs(level - 0.5)), abs(level - 0.75));
  // A steep change of the weight means a fold of the posed body or the border of the tissue. No line is drawn there.
  if (texel.a == 0.0 || any(greaterThanEqual(slope, vec2(0.3)))) return 0.0;
  return clamp(0.6 * u_line + 0.5 - off / max(length(slope), 1e-4), 0.0, 1.0);
#elif defined(VOXELS)
  vec4 to_right = weights_at(right), to_below = weights_at(below);
  return (to_right.a > 0.0 && to_right != texel) || (to_below.a > 0.0 && to_below != texel) ? 1.0 : 0.0;
#else
  return 0.0;
#endif
}
#endif

void main() {
  vec2 pixel = vec2(gl_FragCoord.x - u_size.x * 0.5, u_size.y * 0.5 - gl_FragCoord.y);
  vec3 p = place_of(pixel), p_right = place_of(pixel + vec2(u_line, 0)), p_below = place_of(pixel + vec2(0, u_line));
  uint label = label_at_place(p);
  uvec4 look = look_of(label);
  bool seen = (look.a & 7u) != 0u;
  float alpha = seen ? 1.0 : 0.0;
  uint right = label_at_place(p_right), below = label_at_place(p_below);
  bool border = right != label || below != label;
  if (u_outline) {
    // If the pixel's own label is hidden, the border is drawn in the colour of the visible neighbour.
    if (!seen && border) look = look_of((look_of(right).a & 7u) != 0u ? right : below);
    alpha = border && (look.a & 7u) != 0u ? 1.0 : seen ? 0.10 : 0.0;
  }
  vec3 rgb = vec3(look.rgb) / 255.0;
#ifdef WEIGHTS
  vec4 texel = weights_at(p);
  float line = u_contours * contour(texel, p_right, p_below);
  if (seen && !(u_outline && border)) {
    vec4 weight = weight_colour(texel);
    if (weight.a > 0.0) {
      rgb = weight.rgb * (border ? kTissueBorder : 1.0) * mix(1.0, kContour, line);
      alpha = 1.0;
    }
  }
#endif
  bool marked = u_outlined != 0u && border && (label == u_outlined || right == u_outlined || below == u_outlined);
  if (marked) {
    rgb = vec3(1.0, 0.624, 0.18);
    alpha = 1.0;
  }
#ifdef GREY
  // Tissue areas are transparent over the image; border and contour lines are not.
  if (!(u_outline && border) && !marked) alpha *= u_over;
  vec3 place = grey_place(p);
#ifdef POSED
  // Excludes air: the map of a posed body reaches a little into the air around the body.
  bool shown = label != 0u && in_grey(place);
#else
  bool shown = in_grey(place);
#endif
  float below_all = shown ? 1.0 - alpha : 0.0;
  float grey = clamp((grey_level(place) - u_window.x) * u_window.y, 0.0, 1.0);
  colour = vec4(rgb * alpha + grey * below_all, alpha + below_all);
#else
  colour = vec4(rgb * alpha, alpha);
#endif
}
