// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>

namespace limber {

// Bytes this process may still take, by the machine and by its control group. No promise: others take memory too.
std::int64_t available_memory();

}  // namespace limber
