// SPDX-License-Identifier: AGPL-3.0-or-later
// Corrections that are added to blended tissue, as shifts of the corners of its voxels: those that restore the volume
// of flesh (settled_flesh.h), and those of baked joints (baked_flesh.h). Shifts are in voxels along the axes of the
// posed volume. A corner has one shift, whichever brick asks for it, so that posed cells leave no gap.
#pragma once

#include <array>
#include <cstdint>

#include <glm/glm.hpp>

namespace limber {

class FleshShifts {
 public:
  virtual ~FleshShifts() = default;

  // The shifts of the 9^3 corners of a brick's voxels, in the order of PosedLattice::Corners.
  using CornerShifts = std::array<glm::vec3, 729>;
  // Computes the corner shifts of a brick. Returns whether it has any; if not, `shifts` is not written.
  virtual bool corner_shifts(std::int64_t brick, CornerShifts& shifts) const = 0;
  // Returns the shift of one corner of a voxel near a seam.
  //   lowest  the lowest of the eight voxels around the corner
  //   around  one bit for each of the eight voxels around the corner, x fastest: 1 if the voxel's cell contributes to
  //           the shift; not 0
  virtual glm::vec3 corner_shift(const glm::ivec3& lowest, unsigned around) const = 0;
  // Returns whether the shifts bend the tissue of a brick even if all of it follows one bone.
  virtual bool bends(std::int64_t brick) const = 0;
};

}  // namespace limber
