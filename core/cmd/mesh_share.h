// SPDX-License-Identifier: AGPL-3.0-or-later
// What the mesh of a solve is, so that nobody takes it for a phantom of the body.
#pragma once

#include <string>

#include "core/fem/tissue_model.h"
#include "core/volume/label_volume.h"

namespace limber::cmd {

// A sentence with the share of the body's volume at rest, and the number of its tissues, that the tets hold.
std::string share_of_body(const TissueModel& model, const LabelVolume& body);

}  // namespace limber::cmd
