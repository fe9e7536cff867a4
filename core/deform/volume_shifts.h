// SPDX-License-Identifier: AGPL-3.0-or-later
// Computes the shifts of nodes that restore the volume of flesh cells: the minimisation of settled_flesh.h.
#pragma once

#include <vector>

#include "core/base/progress.h"
#include "core/deform/flesh_cells.h"
#include "core/deform/flesh_contact.h"
#include "core/deform/posed_bones.h"

namespace limber {

struct VolumeShifts {
  std::vector<glm::vec3> shift;              // shift of each node, mm along the volume's axes; zero for fixed nodes
  double error_before = 0, error_after = 0;  // mean |V - V0| / V0 over the tissue of all cells
};

// Computes the shifts of all nodes.
//   bones    bones that flesh must not enter; nullptr: none
//   contact  contact of flesh with flesh; nullptr: none
VolumeShifts volume_shifts(const FleshCells& cells, const PosedBones* bones, FleshContact* contact, Progress& progress);

// Returns a matrix near F with the determinant `volume`, found by steps along the gradient of the determinant. F may be
// inverted; `volume` must be positive.
glm::dmat3 with_volume(const glm::dmat3& F, double volume);

}  // namespace limber
