// SPDX-License-Identifier: AGPL-3.0-or-later
// Bones whose weights nothing may change: neither what adds to them nor what takes its share from them. By the bones'
// names, so that a change of the rig loses only what it removed.
#pragma once

#include <set>
#include <string>

namespace limber {

struct WeightLocks {
  std::set<std::string> bones;

  bool operator==(const WeightLocks&) const = default;
};

}  // namespace limber
