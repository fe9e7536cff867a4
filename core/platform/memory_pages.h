// SPDX-License-Identifier: AGPL-3.0-or-later
// Controls the memory pages of large vectors. For memory that will be filled completely it asks for large pages (2 MB
// instead of 4 KB), which cause one page fault instead of 512.
#pragma once

#include <cstddef>
#include <cstdint>

namespace limber {

// Asks for large pages in a range of fresh memory that will be filled. The system may ignore the request.
void want_large_pages(void* begin, std::int64_t bytes);

// Returns zeroed memory that takes physical memory only where it is written. Its size may exceed the machine's memory,
// because a body's grid may be mostly air. Returns nullptr when the system has no memory. Free the result by
// delete_zeros() with the same `bytes`.
void* new_zeros(std::size_t bytes);
void delete_zeros(void* begin, std::size_t bytes);

// Returns true if the system has room for `bytes` more of address space.
bool can_map(std::size_t bytes);

// Returns true if every byte of the memory is zero.
bool is_all_zero(const void* begin, std::size_t bytes);

}  // namespace limber
