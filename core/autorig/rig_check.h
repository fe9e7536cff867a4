// SPDX-License-Identifier: AGPL-3.0-or-later
// Checks whether a rig is in the tissue: the share of each bone's length in tissue, where bones leave the tissue, and
// which joints are outside.
#pragma once

#include <vector>

#include "core/rig/armature.h"
#include "core/volume/label_volume.h"

namespace limber {

struct RigCheck {
  struct Leaving {
    int bone = 0;
    double from = 0, to = 0;  // begin and end of a part of the bone in air, as shares of the bone's length
    glm::dvec3 place{0};      // middle of the part in air, mm
  };
  struct Joint {
    int bone = 0;
    bool tail = false;
    glm::dvec3 place{0};
  };
  std::vector<double> share;     // per bone, the share of its length in tissue, [0, 1]
  double whole = 0;              // share of all bones' length in tissue, [0, 1]
  std::vector<Leaving> leaving;  // parts of bones in air, in the order of the bones
  // Ends of bones in air, each position once. If a tail and heads coincide, only the tail is listed.
  std::vector<Joint> outside;
};

// Checks where a rig is in tissue. Every label but air counts as tissue; outside the grid there is no tissue.
RigCheck check_rig(const LabelVolume& volume, const Armature& armature);

}  // namespace limber
