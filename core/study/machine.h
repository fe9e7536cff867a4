// SPDX-License-Identifier: AGPL-3.0-or-later
// On what something was computed, for whoever compares times.
#pragma once

#include <string>

namespace limber {

// "Some CPU @ 2.50GHz, 2 cores, 16 GB, Linux 6.1"
std::string machine_text();

}  // namespace limber
