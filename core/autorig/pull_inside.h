// SPDX-License-Identifier: AGPL-3.0-or-later
// Moves a rig whose bones leave the tissue back into it, with as little change as possible. If a part of a bone is in
// air, the middle of this part is moved to the nearest tissue; the motion is divided between the two ends of the bone
// by the lever rule. Bones that share a joint move it together. This is repeated until no bone leaves the tissue. A
// hinge that shares no joint with another bone, such as a jaw's, may be shifted along its axis, which does not change
// the rotation of its bone. A bone at whose tail no other bone begins is shortened to the tissue if at least half of it
// is inside.
#pragma once

#include <vector>

#include "core/autorig/cut_planes.h"
#include "core/rig/armature.h"
#include "core/volume/label_volume.h"

namespace limber {

// Moves joints until the rig's bones are inside the tissue, and returns the rig. If this is impossible, returns the
// tried rig with the largest share in tissue. A joint moves by at most half the length of the shortest bone that meets
// it, and by at most 30 mm. A hinge that is no other bone's joint may move by 50 mm along its axis. Bones beyond a cut,
// where the volume ends, are not moved.
//   free  for each bone, the largest distance by which its head may move, mm
Armature drawn_inside(const Armature& rig, const LabelVolume& volume, const std::vector<TissueCut>& cuts,
                      const std::vector<double>& free);

}  // namespace limber
