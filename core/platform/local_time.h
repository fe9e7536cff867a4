// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <ctime>

namespace limber {

// Returns the date and time of day in the user's time zone. Unlike std::localtime(), any thread may call it.
//   seconds  since 1970
std::tm local_time(std::int64_t seconds);

}  // namespace limber
