// SPDX-License-Identifier: AGPL-3.0-or-later
// Follows the ray of each pixel to the surface of the visible tissue. A position s along a ray counts voxels along the
// axis on which the ray moves fastest, so that no step of 1 skips a layer of voxels.
#include "rays.glsl"
#include "atlases.glsl"
#ifdef POSED
#include "posed.glsl"
#endif

in vec2 ndc;
uniform sampler2D u_range;
uniform float u_nearest;         // depth at which rays start if the eye is inside the hull; else -1e30
uniform usampler3D u_index;
uniform usampler2D u_looks;
uniform uint u_layer;
uniform vec3 u_low, u_high;  // box of the hull, intersected with the clip box
uniform vec4 u_plane;            // points p with dot(xyz, p) <= w stay visible
uniform bool u_clipped;
uniform mat3 u_view_from_gradient;

layout(location = 0) out float out_depth;
layout(location = 1) out vec4 out_normal;
layout(location = 2) out uint out_label;
layout(location = 3) out uvec4 out_place;

#ifdef POSED
uniform usampler3D u_near_cubes;  // states of the map's cubes; 0 for those far from the layer's labels
uniform ivec3 u_blocks;
const float kStretch = 3.0;  // length of the pieces of a ray that are tested for straightness, steps between nodes
// Scales u_tap to half a node, so that directions change smoothly from cube to cube.
const float kNodeTap = 0.5 / 1.4;
#endif

uniform float u_tap;  // distance of gradient samples along each axis, voxels; negative: mirrored tetrahedron
uniform vec3 u_label_shift;
uniform float u_places;            // steps of out_place per padded voxel

const float kSurface = float(SURFACE) / 255.0;
const float kBand = 72.0 / 255.0;  // field value from which a ray reads filtered values, since the surface may be near
const float kFirstFieldValue = 7.5 / 255.0;

struct Slot { ivec3 offset; uint atlas; };
Slot slot_of(ivec3 block) {
#ifdef POSED
  // A piece of a ray, converted to rest positions, may leave the blocks.
  ivec3 inside = clamp(block, ivec3(0), u_blocks - 1);
  uvec4 entry = texelFetch(u_index, inside, 0);
  if (inside != block) entry.w = 0u;
#else
  uvec4 entry = texelFetch(u_index, block, 0);
#endif
  return Slot(ivec3(entry.xyz) * SLOT + APRON - block * BLOCK, entry.w);
}

// Returns the slot of the block that contains p. It may differ from the block in which the march found p.
Slot slot_at(vec3 p) { return slot_of(ivec3(p) >> BLOCK_SHIFT); }

// Where a ray hits the surface (s = -1e30: nowhere), the field's value there, and the last position before it with its
// value.
struct Meeting { float s, value, s_before, value_before; };

// Marches from s to s_end along the straight line base + d s in rest positions, on which a voxel has the length 1 /
// rate. Moves s on, and stores a hit in `found`, never before s_start.
void march(vec3 base, vec3 d, float rate, float s_start, float s_end, inout float s, inout Meeting found) {
  float voxel = 1.0 / rate;
  vec3 safe = mix(d, vec3(1e-9), lessThan(abs(d), vec3(1e-9)));
  vec3 inverse_d = 1.0 / safe;
  vec3 block_exit = vec3(greaterThan(safe, vec3(0.0))) * float(BLOCK);
  vec3 ahead = sign(safe) * 0.02;  // moves on to the next block even where the ray runs along a face
  for (int tries = 0; tries < 1024 && s < s_end && found.s < -1e29; ++tries) {
    // Moves on, block by block, until the surface may be near.
    Slot slot = Slot(ivec3(0), 0u);
    vec3 at;  // the line's base in texels of the slot
    float value = 0.0;
    for (int blocks = 0; blocks < 1024 && s < s_end; ++blocks) {
      vec3 p = base + d * s;
      ivec3 block = ivec3(p + ahead) >> BLOCK_SHIFT;
      slot = slot_of(block);
      at = base + vec3(slot.offset);
      vec3 leave = (vec3(block * BLOCK) + block_exit - base) * inverse_d;
      float s_leave = min(min(min(leave.x, leave.y), leave.z) + 1e-3 * voxel, s_end);
      if (slot.atlas != 0u) do {
        value = field_texel(slot.atlas, ivec3(at + d * s));
        if (value >= kBand) break;
        s += (value < kFirstFieldValue ? max(1.0, value * (255.0 * BRICK) - float(BRICK - 1)) : 1.0) * voxel;
      } while (s < s_leave);
      if (value >= kBand) break;
      s = max(s, s_leave);
    }
    if (value < kBand) break;
    // Starts half a voxel earlier, so that a surface is not hit from its inside. The field rises by about 3/8 per
    // voxel, from which the next step is estimated. The step is short enough not to skip a thread, and the apron of the
    // slot is wide enough for all reads.
    float s_near = max(s - 0.5 * voxel, s_start), s_far = min(s + 1.5 * voxel, s_end);
    found.value_before = 0.0;
    found.s_before = s_near - 0.5 * voxel;
    while (s_near < s_far) {
      found.value = field_at(slot.atlas, at + d * s_near);
      if (found.value >= kSurface) { found.s = s_near; break; }
      found.value_before = found.value;
      found.s_before = s_near;
      s_near += clamp((kSurface - found.value) * 3.0, 0.4, 0.7) * voxel;
    }
    s += 1.5 * voxel;
  }
}

