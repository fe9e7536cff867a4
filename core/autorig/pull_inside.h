// SPDX-License-Identifier: AGPL-3.0-or-later
// Moves a rig whose bones leave the tissue back into it, with as little change as possible. Where a bone runs through
// air, the middle of that stretch is moved to the nearest tissue, and the bone's two ends move by the shares of the
// lever rule. Bones that share a joint move it together. This is repeated until no bone leaves the tissue. A hinge that
// shares no joint with another bone, such as a jaw's, may be shifted along its axis, which does not change the rotation
// of its bone. A bone at whose tail no other bone begins is shortened to the tissue if at least half of it is inside.
#pragma once

#include <vector>

#include "core/autorig/cut_planes.h"
#include "core/rig/armature.h"
#include "core/volume/label_volume.h"

namespace limber {

// Returns the rig moved inside the tissue, or the rig with the largest share in tissue where that is not possible. No
// joint moves by more than half of its shortest bone, nor by more than 30 mm (50 mm along a free hinge's axis). Parts
// of the rig beyond a cut are not moved.
//   free  per bone, the distance by which its head may move, mm
Armature drawn_inside(const Armature& rig, const LabelVolume& volume, const std::vector<TissueCut>& cuts,
                      const std::vector<double>& free);

}  // namespace limber
