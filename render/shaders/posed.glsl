// SPDX-License-Identifier: AGPL-3.0-or-later
// Converts posed positions to rest positions by the inverse map of a posed body (core/deform/preview_map.h). Where two
// parts of the body touch, the map has two sheets (smooth pieces) with a fold between them.
uniform sampler3D u_map;           // rest positions at the nodes, as fractions of the map's extent
// Distance at rest from a node to the tissue beyond the border of the node's sheet, as a fraction of kFarApart;
// negative: the node lies beyond the border.
uniform sampler3D u_apart;
uniform usampler3D u_cubes;  // state of the cube between nodes n and n + 1 (PreviewMap::cubes)
uniform vec3 u_node_offset;
uniform float u_node_scale;        // nodes of the map per voxel of the drawn volume
uniform vec3 u_rest_offset, u_rest_scale;  // convert a fraction of the map's extent to a padded rest position
uniform vec3 u_map_texel;
uniform ivec3 u_map_size;
// Largest change of the rest position over half a step between nodes within one sheet, voxels of the drawn volume.
uniform float u_steepest;

const vec3 kNowhere = vec3(-1e6);
const uint kBordered = 64u, kBroken = 128u;
const float kFarApart = 127.0 / 63.0;  // largest distance that u_apart can store, in steps between nodes

vec3 node_of(vec3 posed) { return posed * u_node_scale + u_node_offset; }

uint cube_in(usampler3D cubes, vec3 node) {
  ivec3 cube = ivec3(floor(node));
  if (any(lessThan(cube, ivec3(0))) || any(greaterThanEqual(cube, u_map_size - 1))) return 0u;
  return texelFetch(cubes, cube, 0).r;
}

// The rest position of a posed position, on one sheet of the map. Beside a fold it is extrapolated: the position is
// mirrored through the nearest node, and the difference between the rest positions of the node and of the mirrored
// position is added to the node's rest position. Both cases share this code, because a software driver executes both
// branches.
struct Sheet { bool mirrored; vec3 node, rest; };
Sheet sheet_at(vec3 node, uint cube) {
  vec3 nearest = floor(node + 0.5);
  vec4 middle = texelFetch(u_map, ivec3(nearest), 0);
  return Sheet(cube >= kBroken, nearest, middle.a > 0.5 ? middle.rgb : kNowhere);
}
vec3 rest_on(Sheet sheet, vec3 node) {
  vec4 texel = textureLod(u_map, ((sheet.mirrored ? 2.0 * sheet.node - node : node) + 0.5) * u_map_texel, 0.0);
  if (texel.a < 0.5 || (sheet.mirrored && sheet.rest.x < 0.0)) return kNowhere;
  texel.rgb /= texel.a;  // nodes without a rest position do not count
  vec3 slope = (sheet.rest - texel.rgb) * u_rest_scale;
  bool one_sheet = all(lessThan(abs(slope), vec3(u_steepest)));
  vec3 rest = (sheet.mirrored ? sheet.rest : texel.rgb) * u_rest_scale + u_rest_offset;
  return sheet.mirrored && one_sheet ? rest + slope : rest;
}

// Returns a measure of the distance to the border of the sheet, negative beyond the border. For a mirrored sheet the
// measure is a lower bound: the node's distance to the border, minus the distance from the node.
float apart_on(Sheet sheet, vec3 node) {
  if (sheet.mirrored) {
    float apart = texelFetch(u_apart, ivec3(sheet.node), 0).r * kFarApart;
    return apart > 0.999 ? apart : apart - length(rest_on(sheet, node) - rest_on(sheet, sheet.node)) * u_node_scale;
  }
  return textureLod(u_apart, (node + 0.5) * u_map_texel, 0.0).r;
}

// Converts a posed position to its rest position, both in padded coordinates. Returns kNowhere outside the map.
vec3 rest_of(vec3 posed) {
  vec3 node = node_of(posed);
  uint cube = cube_in(u_cubes, node);
  if (cube == 0u) return kNowhere;
  Sheet sheet = sheet_at(node, cube);
  if (cube >= kBordered && apart_on(sheet, node) < 0.0) return kNowhere;
  return rest_on(sheet, node);
}
