// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/pose/flex_request.h"

#include <charconv>
#include <cmath>

#include "core/base/error.h"

namespace limber {

namespace {
constexpr double kMostDegrees = 360;
}  // namespace

FlexRequest parse_flex_request(const std::string& request, const std::string& where) {
  const std::size_t equals = request.rfind('=');
  double degrees = 0;
  const char* end = request.data() + request.size();
  const char* begin = equals == request.npos ? end : request.data() + equals + 1;
  if (begin != end && *begin == '+') ++begin;
  const auto [stop, error] = std::from_chars(begin, end, degrees);
  const bool is_number = error == std::errc() && stop == end;
  if (equals == 0 || !is_number || !(std::abs(degrees) <= kMostDegrees))
    throw Error("this is not a value of --flex", where + " " + request,
                "write BONE=DEG from -360 to 360, as in Forearm=45");
  return {request.substr(0, equals), degrees};
}

}  // namespace limber
