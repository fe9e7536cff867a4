// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/platform/local_time.h"

namespace limber {

std::tm local_time(std::int64_t seconds) {
  const std::time_t time = seconds;
  std::tm local{};
  ::localtime_r(&time, &local);
  return local;
}

}  // namespace limber
