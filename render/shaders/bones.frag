// SPDX-License-Identifier: AGPL-3.0-or-later
// Draws bones with antialiased edges, fainter behind the body.
in float depth;
in vec3 local;
in vec4 tint;
uniform sampler2D u_depth;
uniform vec2 u_size;
uniform bool u_hidden_by_body;
layout(location = 0) out vec4 colour;
void main() {
  float alpha = tint.a * clamp(local.z + 0.5 - length(local.xy), 0.0, 1.0);
  if (u_hidden_by_body && depth > textureLod(u_depth, gl_FragCoord.xy / u_size, 0.0).r) alpha *= 0.45;
  colour = vec4(tint.rgb * alpha, alpha);
}
