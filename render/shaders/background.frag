// SPDX-License-Identifier: AGPL-3.0-or-later
// Draws a gradient from top to bottom. Ordered noise of half a colour step (1/255) hides its steps.
in vec2 ndc;
uniform vec3 u_top, u_bottom;
layout(location = 0) out vec4 colour;
void main() {
  ivec2 cell = ivec2(gl_FragCoord.xy) & 3;
  int order = ((cell.x ^ cell.y) & 1) * 8 + (cell.x & 1) * 4 + ((cell.x >> 1 ^ cell.y >> 1) & 1) * 2 + (cell.x >> 1);
  colour = vec4(mix(u_bottom, u_top, ndc.y * 0.5 + 0.5) + (float(order) - 7.5) / (16.0 * 255.0), 1.0);
}
