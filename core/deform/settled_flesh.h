// SPDX-License-Identifier: AGPL-3.0-or-later
// Corrects blended tissue so that it keeps its volume. Blending does not preserve volume: the shoulder of a raised arm
// swells, the hollow of a bent knee is flattened. The tissue is divided into coarse cells (flesh_cells.h), and the
// smallest and smoothest shifts of the cells' nodes are found that restore the cells' volumes. Let c be the shift of a
// node and F the deformation gradient in the centre of a cell. The shifts minimise
//
//    sum over cells  fill * ( h^2 |grad c|^2  +  kVolume |F - P|^2 )
//      +   sum over nodes  ( |c / (kReach h)|^2  +  kBone * bone * |c|^2 )
//
// P is a matrix near F that has the determinant of the wanted volume and that stretches the cell to at most
// twice its length (or as far as blending does). h is the edge of a cell. bone is the volume of bone around a node; its
// term keeps bones at the positions that the pose gives them. In addition, springs pull nodes of soft tissue inside a
// bone to the bone's surface (posed_bones.h), and nodes inside other flesh half of the way out of it (flesh_contact.h).
// Shifts start from the blended pose, so painted weights still have an effect. In each step, P is computed again, then
// conjugate gradients solve for the shifts; the matrix changes only by the springs [Bouaziz, Martin, Liu, Kavan & Pauly
// 2014, Projective dynamics]. The result does not depend on the number of threads, byte for byte.
#pragma once

#include <algorithm>
#include <array>
#include <memory>
#include <span>
#include <vector>

#include "core/base/progress.h"
#include "core/deform/flesh_cells.h"
#include "core/deform/flesh_shifts.h"

namespace limber {

class SettledFlesh final : public FleshShifts {
 public:
  struct Report {
    std::int64_t cells = 0;
    // Mean of |V / V0 - 1| over the tissue, where V0 and V are the rest volume and the posed volume of a cell.
    double volume_error_before = 0, volume_error_after = 0;
    double largest_shift_mm = 0;
  };

  // Computes the shifts in the pose. `tissue` must outlive this object.
  //   is_bone          1 for each label that is bone tissue
  //   posed_from_rest  motions of the bones of `weights`
  SettledFlesh(const LabelVolume& volume, const TissueVoxels& tissue, const SkinWeights& weights,
               const LabelSet& is_bone, const std::vector<RigidTransform>& posed_from_rest, Blend blend,
               Progress& progress);

  const Report& report() const { return report_; }

  // Computes the shifts of the brick's corners. Where the cells around a corner have different shifts, the corner has
  // the mean shift. A brick has shifts if the pose bends it.
  bool corner_shifts(std::int64_t brick, CornerShifts& shifts) const override;
  glm::vec3 corner_shift(const glm::ivec3& lowest, unsigned around) const override;
  bool bends(std::int64_t) const override { return false; }

 private:
  // The nodes of a cell whose trilinear weight at a voxel corner is above zero, with these weights.
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
