// SPDX-License-Identifier: AGPL-3.0-or-later
// Draws a line with antialiased edges. If `u_off` is positive, the line is drawn only where it lies on the body's
// surface, within u_off mm in depth.
in float depth, across;
uniform sampler2D u_depth;
uniform vec2 u_size;
uniform float u_reach, u_off;
uniform vec4 u_colour;
layout(location = 0) out vec4 colour;
void main() {
  if (u_off > 0.0 && abs(depth - textureLod(u_depth, gl_FragCoord.xy / u_size, 0.0).r) > u_off) discard;
  float alpha = u_colour.a * clamp(u_reach + 0.5 - abs(across), 0.0, 1.0);
  colour = vec4(u_colour.rgb * alpha, alpha);
}
