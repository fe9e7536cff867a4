// SPDX-License-Identifier: AGPL-3.0-or-later
// Lists and reads the template rigs that come with the program, in assets/rigs. They are in Limber's JSON format, with
// the ranges of motion of common joints as limits [AAOS 1965]. Templates of a single limb are for the right side of the
// body; auto_fit mirrors them if needed.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/rig/armature.h"

namespace limber {

struct RigTemplate {
  std::string name;   // name on the command line, such as "adult"
  std::string label;  // name in the user interface, such as "Adult body"
  std::string about;
};

const std::vector<RigTemplate>& rig_templates();
bool is_rig_template(const std::string& name);

// Reads a template rig. Throws Error for an unknown name; the message lists the known ones.
Armature rig_template(const std::string& name);

}  // namespace limber
