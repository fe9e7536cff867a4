// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <map>
#include <string>

#include <glm/gtc/quaternion.hpp>

namespace limber::editor {

struct PoseEditing {
  bool keep_limits = true;                   // true: joints stop at their limits
  std::map<std::string, glm::dquat> copied;  // the copied pose: rotation of each bone, by the bone's name
};

}  // namespace limber::editor
