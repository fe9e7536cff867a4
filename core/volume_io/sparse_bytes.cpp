// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/volume_io/sparse_bytes.h"

#include <algorithm>
#include <cstring>

#include "core/platform/memory_pages.h"

namespace limber {

namespace {

constexpr std::size_t kBlock = 256;  // bytes; a block counts as zero only if all its bytes are zero

void append_number(std::string& text, std::size_t number) {
  const auto short_number = static_cast<std::uint32_t>(number);
  text.append(reinterpret_cast<const char*>(&short_number), sizeof short_number);
}

// Returns the position at which the run of blocks that begins at `at` ends. The run consists of blocks that are all
// zero (if `zero`) or not all zero (if not).
std::size_t end_of_blocks(std::string_view bytes, std::size_t at, bool zero) {
  while (at < bytes.size() && is_all_zero(&bytes[at], std::min(kBlock, bytes.size() - at)) == zero) at += kBlock;
  return std::min(at, bytes.size());
}

}  // namespace

void pack_sparsely(std::string_view bytes, std::string& packed) {
  for (std::size_t at = 0; at < bytes.size();) {
    const std::size_t zeros_end = end_of_blocks(bytes, at, true), end = end_of_blocks(bytes, zeros_end, false);
    append_number(packed, zeros_end - at);
    append_number(packed, end - zeros_end);
    packed.append(bytes.substr(zeros_end, end - zeros_end));
    at = end;
  }
}

bool SparseBytes::begin_span() {
  std::uint32_t numbers[2];
  if (packed_.size() - at_ < sizeof numbers) return false;
  std::memcpy(numbers, &packed_[at_], sizeof numbers);
  at_ += sizeof numbers;
  if (numbers[1] > packed_.size() - at_) return false;
  zeros_ = numbers[0];
  others_ = numbers[1];
  return true;
}

bool SparseBytes::read(char* to, std::size_t size) {
  while (size > 0) {
    if (zeros_ == 0 && others_ == 0 && !begin_span()) return false;
    const std::size_t zeros = std::min<std::size_t>(zeros_, size);
    std::memset(to, 0, zeros);
    const std::size_t others = std::min<std::size_t>(others_, size - zeros);
    std::memcpy(to + zeros, packed_.data() + at_, others);
    at_ += others;
    zeros_ -= static_cast<std::uint32_t>(zeros);
    others_ -= static_cast<std::uint32_t>(others);
    to += zeros + others;
    size -= zeros + others;
  }
  return true;
}

}  // namespace limber
