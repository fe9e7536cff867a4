// SPDX-License-Identifier: AGPL-3.0-or-later
// Checks whether a rig lies in the tissue: how much of each bone's length does, where bones leave the tissue, and which
// joints lie outside.
#pragma once

#include <vector>

#include "core/rig/armature.h"
#include "core/volume/label_volume.h"

namespace limber {

struct RigCheck {
  struct Leaving {
    int bone = 0;
    double from = 0, to = 0;  // begin and end of the bone's stretch in air, as shares of the bone's length
    glm::dvec3 place{0};      // middle of the stretch in air, mm
  };
  struct Joint {
    int bone = 0;
    bool tail = false;
    glm::dvec3 place{0};
  };
  std::vector<double> share;     // per bone, the share of its length in tissue, [0, 1]
  double whole = 0;              // share of all bones' length in tissue, [0, 1]
  std::vector<Leaving> leaving;  // stretches of bones in air, in the order of bones
  // Joints in air, each position once. Where a tail and heads coincide, only the tail is listed.
  std::vector<Joint> outside;
};

// Checks a rig. Every label but air counts as tissue; outside the grid there is none.
RigCheck check_rig(const LabelVolume& volume, const Armature& armature);

}  // namespace limber
