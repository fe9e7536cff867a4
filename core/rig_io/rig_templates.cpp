// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/rig_io/rig_templates.h"

#include <algorithm>

#include "core/base/asset.h"
#include "core/base/error.h"
#include "core/rig_io/rig_io.h"

namespace limber {

const std::vector<RigTemplate>& rig_templates() {
  static const std::vector<RigTemplate> templates{
      {"arm", "Arm", "shoulder to finger tips, 22 bones"},
      {"hand", "Hand", "wrist to finger tips, 20 bones"},
      {"leg", "Leg", "hip to toes, 4 bones"},
      {"adult", "Adult body", "spine, limbs, fingers and jaw, 60 bones"},
      {"child", "Child body", "spine, limbs, fingers and jaw in a child's proportions, 60 bones"},
      {"quadruped", "Quadruped", "built like a dog; fitted to an animal's skin, so check its joints by eye"},
  };
  return templates;
}

bool is_rig_template(const std::string& name) {
  return std::any_of(rig_templates().begin(), rig_templates().end(),
                     [&](const RigTemplate& t) { return t.name == name; });
}

Armature rig_template(const std::string& name) {
  if (is_rig_template(name)) return read_armature(asset("rigs/" + name + ".json"));
  std::string known;
  for (const RigTemplate& t : rig_templates()) known += (known.empty() ? "" : ", ") + t.name;
  throw Error("no such rig template", name, "choose one of " + known + ", or give a rig file");
}

}  // namespace limber
