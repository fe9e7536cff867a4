// SPDX-License-Identifier: AGPL-3.0-or-later
// Blending does not know of volume: a raised arm's shoulder swells, the hollow of a bent knee is pressed flat. Here
// flesh settles: the least and smoothest shifts are found by which coarse cells of tissue (flesh_cells.h) get their
// volume back. With c the shift of a node and F the deformation gradient in a cell's middle, this is made least:
//
//   sum over cells  fill * ( h^2 |grad c|^2  +  kVolume |F - P|^2 )
//     +   sum over nodes  ( |c / (kReach h)|^2  +  kBone * bone * |c|^2 )
//
// and nodes inside a bone that they do not belong to are pulled to its surface (posed_bones.h), nodes inside other
// flesh half of the way out of it (flesh_contact.h). P is the matrix near F by whose determinant the cell would have
// its volume, h the edge of a cell, and bone how much bone lies around a node: bones stay where the pose has them. What
// weights say of how tissue follows bones stays the start, so that painted weights count. P is found anew after each
// step of conjugate gradients on the rest, whose matrix is the same for all of them [Bouaziz, Martin, Liu, Kavan &
// Pauly 2014, Projective dynamics]. The same bytes come out for any number of threads.
#pragma once

#include <algorithm>
#include <array>
#include <memory>
#include <span>
#include <vector>

#include "core/base/progress.h"
#include "core/deform/flesh_cells.h"

namespace limber {

class SettledFlesh {
 public:
  struct Report {
    std::int64_t cells = 0;
    double volume_error_before = 0, volume_error_after = 0;  // mean |V - V0| / V0 over the tissue of all cells
    double largest_shift_mm = 0;
  };

  //   posed_from_rest  by bone of `weights`      is_bone  by label
  SettledFlesh(const LabelVolume& volume, const TissueVoxels& tissue, const SkinWeights& weights,
               const LabelSet& is_bone, const std::vector<RigidTransform>& posed_from_rest, Blend blend,
               Progress& progress);

  const Report& report() const { return report_; }

  // Shifts of the 9^3 corners of a brick's voxels, in the order of PosedLattice::Corners, in voxels along the volume's
  // axes. Where the cells around a corner differ, their mean.
  using CornerShifts = std::array<glm::vec3, 729>;
  //   returns  whether the brick bends; `shifts` is left alone where not
  bool corner_shifts(std::int64_t brick, CornerShifts& shifts) const;
  // Of one corner of a voxel, where a seam is near.
  //   around  a bit for each of the eight voxels around the corner that count, the lowest first; at least one
  //   lowest  the lowest of the eight
  glm::vec3 corner_shift(const glm::ivec3& lowest, unsigned around) const;

 private:
  // The nodes of a cell whose shares of a corner are not zero.
  struct Shares {
    int count = 0;
    std::array<std::int32_t, 8> node;
    std::array<float, 8> share;
    bool same_nodes(const Shares& other) const {
      return std::equal(node.begin(), node.begin() + count, other.node.begin(), other.node.begin() + other.count);
    }
  };
  Shares shares_in(std::int32_t cell, const glm::ivec3& corner) const;
  glm::vec3 mean_shift(std::span<const std::int32_t> cells, const glm::ivec3& corner) const;
  std::int32_t cell_at(const glm::ivec3& voxel, bool& is_rigid) const;

  const TissueVoxels* tissue_;
  FleshCells cells_;
  std::vector<glm::vec3> shift_;  // by node, voxels
  Report report_;
};

}  // namespace limber
