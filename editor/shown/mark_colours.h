// SPDX-License-Identifier: AGPL-3.0-or-later
// Colours of a volume in which some voxels are marked and the rest steps back.
#pragma once

#include <vector>

#include <glm/glm.hpp>
#include <glm/gtc/type_precision.hpp>

#include "core/tissue/tissue_table.h"

namespace limber::editor {

glm::u8vec3 bytes_of(const glm::vec3& srgb);
std::vector<glm::u8vec3> dull_colours(
    const TissueTable& tissues);  // [65536]: what is not marked, as bright as it is, nearly grey

}  // namespace limber::editor
