// SPDX-License-Identifier: AGPL-3.0-or-later
// Gives memory back to the system before its owner is deleted.
#pragma once

#include <cstdint>

namespace limber {

// Makes the memory pages that lie completely inside a range from new_zeros() take no physical memory any more. Their
// values are undefined then.
void give_back_pages(void* begin, std::int64_t bytes);

}  // namespace limber
