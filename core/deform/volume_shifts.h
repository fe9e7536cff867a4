// SPDX-License-Identifier: AGPL-3.0-or-later
// The shifts of nodes that give cells of flesh their volume back: the minimization of settled_flesh.h.
#pragma once

#include <vector>

#include "core/base/progress.h"
#include "core/deform/flesh_cells.h"
#include "core/deform/flesh_contact.h"
#include "core/deform/posed_bones.h"

namespace limber {

struct VolumeShifts {
  std::vector<glm::vec3> shift;              // by node, mm along the volume's axes; zero where it is fixed
  double error_before = 0, error_after = 0;  // mean |V - V0| / V0 over the tissue of all cells
};

//   bones    that flesh must not enter; nullptr: none      contact  of flesh with flesh; nullptr: none
VolumeShifts volume_shifts(const FleshCells& cells, const PosedBones* bones, FleshContact* contact, Progress& progress);

// The matrix of that determinant near F: steps along the gradient of the determinant. F may be inverted, `volume` is
// positive.
glm::dmat3 with_volume(const glm::dmat3& F, double volume);

}  // namespace limber
