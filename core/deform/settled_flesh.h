// SPDX-License-Identifier: AGPL-3.0-or-later
// Corrects blended tissue so that it keeps its volume. Blending does not preserve volume: the shoulder of a raised arm
// swells, the hollow of a bent knee is pressed flat. So the smallest and smoothest shifts are found that restore the
// volume of coarse cells of tissue (flesh_cells.h). Let c be the shift of a node and F the deformation gradient in the
// centre of a cell. The shifts minimise
//
//    sum over cells  fill * ( h^2 |grad c|^2  +  kVolume |F - P|^2 )
//      +   sum over nodes  ( |c / (kReach h)|^2  +  kBone * bone * |c|^2 )
//
// P is the matrix near F whose determinant gives the cell its volume, and which stretches it to at most twice its
// length, or as far as blending does; h is the edge of a cell, and bone the volume of bone around a node, so that bones
// stay where the pose moves them. In addition, springs move nodes of soft tissue inside a bone to its surface
// (posed_bones.h), and nodes inside other flesh half of the way out of it (flesh_contact.h). Shifts start from the
// blended pose, so that painted weights still count. P is recomputed before each solve for the shifts by conjugate
// gradients, whose matrix stays the same except for these springs [Bouaziz, Martin, Liu, Kavan & Pauly 2014, Projective
// dynamics]. The result does not depend on the number of threads, byte for byte.
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
    // Mean of |V / V0 - 1| over the tissue, where V0 and V are the rest volume and the posed volume of a cell.
    double volume_error_before = 0, volume_error_after = 0;
    double largest_shift_mm = 0;
  };

  //   is_bone          by label: whether it is bone
  //   posed_from_rest  motions of the bones of `weights`
  SettledFlesh(const LabelVolume& volume, const TissueVoxels& tissue, const SkinWeights& weights,
               const LabelSet& is_bone, const std::vector<RigidTransform>& posed_from_rest, Blend blend,
               Progress& progress);

  const Report& report() const { return report_; }

  // The shifts of the 9^3 corners of a brick's voxels, in the order of PosedLattice::Corners, in voxels along the
  // volume's axes. Where the cells around a corner have different shifts, the corner has the mean shift.
  using CornerShifts = std::array<glm::vec3, 729>;
  // Computes the corner shifts of a brick. Returns whether the brick bends; if not, `shifts` is not written.
  bool corner_shifts(std::int64_t brick, CornerShifts& shifts) const;
  // Returns the shift of one corner of a voxel near a seam.
  //   lowest  the lowest of the eight voxels around the corner
  //   around  bits of those of the eight voxels whose cells give the shift: bit 0 for the lowest, and x fastest; not 0
  glm::vec3 corner_shift(const glm::ivec3& lowest, unsigned around) const;

 private:
  // The nodes of a cell that have a trilinear weight above zero at a voxel corner, with these weights.
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
  std::vector<glm::vec3> shift_;  // shift of each node, voxels
  Report report_;
};

}  // namespace limber
