// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/shown/mark_colours.h"

namespace limber::editor {

namespace {

// Returns a nearly grey version of a colour, with similar brightness.
glm::vec3 dulled(const glm::vec3& colour) {
  const float light = glm::dot(colour, glm::vec3(0.2126f, 0.7152f, 0.0722f));
  return glm::mix(glm::vec3(0.25f + 0.45f * light), colour, 0.18f);
}

}  // namespace

glm::u8vec3 bytes_of(const glm::vec3& srgb) { return glm::u8vec3(glm::round(srgb * 255.0f)); }

std::vector<glm::u8vec3> dull_colours(const TissueTable& tissues) {
  std::vector<glm::u8vec3> dull(65536, bytes_of(dulled(glm::vec3(0.7f))));
  for (const Tissue& tissue : tissues.tissues) dull[tissue.label] = bytes_of(dulled(tissue.colour));
  return dull;
}

}  // namespace limber::editor
