// SPDX-License-Identifier: AGPL-3.0-or-later
// Checks whether a rig lies in the tissue: which share of each bone's length lies in tissue, where bones leave it, and
// which joints lie outside.
#pragma once

#include <vector>

#include "core/rig/armature.h"
#include "core/volume/label_volume.h"

namespace limber {

struct RigCheck {
  struct Leaving {
    int bone = 0;
    double from = 0, to = 0;  // begin and end of a stretch of the bone in air, as shares of the bone's length
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
  // Ends of bones that lie in air, each position once. Where a tail and heads coincide, only the tail is listed.
  std::vector<Joint> outside;
};

// Checks where a rig lies in tissue. Every label but air counts as tissue; outside the grid there is no tissue.
RigCheck check_rig(const LabelVolume& volume, const Armature& armature);

}  // namespace limber
