// SPDX-License-Identifier: AGPL-3.0-or-later
// The shifts that baked joints (baked_joint.h) add to blended tissue in one pose. Shifts of several joints add up.
#pragma once

#include <array>
#include <memory>
#include <vector>

#include "core/deform/baked_joint.h"
#include "core/deform/flesh_shifts.h"
#include "core/volume/tissue_voxels.h"

namespace limber {

// A baked joint, and the rotation that it has in a pose.
struct BentJoint {
  std::shared_ptr<const BakedJoint> baked;
  double degrees = 0;                  // rotation of the joint about the baked axis
  glm::dquat parent_turn{1, 0, 0, 0};  // rotation, from rest, of the bone above the joint

  bool operator==(const BentJoint&) const = default;
};

// Finds the lattice nodes of a baked joint around a place, and their trilinear weights.
class BakedSampler {
 public:
  // Keeps a reference to the joint, which must outlive this object.
  //   throws Error when the joint was baked from a larger volume
  BakedSampler(const BakedJoint& joint, const Grid& grid);

  struct Shares {
    int count = 0;                     // 0: no node with a shift is around the place
    std::array<std::int32_t, 8> node;  // the nodes, as indices in BakedJoint::nodes
    std::array<float, 8> share;
  };
  // Returns the nodes with shifts around a place.
  //   place  in units of voxels; voxel v begins at v, its lowest corner
  Shares at(const glm::dvec3& place) const;
  // Returns the nearest node with a shift, at most `reach` voxels away along each axis, with the weight 1.
  Shares nearest(const glm::ivec3& place, int reach) const;

 private:
  const BakedJoint* joint_;
  std::vector<std::int32_t> index_;  // for each node of the box, its index in BakedJoint::nodes; -1: it has no shift
};

class BakedFlesh final : public FleshShifts {
 public:
  // Keeps a reference to `tissue`, which must outlive this object. Ignores joints that are at rest.
  //   grid    the volume's grid
  //   throws  Error when a joint was baked from a larger volume
  BakedFlesh(const TissueVoxels& tissue, const Grid& grid, const std::vector<BentJoint>& joints);

  bool empty() const { return fields_.empty(); }  // true if no corner has a shift

  bool corner_shifts(std::int64_t brick, CornerShifts& shifts) const override;
  glm::vec3 corner_shift(const glm::ivec3& lowest, unsigned around) const override;
  bool bends(std::int64_t brick) const override { return bends_[brick]; }
  // Returns the shift at a place, which is in units of voxels; voxel v begins at v, its lowest corner.
  glm::vec3 shift_at(const glm::dvec3& place) const;

 private:
  // The shifts of one joint at the nodes of its lattice.
  struct Field {
    // The two nodes around a place along one axis: node `low` and the next one, which has the weight `share`.
    struct Along {
      int low;
      float share;
    };
    glm::ivec3 step, first, size;
    std::vector<glm::vec3> shift;  // shift of each node of the box, voxels; zero if none is stored

    bool touches(const glm::ivec3& low, const glm::ivec3& high) const;
    void add(const glm::ivec3& low, CornerShifts& shifts) const;
    glm::vec3 at(const glm::dvec3& place) const;
    Along along(int axis, double place) const;
    glm::vec3 between(const Along& x, const Along& y, const Along& z) const;
  };

  const TissueVoxels* tissue_;
  std::vector<Field> fields_;
  std::vector<std::uint8_t> bends_;  // for each brick, whether a shift bends it
};

}  // namespace limber
