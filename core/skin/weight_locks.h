// SPDX-License-Identifier: AGPL-3.0-or-later
// The locked bones. No edit may change the weights of a locked bone, neither directly nor by normalization. Bones are
// stored by name, so that a change of the rig loses only the locks of removed bones.
#pragma once

#include <set>
#include <string>

namespace limber {

struct WeightLocks {
  std::set<std::string> bones;

  bool operator==(const WeightLocks&) const = default;
};

}  // namespace limber
