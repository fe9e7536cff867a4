// SPDX-License-Identifier: AGPL-3.0-or-later
// Describes how much of the body a FEM mesh contains, so that the user does not take the mesh for the whole body.
#pragma once

#include <string>

#include "core/fem/tissue_model.h"
#include "core/volume/label_volume.h"

namespace limber::cmd {

// Returns a sentence that says which percentage of the body's rest volume, and how many of its tissues, the tets of the
// mesh contain.
std::string share_of_body(const TissueModel& model, const LabelVolume& body);

}  // namespace limber::cmd
