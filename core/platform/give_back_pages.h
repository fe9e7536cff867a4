// SPDX-License-Identifier: AGPL-3.0-or-later
// Returns memory pages to the system before the vector that owns them is deleted.
#pragma once

#include <cstdint>

namespace limber {

// Releases the physical memory of the pages that are completely inside a range from new_zeros(). Their values are then
// undefined.
void give_back_pages(void* begin, std::int64_t bytes);

}  // namespace limber
