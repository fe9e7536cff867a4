// SPDX-License-Identifier: AGPL-3.0-or-later
// Finds the rest position of a posed one in the map of a posed body (core/deform/preview_map.h).
uniform sampler3D u_map;           // fractions of rest points at nodes
uniform sampler3D u_apart;         // of nodes, to what is beyond the border of their sheet
uniform usampler3D u_cubes;        // between node n and n + 1
uniform vec3 u_node_offset;
uniform float u_node_scale;        // nodes a padded voxel
uniform vec3 u_rest_offset, u_rest_scale;  // padded rest point of a fraction
uniform vec3 u_map_texel;
uniform ivec3 u_map_size;
uniform float u_steepest;          // padded voxels at rest that half a node of one sheet can be

const vec3 kNowhere = vec3(-1e6);
const uint kBordered = 64u, kBroken = 128u;
const float kFarApart = 127.0 / 63.0;  // steps

vec3 node_of(vec3 posed) { return posed * u_node_scale + u_node_offset; }

uint cube_in(usampler3D cubes, vec3 node) {
  ivec3 cube = ivec3(floor(node));
  if (any(lessThan(cube, ivec3(0))) || any(greaterThanEqual(cube, u_map_size - 1))) return 0u;
  return texelFetch(cubes, cube, 0).r;
}

// Beside a fold a place reads its nearest node, and what lies as far on that node's other side, mirrored through it.
// Without branches, since a software driver follows both.
struct Sheet { bool mirrored; vec3 node, rest; };
Sheet sheet_at(vec3 node, uint cube) {
  vec3 nearest = floor(node + 0.5);
  vec4 middle = texelFetch(u_map, ivec3(nearest), 0);
  return Sheet(cube >= kBroken, nearest, middle.a > 0.5 ? middle.rgb : kNowhere);
}
vec3 rest_on(Sheet sheet, vec3 node) {
  vec4 texel = textureLod(u_map, ((sheet.mirrored ? 2.0 * sheet.node - node : node) + 0.5) * u_map_texel, 0.0);
  if (texel.a < 0.5 || (sheet.mirrored && sheet.rest.x < 0.0)) return kNowhere;
  texel.rgb /= texel.a;  // nodes that are not covered do not count
  vec3 slope = (sheet.rest - texel.rgb) * u_rest_scale;
  bool one_sheet = all(lessThan(abs(slope), vec3(u_steepest)));
  vec3 rest = (sheet.mirrored ? sheet.rest : texel.rgb) * u_rest_scale + u_rest_offset;
  return sheet.mirrored && one_sheet ? rest + slope : rest;
}

// Below zero beyond the border. On a mirrored sheet it is at least as far as the way from its node leaves it.
float apart_on(Sheet sheet, vec3 node) {
  if (sheet.mirrored) {
    float apart = texelFetch(u_apart, ivec3(sheet.node), 0).r * kFarApart;
    return apart > 0.999 ? apart : apart - length(rest_on(sheet, node) - rest_on(sheet, sheet.node)) * u_node_scale;
  }
  return textureLod(u_apart, (node + 0.5) * u_map_texel, 0.0).r;
}

// The rest position of a posed one, both in padded coordinates; kNowhere outside the map.
vec3 rest_of(vec3 posed) {
  vec3 node = node_of(posed);
  uint cube = cube_in(u_cubes, node);
  if (cube == 0u) return kNowhere;
  Sheet sheet = sheet_at(node, cube);
  if (cube >= kBordered && apart_on(sheet, node) < 0.0) return kNowhere;
  return rest_on(sheet, node);
}