void main() {
  vec3 base = u_base + ndc.x * u_base_x + ndc.y * u_base_y;
  vec3 toward = u_toward + ndc.x * u_toward_x + ndc.y * u_toward_y;
  vec3 speed = abs(toward);
  float voxels_per_depth = max(max(speed.x, speed.y), speed.z);
  vec3 d = toward / voxels_per_depth;
  vec3 safe = mix(d, vec3(1e-9), lessThan(abs(d), vec3(1e-9)));
  vec3 inverse_d = 1.0 / safe;

  vec2 range = texelFetch(u_range, ivec2(gl_FragCoord.xy), 0).rg;
  float s = (u_nearest > -1e29 ? u_nearest : -range.r) * voxels_per_depth;
  vec3 t0 = (u_low - base) * inverse_d, t1 = (u_high - base) * inverse_d;
  vec3 nearer = min(t0, t1), farther = max(t0, t1);
  float box_start = max(max(nearer.x, nearer.y), nearer.z);
  float s_end = min(min(min(farther.x, farther.y), farther.z), range.g * voxels_per_depth);
  bool cut = false;
  if (u_clipped) {
    float rate = dot(u_plane.xyz, d), room = u_plane.w - dot(u_plane.xyz, base);
    if (rate > 0.0) s_end = min(s_end, room / rate);
    float start = rate < 0.0 ? max(box_start, room / rate) : box_start;
    if (rate == 0.0 && room < 0.0) s_end = -1e30;
    cut = start > s;
    s = max(s, start);
  }
  float s_start = s;

  Meeting met = Meeting(-1e30, 0.0, 0.0, 0.0);
#ifdef POSED
  vec3 node_base = node_of(base), node_d = d * u_node_scale, inverse_node_d = inverse_d / u_node_scale;
  vec3 forward = vec3(greaterThan(safe, vec3(0.0))), ahead = sign(safe) * 1e-3;
  vec3 rest_base = vec3(0.0), rest_d = d;
  Sheet sheet = Sheet(false, vec3(0.0), vec3(0.0));
  for (int pieces = 0; pieces < 1024 && s < s_end && met.s < -1e29; ++pieces) {
    // Finds the next cube of the map that can contain the surface; beside a fold, the next octant of a cube.
    uint cube = 0u;
    vec3 low;
    float s_leave, size = 1.0;
    for (int cubes = 0; cubes < 1024; ++cubes) {
      vec3 node = node_base + node_d * s + ahead;
      cube = cube_in(u_near_cubes, node);
      size = cube >= kBroken ? 0.5 : 1.0;
      low = floor(node / size) * size;
      vec3 leave = (low + forward * size - node_base) * inverse_node_d;
      s_leave = max(min(min(leave.x, leave.y), leave.z), s + 0.1) + 1e-3;
      if (cube != 0u || s_leave >= s_end) break;
      s = s_leave;
    }
    // Where the map is linear, as in limbs that turn rigidly, one piece of the ray runs through several cubes.
    float s_far = s + kStretch / u_node_scale;
    sheet = sheet_at(low + 0.5 * size, cube);
    vec3 from = rest_on(sheet, node_base + node_d * s), to = rest_on(sheet, node_base + node_d * s_leave);
    vec3 far = rest_on(sheet, node_base + node_d * s_far),
         middle = rest_on(sheet, node_base + node_d * (0.5 * (s + s_far)));
    bool straight = cube < kBordered && s_far > s_leave && all(lessThan(abs(from + far - 2.0 * middle), vec3(0.1)));
    if (straight) { to = far; s_leave = s_far; }
    rest_d = (to - from) / (s_leave - s);
    rest_base = from - rest_d * s;
    vec3 rest_speed = abs(rest_d);
    float rate = max(max(max(rest_speed.x, rest_speed.y), rest_speed.z), 0.1);
    float s_to = min(s_leave, s_end);
    if (cube >= kBordered) {  // keeps only the part of the piece within the sheet's border
      float first = apart_on(sheet, node_base + node_d * s), last = apart_on(sheet, node_base + node_d * s_leave),
            at = s + (s_leave - s) * first / (first - last);
      if (last < 0.0) s_to = first < 0.0 ? s : min(s_to, at);
      else if (first < 0.0) s = at;
    }
    if (cube != 0u && from.x > -1e5 && to.x > -1e5) march(rest_base, rest_d, rate, s_start, s_to, s, met);
    s = s_leave;
  }
#else
  march(base, d, 1.0, s_start, s_end, s, met);
#endif
  float found = met.s;

  if (found < -1e29 || found > s_end) {
    out_depth = 1e30;
    out_normal = vec4(0.0);
    out_label = 0u;
    out_place = uvec4(0u);
    return;
  }
  bool cap = cut && found == s_start;
  // Finds the crossing by the secant method.
  if (!cap)
    found = mix(max(met.s_before, s_start), found,
                clamp((kSurface - met.value_before) / max(met.value - met.value_before, 1e-3), 0.0, 1.0));
  vec3 p = base + d * found;
  vec3 a = vec3(1, -1, -1) * u_tap, b = vec3(-1, -1, 1) * u_tap, c = vec3(-1, 1, -1) * u_tap, e = vec3(u_tap);
#ifdef POSED
  // The rest of this function works in rest positions. The matrix that turns directions is computed from differences
  // between the rest positions at the four corners of a tetrahedron. A mirrored sheet is defined only in the cube on
  // the other side of its node, so the tetrahedron lies around the centre of that cube.
  vec3 node = node_of(p);
  if (sheet.mirrored) node = sheet.node + 0.5 * sign(node - sheet.node);
  vec3 at_a = rest_on(sheet, node + a * kNodeTap), at_b = rest_on(sheet, node + b * kNodeTap),
       at_c = rest_on(sheet, node + c * kNodeTap), at_e = rest_on(sheet, node + e * kNodeTap);
  mat3 rest_from_posed = mat3(at_a - at_b - at_c + at_e, at_c + at_e - at_a - at_b, at_b + at_e - at_a - at_c) *
                         (u_node_scale / (4.0 * u_tap * kNodeTap));
  bool torn = any(greaterThan(abs(rest_from_posed[0]) + abs(rest_from_posed[1]) + abs(rest_from_posed[2]), vec3(8.0)));
  if (torn) rest_from_posed = mat3(1.0);
  p = clamp(rest_base + rest_d * found, vec3(0.0), vec3(u_blocks * BLOCK) - 1e-3);
  d = rest_from_posed * d;
#endif
  Slot slot = slot_at(p);

  // Computes the gradient from differences between the four corners of a tetrahedron.
  vec3 at = p + vec3(slot.offset);
  vec3 gradient = a * field_at(slot.atlas, at + a) + b * field_at(slot.atlas, at + b) +
                  c * field_at(slot.atlas, at + c) + e * field_at(slot.atlas, at + e);
  vec3 steepness = abs(gradient);
  float steepest = max(max(steepness.x, steepness.y), steepness.z);
  vec3 inward = steepest < 1e-4 || cap ? d : gradient / steepest;
#ifdef POSED
  if (torn) inward = d;
#endif
#ifdef POSED
  vec3 normal = normalize(-(u_view_from_gradient * (inward * rest_from_posed)));
  normal.z = abs(normal.z);  // in a fold the ray may hit the inside of a sheet
  if (sheet.mirrored) normal = normalize(normal + vec3(0, 0, 1.5));  // smooths the scattered normals of a fold
#else
  vec3 normal = normalize(-(u_view_from_gradient * inward));
#endif

  // Finds the first label of the layer by walking inward from a little outside the surface, first through air, then
  // through hidden tissue. After a diagonal step out of air, the voxels beside the step are also read, so that a skin
  // one voxel thick has no gaps.
  vec3 step = (cap ? d : inward) * 0.5;
  vec3 inside = at + u_label_shift + (cap ? step * 0.02 : inward * -1.4);
  uint label = label_at(slot.atlas, ivec3(inside));
  int steps = 0;
  while (label == 0u && steps < 8) {
    ivec3 from = ivec3(inside);
    inside += step;
    ++steps;
    ivec3 to = ivec3(inside);
    label = label_at(slot.atlas, to);
    if (label != 0u && abs(to.x - from.x) + abs(to.y - from.y) + abs(to.z - from.z) > 1) {
      ivec3 beside[6] = ivec3[6](ivec3(to.x, from.yz), ivec3(from.x, to.y, from.z), ivec3(from.xy, to.z),
                                 ivec3(from.x, to.yz), ivec3(to.x, from.y, to.z), ivec3(to.xy, from.z));
      uint first = 0u;
      for (int i = 0; i < 6 && first == 0u; ++i) first = label_at(slot.atlas, beside[i]);
      if (first != 0u) label = first;
    }
  }
  while ((texelFetch(u_looks, ivec2(label & 255u, label >> 8), 0).a & 7u) <= u_layer) {
    inside += step;
    if (++steps > 8) { label = 0u; break; }
    label = label_at(slot.atlas, ivec3(inside));
  }

  out_depth = found / voxels_per_depth;
#ifdef POSED
  bool fold = sheet.mirrored;
#else
  const bool fold = false;
#endif
  out_normal = vec4(normal * 0.5 + 0.5, cap ? 1.0 : fold ? 2.0 / 3.0 : 1.0 / 3.0);
  out_label = label;
  // The position is a little inside the surface, where the steps between voxels do not show.
  out_place = uvec4(uvec3(clamp((p + (cap ? d * 0.02 : inward * 0.7)) * u_places, vec3(0.0), vec3(65535.0))), 1u);
}
