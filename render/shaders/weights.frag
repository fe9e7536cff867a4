// SPDX-License-Identifier: AGPL-3.0-or-later
// Computes the colour of the skin weights at the rest position of each pixel.
#include "weights.glsl"

uniform usampler2D u_place;
uniform float u_place_step;
uniform vec3 u_shift;  // offset of the positions at which single voxels are read, voxels of the drawn volume
layout(location = 0) out vec4 colour;
void main() {
  uvec4 place = texelFetch(u_place, ivec2(gl_FragCoord.xy), 0);
  vec3 p = vec3(place.xyz) * u_place_step;
#ifdef VOXELS
  p += u_shift;
#endif
  vec4 shown = weight_colour(weights_at(p));
  colour = place.w == 0u ? vec4(0.0) : shown;
}
