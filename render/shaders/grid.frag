// SPDX-License-Identifier: AGPL-3.0-or-later
// Draws the lines of the ground grid, which fade with the distance.
in vec2 place;
// Coordinates of the grid's middle modulo 5 grid steps, because every fifth line is stronger; mm.
uniform vec2 u_offset;
uniform float u_reach, u_step, u_line;
layout(location = 0) out vec4 colour;
float line(vec2 at, float width) {
  vec2 slope = max(fwidth(at), vec2(1e-6));
  vec2 near = abs(fract(at - 0.5) - 0.5) / slope;
  vec2 strength = clamp(width * u_line - near + 0.5, 0.0, 1.0) * clamp(0.7 - slope * 2.0, 0.0, 1.0);
  return max(strength.x, strength.y);
}
void main() {
  vec2 at = (place + u_offset) / u_step;
  float fade = clamp(1.0 - length(place) / u_reach, 0.0, 1.0);
  float alpha = max(line(at, 0.6) * 0.16, line(at * 0.2, 0.7) * 0.20) * fade;
  colour = vec4(vec3(0.75, 0.79, 0.85) * alpha, alpha);
}
