// SPDX-License-Identifier: AGPL-3.0-or-later
// Computes the shifts of nodes that restore the volume of flesh cells. The shifts minimise the sum in settled_flesh.h.
#pragma once

#include <vector>

#include "core/base/progress.h"
#include "core/deform/flesh_cells.h"
#include "core/deform/flesh_contact.h"
#include "core/deform/posed_bones.h"

namespace limber {

struct VolumeShifts {
  std::vector<glm::vec3> shift;  // shift of each node, mm along the volume's axes; zero for fixed nodes
  // Mean of |V / V0 - 1| over the tissue, where V0 and V are the rest volume and the posed volume of a cell.
  double error_before = 0, error_after = 0;
};

// Computes the shifts of all nodes.
//   bones    bones that flesh must not enter; nullptr: no bones
//   contact  finds flesh inside other flesh; nullptr: such flesh is not searched for
VolumeShifts volume_shifts(const FleshCells& cells, const PosedBones* bones, FleshContact* contact, Progress& progress);

// Returns a matrix near F that has the determinant `volume`, found by steps along the gradient of the determinant. F
// may be inverted; `volume` must be positive.
glm::dmat3 with_volume(const glm::dmat3& F, double volume);

// Returns F with its largest stretch (largest singular value) limited to 2, or to that of `blended` if this is larger.
// The other two stretches change together so that the determinant becomes `volume`, as far as the limit allows. So
// flesh regains its volume without excessive stretch. A matrix within the limit is returned unchanged.
//   blended  the deformation gradient that blending alone gives
glm::dmat3 with_stretch(const glm::dmat3& F, double volume, const glm::dmat3& blended);

}  // namespace limber
