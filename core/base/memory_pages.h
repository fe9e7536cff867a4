// SPDX-License-Identifier: AGPL-3.0-or-later
// The memory pages under large vectors. What will be filled whole asks for large pages: one fault where there were 512.
#pragma once

#include <cstddef>
#include <cstdint>

namespace limber {

// For a range of fresh memory that will be filled. Only a wish.
void want_large_pages(void* begin, std::int64_t bytes);

// Zeros, which take memory only where they are written. Very many need not fit into the machine's memory: a body's grid
// may be mostly air. nullptr where there is no room; `bytes` are the same for both.
void* new_zeros(std::size_t bytes);
void delete_zeros(void* begin, std::size_t bytes);

// Whether every byte is zero.
bool is_all_zero(const void* begin, std::size_t bytes);

}  // namespace limber
