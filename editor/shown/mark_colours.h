// SPDX-License-Identifier: AGPL-3.0-or-later
// Computes nearly grey colours for the tissues of a volume, so that voxels marked with a bright colour stand out.
#pragma once

#include <vector>

#include <glm/glm.hpp>
#include <glm/gtc/type_precision.hpp>

#include "core/tissue/tissue_table.h"

namespace limber::editor {

glm::u8vec3 bytes_of(const glm::vec3& srgb);
// Returns 65536 colours, one for each label: a nearly grey version of the tissue's colour.
std::vector<glm::u8vec3> dull_colours(const TissueTable& tissues);

}  // namespace limber::editor
