// SPDX-License-Identifier: AGPL-3.0-or-later
// Follows a ray to the surface of the visible tissue, at rest or posed. A position s along a ray counts voxels along
// the axis on which the ray moves fastest, so that no step of 1 skips a layer of voxels.
#include "atlases.glsl"
#ifdef POSED
#include "posed.glsl"
#endif

uniform usampler3D u_index;
uniform vec3 u_low, u_high;  // box around the hull of the visible tissue, intersected with the clip box
uniform vec4 u_plane;        // points p with dot(xyz, p) <= w stay visible

#ifdef POSED
// States of the map's cubes; 0 for cubes that are far from the labels of the drawn layer.
uniform usampler3D u_near_cubes;
uniform ivec3 u_blocks;
const float kStretch = 3.0;  // length of the pieces of a ray that are tested for straightness, steps between nodes
#endif

const float kSurface = float(SURFACE) / 255.0;
// At this field value or a larger one, the surface may be near, so the ray reads filtered values.
const float kBand = 72.0 / 255.0;
const float kFirstFieldValue = 7.5 / 255.0;

struct Slot { ivec3 offset; uint atlas; };
Slot slot_of(ivec3 block) {
#ifdef POSED
  // Clamps the block, because a piece of a ray that was converted to rest positions may leave the volume.
  ivec3 inside = clamp(block, ivec3(0), u_blocks - 1);
  uvec4 entry = texelFetch(u_index, inside, 0);
  if (inside != block) entry.w = 0u;
#else
  uvec4 entry = texelFetch(u_index, block, 0);
#endif
  return Slot(ivec3(entry.xyz) * SLOT + APRON - block * BLOCK, entry.w);
}

// Returns the slot (place in an atlas) of the block that contains p. This may be another block than that in which the
// march found p.
Slot slot_at(vec3 p) { return slot_of(ivec3(p) >> BLOCK_SHIFT); }

// Where a ray hits the surface: the position s (-1e30: no hit) and the field's value there; the last position before
// the hit and the field's value there.
struct Meeting { float s, value, s_before, value_before; };

// Marches from s to s_end along the straight line base + d s in rest positions, and advances s. A voxel has the length
// 1 / rate in s. If the line hits the surface at s_start or later, stores the hit in `found`.
void march(vec3 base, vec3 d, float rate, float s_start, float s_end, inout float s, inout Meeting found) {
  float voxel = 1.0 / rate;
  vec3 safe = mix(d, vec3(1e-9), lessThan(abs(d), vec3(1e-9)));
  vec3 inverse_d = 1.0 / safe;
  vec3 block_exit = vec3(greaterThan(safe, vec3(0.0))) * float(BLOCK);
  vec3 ahead = sign(safe) * 0.02;  // moves on to the next block even where the ray runs along a face
  for (int tries = 0; tries < 1024 && s < s_end && found.s < -1e29; ++tries) {
    // Advance block by block until the surface may be near.
    Slot slot = Slot(ivec3(0), 0u);
    vec3 at;  // the line's base, in texels of the atlas that stores the block
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
    // voxel, from which the next step is estimated. The step is short enough not to skip a thread. All reads stay
    // within the voxels that the atlas stores around the block.
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

#ifdef POSED
// The last straight piece of a posed ray that was followed, in rest positions: base + d s.
struct Piece { vec3 base, d; Sheet sheet; };
#endif

// Follows the ray base + d s, in padded coordinates, from s_start to s_end until it meets the surface.
#ifdef POSED
Meeting trace(vec3 base, vec3 d, float s_start, float s_end, out Piece piece) {
#else
Meeting trace(vec3 base, vec3 d, float s_start, float s_end) {
#endif
  float s = s_start;
  Meeting met = Meeting(-1e30, 0.0, 0.0, 0.0);
#ifdef POSED
  vec3 safe = mix(d, vec3(1e-9), lessThan(abs(d), vec3(1e-9)));
  vec3 inverse_d = 1.0 / safe;
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
    // If neighbouring cubes map linearly in the same way, as in limbs that turn rigidly, one piece of the ray runs
    // through several cubes.
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
  piece = Piece(rest_base, rest_d, sheet);
#else
  march(base, d, 1.0, s_start, s_end, s, met);
#endif
  return met;
}
