// SPDX-License-Identifier: AGPL-3.0-or-later
// "Forearm=45": a bone and how far to turn it about its hinge.
#pragma once

#include <string>

namespace limber {

struct FlexRequest {
  std::string bone;
  double degrees = 0;  // from -360 to 360, positive bends further
};

// Reads BONE=DEG. A bone's name may hold an equals sign, the number follows the last one.
//   where  names the option or key in messages
//   throws Error when there is no bone, no number, or no angle that a hinge can turn by
FlexRequest parse_flex_request(const std::string& request, const std::string& where);

}  // namespace limber
