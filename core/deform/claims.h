// SPDX-License-Identifier: AGPL-3.0-or-later
// Writes claims into an inverse map, by the rules of inverse_map.h. A claim says that the posed image of a cell (a cube
// or a tet) covers a voxel's centre. `cell` is the index of the rest voxel that contains the claim's rest point.
#pragma once

#include "core/deform/inverse_map.h"

namespace limber {

class Claims {
 public:
  // All arguments must outlive this object.
  //   priority  by label: where cells overlap, the cell whose tissue has the higher priority wins
  //   depth     depth of rest points below the body's surface: in a fold, where several cells cover a voxel, the
  //             deepest cell wins. nullptr: the pose makes no fold
  Claims(InverseMap& map, const LabelVolume& volume, const std::vector<int>& priority, const TissueDepth* depth)
      : map_(map),
        volume_(volume),
        priority_(priority),
        depth_(depth) {}

  void claim(std::uint32_t cell, const glm::ivec3& rest_voxel, const CellClaim& claim) {
    const std::int64_t at = map_.index(claim.voxel);
    const std::uint32_t holder = map_.cell[at];
    bool wins = true;
    if (holder != InverseMap::kNoCell) {
      wins = is_better(cell, claim, at);
      count_overlap(rest_voxel, at, wins ? holder : cell);
    }
    if (wins) write(cell, claim, at);
  }

  // Writes the claim only if no other cell has claimed the voxel yet. Otherwise counts an overlap.
  //   near  cells that are at most this many voxels apart at rest count as pressed together, not as overlapping
  void claim_empty(std::uint32_t cell, const glm::ivec3& rest_voxel, const CellClaim& claim, int near) {
    const std::int64_t at = map_.index(claim.voxel);
    if (map_.cell[at] == InverseMap::kNoCell) write(cell, claim, at);
    else count_overlap(rest_voxel, at, cell, near);
  }

 private:
  static bool are_near(const glm::ivec3& a, const glm::ivec3& b, int near) {
    return glm::all(glm::lessThanEqual(glm::abs(a - b), glm::ivec3(near)));
  }

  // Marks an overlap at a voxel that another cell has already claimed, unless both cells are near each other at rest.
  //   rest_voxel  cell of the new claim
  //   loser       the cell that does not get the voxel, of the two that claim it
  //   near        largest distance along each axis at which cells count as near, voxels; 1: neighbours
  void count_overlap(const glm::ivec3& rest_voxel, std::int64_t at, std::uint32_t loser, int near = 1) {
    const std::uint32_t holder = map_.cell[at];
    const glm::ivec3 size = volume_.grid.size;
    if (are_near(rest_voxel, {int(holder % size.x), int(holder / size.x % size.y), int(holder / size.x / size.y)},
                 near))
      return;
    map_.flags[at] |= InverseMap::kOverlap;
    map_.lost.push_back(volume_.voxels[loser]);
  }

  void write(std::uint32_t cell, const CellClaim& claim, std::int64_t at) {
    map_.use_row(claim.voxel);
    map_.cell[at] = cell;
    map_.rest[at] = claim.rest;
    if (map_.has_volume_ratio) map_.posed_per_rest[at] = static_cast<float>(claim.posed_per_rest);
    map_.flags[at] = (map_.flags[at] & ~InverseMap::kInverted) | (claim.posed_per_rest < 0 ? InverseMap::kInverted : 0);
  }

  bool is_better(std::uint32_t cell, const CellClaim& claim, std::int64_t at) const {
    const bool inverted = claim.posed_per_rest < 0, holder_inverted = map_.flags[at] & InverseMap::kInverted;
    if (inverted != holder_inverted) return holder_inverted;
    const std::uint32_t holder = map_.cell[at];
    const int mine = priority_[volume_.voxels[cell]], theirs = priority_[volume_.voxels[holder]];
    if (mine != theirs) return mine > theirs;
    if (depth_) {
      const double my_depth = (*depth_)(glm::vec3(claim.rest)), their_depth = (*depth_)(map_.rest[at]);
      if (my_depth != their_depth) return my_depth > their_depth;
    }
    return cell < holder;
  }

  InverseMap& map_;
  const LabelVolume& volume_;
  const std::vector<int>& priority_;
  const TissueDepth* depth_;
};

}  // namespace limber
