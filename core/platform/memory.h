// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>

namespace limber {

// Returns how many bytes this process may still allocate: the smaller of the machine's free memory and what remains
// below the limit of the process's control group. It is an estimate, because other processes allocate memory too.
std::int64_t available_memory();

}  // namespace limber
