// SPDX-License-Identifier: AGPL-3.0-or-later
// Says how much of the body the mesh of a solve contains, so that nobody takes the mesh for a phantom of the whole
// body.
#pragma once

#include <string>

#include "core/fem/tissue_model.h"
#include "core/volume/label_volume.h"

namespace limber::cmd {

// Returns a sentence with the percentage of the body's rest volume, and the number of its tissues, that the mesh's tets
// contain.
std::string share_of_body(const TissueModel& model, const LabelVolume& body);

}  // namespace limber::cmd
