// SPDX-License-Identifier: AGPL-3.0-or-later
// The rigs that come with the program, in assets/rigs: our own JSON, with the ranges of motion of the common joints as
// limits [AAOS 1965]. Limbs are right ones; auto_fit turns them into left ones where it has to.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/rig/armature.h"

namespace limber {

struct RigTemplate {
  std::string name;   // "adult", as the command line says it
  std::string label;  // "Adult body"
  std::string about;
};

const std::vector<RigTemplate>& rig_templates();
bool is_rig_template(const std::string& name);

// Throws Error for a name that is none of them, and names those there are.
Armature rig_template(const std::string& name);

}  // namespace limber
