// SPDX-License-Identifier: AGPL-3.0-or-later
// Reads requests such as "Forearm=45": the name of a bone, and the angle in degrees by which the bone turns about its
// hinge.
#pragma once

#include <string>

namespace limber {

struct FlexRequest {
  std::string bone;
  double degrees = 0;  // angle, from -360 to 360 degrees; a positive angle bends further
};

// Reads BONE=DEG. A bone's name may contain equals signs; the number follows the last one. Throws Error if the bone's
// name or the number is missing, or for an angle beyond 360 degrees.
//   where  names the option or key in messages
FlexRequest parse_flex_request(const std::string& request, const std::string& where);

}  // namespace limber
