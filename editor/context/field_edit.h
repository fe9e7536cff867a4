// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <optional>
#include <string>

#include <glm/glm.hpp>

namespace limber::editor {

// The number field or the colour field that the user drags or types in. The document changes once, at the end.
struct FieldEdit {
  struct {
    std::string name;
    double value = 0;
  } number;
  std::optional<glm::vec3> colour;
};

}  // namespace limber::editor
