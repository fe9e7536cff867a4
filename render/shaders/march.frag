// SPDX-License-Identifier: AGPL-3.0-or-later
// Follows the ray of each pixel to the surface of the visible tissue.
#include "rays.glsl"
#include "trace.glsl"

in vec2 ndc;
uniform sampler2D u_range;
uniform float u_nearest;  // depth at which rays start if the eye is inside the hull of the visible tissue; else -1e30
uniform usampler2D u_looks;
uniform uint u_layer;
uniform bool u_clipped;
uniform mat3 u_view_from_gradient;

layout(location = 0) out float out_depth;
layout(location = 1) out vec4 out_normal;
layout(location = 2) out uint out_label;
layout(location = 3) out uvec4 out_place;

#ifdef POSED
// Factor that makes u_tap half the distance between two nodes of the map, so that directions change smoothly from cube
// to cube.
const float kNodeTap = 0.5 / 1.4;
#endif

// The gradient is computed from four corners of a tetrahedron. Each is this far from the hit along each axis, voxels;
// negative: the tetrahedron is mirrored.
uniform float u_tap;
uniform vec3 u_label_shift;
uniform float u_places;            // number of steps of out_place per voxel of the drawn volume
uniform bool u_smooth_cuts;        // true: borders between labels on cut faces are smooth

bool in_layer(uint label) { return (texelFetch(u_looks, ivec2(label & 255u, label >> 8), 0).a & 7u) > u_layer; }

// Returns the number of consecutive voxels with the label in a row through `voxel`, counting at most two on each side.
// Voxels farther than two from `middle` may lie outside the voxels that the atlas stores for this block; they count as
// if they had the label.
int row_length(uint atlas, ivec3 middle, ivec3 voxel, ivec3 axis, uint label) {
  int count = 1;
  for (int side = -1; side <= 1; side += 2)
    for (int i = 1; i <= 2; ++i) {
      ivec3 at = voxel + axis * i * side;
      if (all(lessThanEqual(abs(at - middle), ivec3(2))) && label_at(atlas, at) != label) break;
      ++count;
    }
  return count;
}

// Returns true if a sheet of one voxel, or a thread of at most two by two, runs through the voxel.
bool is_thin(uint atlas, ivec3 middle, ivec3 voxel, uint label) {
  ivec3 rows = ivec3(row_length(atlas, middle, voxel, ivec3(1, 0, 0), label),
                     row_length(atlas, middle, voxel, ivec3(0, 1, 0), label),
                     row_length(atlas, middle, voxel, ivec3(0, 0, 1), label));
  ivec3 narrow = ivec3(lessThanEqual(rows, ivec3(2)));
  return any(equal(rows, ivec3(1))) || narrow.x + narrow.y + narrow.z >= 2;
}

// Returns the weight of a voxel's vote by its distance along one axis, voxels. The weight falls smoothly to 0 at a
// distance of 2.5 voxels or, if `narrow`, of 1.5 voxels (quadratic B-spline).
float vote(float apart, bool narrow) {
  float far = max(0.0, 1.5 - apart), near = max(0.0, 1.0 - apart * apart / 6.25);
  return !narrow ? near * near : apart < 0.5 ? 0.75 - apart * apart : 0.5 * far * far;
}

// Returns the label of a position on a cut face. The voxels around the position vote, so that the border between two
// labels is smooth. Near thin sheets and threads, which would lose such a vote, only nearer voxels vote. A voxel that
// would lose the vote even at its own centre keeps its label, so that no label vanishes.
uint voted_label(uint atlas, vec3 p) {
  ivec3 middle = ivec3(p);
  vec3 f = p - vec3(middle) - 0.5;
  ivec3 side = ivec3(greaterThan(f, vec3(0.0))) * 2 - 1;
  uint own = label_at(atlas, middle), labels[8];
  int count = 0;  // number of different labels among the eight nearest voxels
  for (int i = 0; i < 8; ++i) {
    uint label = label_at(atlas, middle + ivec3(i & 1, i >> 1 & 1, i >> 2) * side);
    bool known = label == 0u || !in_layer(label);
    for (int k = 0; k < count; ++k) known = known || labels[k] == label;
    if (!known) labels[count++] = label;
  }
  if (count == 0) return own;
  if (count == 1) return labels[0];
  bool narrow = false;
  for (int i = 0; i < 8 && !narrow; ++i) {
    ivec3 voxel = middle + ivec3(i & 1, i >> 1 & 1, i >> 2) * side;
    uint label = label_at(atlas, voxel);
    narrow = label != 0u && is_thin(atlas, middle, voxel, label);
  }
  float votes[8] = float[8](0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0), at_middle = 0.0;
  int reach = narrow ? 1 : 2;
  for (int z = -reach; z <= reach; ++z)
    for (int y = -reach; y <= reach; ++y)
      for (int x = -reach; x <= reach; ++x) {
        uint label = label_at(atlas, middle + ivec3(x, y, z));
        vec3 apart = abs(vec3(x, y, z) - f);
        float share = vote(apart.x, narrow) * vote(apart.y, narrow) * vote(apart.z, narrow);
        for (int k = 0; k < count; ++k) votes[k] += labels[k] == label ? share : 0.0;
        if (label == own) at_middle += (x == 0 ? 0.75 : 0.125) * (y == 0 ? 0.75 : 0.125) * (z == 0 ? 0.75 : 0.125);
      }
  if (narrow && own != 0u && in_layer(own) && at_middle < 0.5) return own;
  int best = 0;
  for (int k = 1; k < count; ++k)
    if (votes[k] > votes[best]) best = k;
  return labels[best];
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

#ifdef POSED
  Piece piece;
  Meeting met = trace(base, d, s_start, s_end, piece);
  vec3 rest_base = piece.base, rest_d = piece.d;
  Sheet sheet = piece.sheet;
#else
  Meeting met = trace(base, d, s_start, s_end);
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
  // Finds where the ray crosses the surface, by the secant method.
  if (!cap)
    found = mix(max(met.s_before, s_start), found,
                clamp((kSurface - met.value_before) / max(met.value - met.value_before, 1e-3), 0.0, 1.0));
  vec3 p = base + d * found;
  vec3 a = vec3(1, -1, -1) * u_tap, b = vec3(-1, -1, 1) * u_tap, c = vec3(-1, 1, -1) * u_tap, e = vec3(u_tap);
#ifdef POSED
  // The rest of this function works in rest positions. The matrix that turns directions is computed from differences
  // between the rest positions at the four corners of a tetrahedron. Beside a fold (sheet.mirrored), the map is read at
  // the mirror images of these corners, on the other side of the nearest node. The tetrahedron lies around the centre
  // of a cube of the map, so that all four mirror images lie in one cube.
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
  normal.z = abs(normal.z);  // in a fold, the ray may hit the surface from inside
  // Beside a fold, normals are noisy; this turns them towards the viewer.
  if (sheet.mirrored) normal = normalize(normal + vec3(0, 0, 1.5));
#else
  vec3 normal = normalize(-(u_view_from_gradient * inward));
#endif

  // Finds the first label that belongs to the drawn layer, by walking inward from a little outside the surface, first
  // through air, then through hidden tissue. After a diagonal step out of air, the voxels beside the step are also
  // read, so that a skin one voxel thick has no gaps.
  vec3 step = (cap ? d : inward) * 0.5;
  vec3 inside = at + u_label_shift + (cap ? step * 0.02 : inward * -1.4);
  uint label = cap && u_smooth_cuts ? voted_label(slot.atlas, at + step * 0.02) : label_at(slot.atlas, ivec3(inside));
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
  while (!in_layer(label)) {
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
