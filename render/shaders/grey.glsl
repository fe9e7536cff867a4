// SPDX-License-Identifier: AGPL-3.0-or-later
// Reads a grey image (render/textures/grey_texture.h) at positions in the padded coordinates of the label volume.
uniform sampler3D u_grey;  // the image's grey levels, [0, 1]
uniform sampler3D u_grey_ranges;  // least and largest level of each block of 8^3 voxels and the voxels beside it
uniform mat3 u_grey_linear;       // with u_grey_offset: from padded coordinates to fractions of the image
uniform vec3 u_grey_offset, u_grey_size;

vec3 grey_place(vec3 padded) { return u_grey_linear * padded + u_grey_offset; }
bool in_grey(vec3 place) { return all(greaterThanEqual(place, vec3(0.0))) && all(lessThan(place, vec3(1.0))); }
float grey_level(vec3 place) { return textureLod(u_grey, place, 0.0).r; }
vec2 grey_range(vec3 place) { return texelFetch(u_grey_ranges, ivec3(place * u_grey_size) >> 3, 0).rg; }
