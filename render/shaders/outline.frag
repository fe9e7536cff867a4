// SPDX-License-Identifier: AGPL-3.0-or-later
// Draws an outline around the pixels that show one label.
in vec2 ndc;
uniform usampler2D u_label;
uniform uint u_outlined;
uniform vec2 u_scale;       // buffer pixels per picture pixel
// Distance between neighbouring samples around a pixel, picture pixels; the outline's width is proportional to it.
uniform float u_line;
layout(location = 0) out vec4 colour;
bool shows(vec2 pixel) {
  return texelFetch(u_label, clamp(ivec2(pixel * u_scale), ivec2(0), textureSize(u_label, 0) - 1), 0).r == u_outlined;
}
void main() {
  vec2 at = gl_FragCoord.xy;
  float share = 0.0;
  for (int y = -2; y <= 2; ++y)
    for (int x = -2; x <= 2; ++x) share += shows(at + vec2(x, y) * u_line) ? 1.0 : 0.0;
  // The outline is strongest where half of the neighbourhood shows the tissue.
  float edge = clamp(1.6 - abs(share - 12.5) / 12.5 * 1.8, 0.0, 1.0);
  if (share == 0.0 || share == 25.0) edge = 0.0;
  colour = vec4(vec3(1.0, 0.624, 0.18) * edge, edge);
}
