// SPDX-License-Identifier: AGPL-3.0-or-later
// The shifts of baked joints (baked_joint.h) at the vertices of a preview lattice. Each joint is sampled there once, at
// all its baked angles, so that a pose adds up a few vectors for each vertex near a joint.
#pragma once

#include <vector>

#include "core/deform/baked_flesh.h"
#include "core/deform/preview_lattice.h"

namespace limber {

class PreviewShifts {
 public:
  // Sets the joints and their turns. Returns whether the shift of any vertex may have changed.
  //   throws Error when a joint was baked from a larger volume
  bool set(const PreviewLattice& lattice, const std::vector<BentJoint>& joints);

  bool empty() const { return tables_.empty(); }
  // Returns the shift of a vertex, in cells along the axes of the volume.
  //   place  PreviewLattice::place(vertex)
  const glm::vec3& at(std::int64_t place) const { return shift_[place]; }
  // Returns whether the last set() may have changed the shift of a vertex.
  bool has_changed(std::int64_t place) const { return is_near_[place]; }

 private:
  struct Table {
    std::vector<std::int32_t> places;  // indices of the vertices that have shifts
    // shifts of these vertices for each baked angle, mm; empty for the angle 0
    std::vector<std::vector<glm::vec3>> by_angle;
  };
  static Table sampled(const PreviewLattice& lattice, const BakedJoint& joint);

  std::vector<BentJoint> joints_;
  std::vector<Table> tables_;     // sampled shifts of each joint
  std::vector<glm::vec3> shift_;  // shift of each vertex, by place; empty until the first joint is set
  // by place: 1 for vertices that have shifts in the current or in the previous pose
  std::vector<std::uint8_t> is_near_;
};

}  // namespace limber
