// SPDX-License-Identifier: AGPL-3.0-or-later
// Decides which labels replace a removed label: those of the surrounding voxels. The voxels are filled from their
// border inwards, layer by layer. In each layer a voxel gets the most frequent label among those of its 26 neighbours
// that kept their label or were filled in an earlier layer; air counts as a label. On a tie, the label with more
// neighbours that share a face wins, then the smaller label. So the result does not depend on the order of the voxels.
#pragma once

#include <cstdint>
#include <vector>

#include "core/label_edit/label_change.h"

namespace limber {

// The labels that replace those of erased voxels.
enum class Erased {
  Surroundings,  // the labels of the surrounding voxels
  Air,
};

// Returns the change that gives voxels, which all have the label `label`, the labels that surround them. Voxels of the
// same label that are not in the list do not count as surroundings. Connected groups of voxels that touch no other
// label become air.
//   voxels  indices in the volume, ascending
LabelChange filled_from_around(const LabelVolume& volume, const std::vector<std::int64_t>& voxels, Label label);

// Returns the change that erases the voxels, which all have the label `label`.
LabelChange erased_voxels(const LabelVolume& volume, const std::vector<std::int64_t>& voxels, Label label,
                          Erased erased);

}  // namespace limber
