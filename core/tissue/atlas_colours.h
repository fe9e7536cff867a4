// SPDX-License-Identifier: AGPL-3.0-or-later
// The colours that anatomy atlases use for organs: green for the gall bladder, blue for veins, dark red for liver,
// spleen and kidneys. Paired organs share a colour.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include <glm/glm.hpp>

namespace limber {

// Returns the colour, sRGB, of the organ in a row of tissues.csv; nothing if the row is not an organ.
std::optional<glm::vec3> organ_colour(std::string_view row);

// Returns the colour of veins, sRGB, if the name of a vessel means a vein: "inferior vena cava", "portal_vein". Returns
// nothing for any other name.
std::optional<glm::vec3> vein_colour(std::string name);

}  // namespace limber
