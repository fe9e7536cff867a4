// SPDX-License-Identifier: AGPL-3.0-or-later
// The colours that anatomy atlases give organs: green for the gall bladder, blue for veins, dark red for liver, spleen
// and kidneys. Paired organs share a colour.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include <glm/glm.hpp>

namespace limber {

// Returns the colour, sRGB, of the organ that a row of tissues.csv describes; nothing if the row is no organ's.
std::optional<glm::vec3> organ_colour(std::string_view row);

// Returns the colour of veins, sRGB, if the name of a vessel is that of a vein: "inferior vena cava", "portal_vein".
std::optional<glm::vec3> vein_colour(std::string name);

}  // namespace limber
