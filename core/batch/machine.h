// SPDX-License-Identifier: AGPL-3.0-or-later
// Describes the machine that computed a result, for readers who compare times.
#pragma once

#include <string>

namespace limber {

// Returns a text such as "Some CPU @ 2.50GHz, 2 cores, 16 GB, Linux 6.1".
std::string machine_text();

}  // namespace limber
