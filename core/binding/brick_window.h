// SPDX-License-Identifier: AGPL-3.0-or-later
// One brick of tissue (8^3 voxels) and the layer of voxels around it, as a dense block. Heat flows through voxel faces
// only, so that is all that a step on a brick reads.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/volume/tissue_voxels.h"

namespace limber {

// Stands in place of a bone index for a voxel whose temperature no bone fixes.
constexpr std::uint16_t kSoft = 0xFFFF;

struct BrickWindow {
  // What a window is read from. The referred objects must outlive it.
  struct Source {
    const LabelVolume& volume;
    const TissueVoxels& tissue;
    const ZeroedVector<std::uint16_t>& held_by;  // bone that fixes each tissue voxel's temperature; kSoft: none
    const std::vector<float>& conductivity;      // of each label's tissue, above 0
  };
  // Step in the arrays to the neighbour towards -x, +x, -y, +y, -z, +z.
  static constexpr int kTo[6] = {-1, 1, -10, 10, -100, 100};

  std::array<std::int32_t, 1000> place;  // index in the list of tissue voxels; -1: air
  std::array<float, 1000> soft;          // conductivity; 0 for all voxels that are not soft
  std::array<int, 6> beside;             // index of the neighbouring brick in each direction; -1: none
  const Seams* seams = nullptr;          // null: no seam is near this brick

  // Returns the index of voxel v in the arrays; v is relative to the brick's lowest corner, [-1, 8] along each axis.
  static int at(const glm::ivec3& v) { return (v.x + 1) + 10 * (v.y + 1) + 100 * (v.z + 1); }

  // Returns whether a seam cuts the face of a voxel of the volume in a direction.
  bool is_cut(const glm::ivec3& voxel, int direction) const { return seams && seams->is_cut_towards(voxel, direction); }

  // Fills the window with a brick. The voxels at the window's edges and corners are not read and count as air.
  void look(const Source& from, std::int64_t brick) {
    const auto& here = from.tissue.bricks()[brick];
    seams = from.tissue.seams();
    if (seams && !seams->is_near_brick(here.corner)) seams = nullptr;
    place.fill(-1);
    soft.fill(0);
    from.tissue.for_each(brick, brick + 1,
                         [&](std::int64_t p, const glm::ivec3& v) { set(from, v - here.corner, v, p); });
    for (int direction = 0; direction < 6; ++direction) look_beside(from, here.corner, direction);
  }

 private:
  void set(const Source& from, const glm::ivec3& from_corner, const glm::ivec3& voxel, std::int64_t its_place) {
    place[at(from_corner)] = static_cast<std::int32_t>(its_place);
    if (from.held_by[its_place] == kSoft) soft[at(from_corner)] = from.conductivity[from.volume.at(voxel)];
  }

  // Fills the layer of voxels that lies in the neighbouring brick in a direction.
  void look_beside(const Source& from, const glm::ivec3& corner, int direction) {
    const int axis = direction >> 1, side = direction & 1 ? TissueVoxels::kBrick : -1;
    glm::ivec3 first = corner;
    first[axis] += side;
    beside[direction] = from.volume.grid.contains(first) ? from.tissue.brick_at(first) : -1;
    if (beside[direction] < 0) return;
    const auto& there = from.tissue.bricks()[beside[direction]];
    glm::ivec3 v;
    v[axis] = side;
    int &a = v[(axis + 1) % 3], &b = v[(axis + 2) % 3];
    for (a = 0; a < TissueVoxels::kBrick; ++a)
      for (b = 0; b < TissueVoxels::kBrick; ++b)
        if (const std::int64_t found = TissueVoxels::index_in(there, v & 7); found >= 0)
          set(from, v, corner + v, found);
  }
};

}  // namespace limber
