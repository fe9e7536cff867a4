// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/motion/apply_constraints.h"

#include <cstdint>
#include <set>

#include "core/base/error.h"
#include "core/motion/constraint_stack.h"

namespace limber {

Clip with_constraints_as_keys(const std::shared_ptr<const Clip>& clip, const std::shared_ptr<const Armature>& armature,
                              int first, int last, Progress& progress) {
  const ClipOnRig on_rig(clip, armature);
  if (!on_rig.constraints()) throw Error("the clip has no constraints", clip->name, "add a constraint first");
  if (!on_rig.problem().empty())
    throw Error("the clip does not move this rig", clip->name, "match the clip's joints: " + on_rig.problem());
  std::set<int> turned;
  for (const std::size_t index : on_rig.constraints()->order())
    if (clip->constraints->list[index].on)
      turned.insert(on_rig.constraints()->turned(index).begin(), on_rig.constraints()->turned(index).end());

  Clip applied = *clip;
  applied.constraints = nullptr;
  applied.keys.weights.clear();
  applied.keys.weight_shapes.clear();
  for (const int bone : turned) {
    const std::string& name = armature->bones[bone].name;
    applied.keys.bones.erase(name);
    applied.keys.shapes.erase(name);
  }
  for (std::int64_t frame = first; frame <= last && !turned.empty(); ++frame) {
    progress.update("apply constraints", static_cast<double>(frame - first) / (std::int64_t{last} - first + 1));
    const Pose pose = on_rig.at(static_cast<int>(frame));
    for (const int bone : turned) applied.keys.bones[armature->bones[bone].name][int(frame)] = pose.rotation[bone];
  }
  return applied;
}

}  // namespace limber
