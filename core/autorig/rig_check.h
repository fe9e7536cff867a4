// SPDX-License-Identifier: AGPL-3.0-or-later
// Does a rig lie in the tissue? How much of each bone's length does, where the bones leave it, and which joints are
// outside.
#pragma once

#include <vector>

#include "core/rig/armature.h"
#include "core/volume/label_volume.h"

namespace limber {

struct RigCheck {
  struct Leaving {
    int bone = 0;
    double from = 0, to = 0;  // shares of its length
    glm::dvec3 place{0};      // the middle of that stretch, mm
  };
  struct Joint {
    int bone = 0;
    bool tail = false;
    glm::dvec3 place{0};
  };
  std::vector<double> share;     // per bone: of its length in tissue, 0 .. 1
  double whole = 0;              // of all bones' length
  std::vector<Leaving> leaving;  // stretches in air, by bone
  std::vector<Joint> outside;    // joints in air, each once: a tail before the heads that lie on it
};

// Any label but air counts; outside the grid there is none.
RigCheck check_rig(const LabelVolume& volume, const Armature& armature);

}  // namespace limber
