// SPDX-License-Identifier: AGPL-3.0-or-later
// Writes the depth range of the hull. Blending keeps the greatest value of each channel: the negated depth of the
// nearest front face, and the depth of the farthest back face.
in float depth;
uniform bool u_front_is_clockwise;
layout(location = 0) out vec2 range;
void main() { range = gl_FrontFacing != u_front_is_clockwise ? vec2(-depth, -1e30) : vec2(-1e30, depth); }
