// SPDX-License-Identifier: AGPL-3.0-or-later
// A rig whose bones leave the tissue somewhere, drawn into it with as little change as will do: where a bone runs
// through air, the middle of that stretch wants to be in the nearest tissue, and the bone's two ends move by the shares
// that the lever gives them. Bones that share a joint move it together; the whole is repeated until nothing leaves. A
// hinge that shares no joint with another bone, as a jaw's, may slide along its axis, where it turns its bone just the
// same; and a bone that no other begins at the end of ends where the tissue does, if most of it is there.
#pragma once

#include <vector>

#include "core/autorig/cut_planes.h"
#include "core/rig/armature.h"
#include "core/volume/label_volume.h"

namespace limber {

//   free  per bone, mm by which its head may move
// No joint moves by more than half of its shortest bone, nor by more than 30 mm (along a free hinge's axis 50); what
// lies beyond a cut stays. Where that is not enough, the rig that came farthest in is returned.
Armature drawn_inside(const Armature& rig, const LabelVolume& volume, const std::vector<TissueCut>& cuts,
                      const std::vector<double>& free);

}  // namespace limber
