// SPDX-License-Identifier: AGPL-3.0-or-later
// Packs bytes of which many are zero, since most voxels of a body's grid are air. The packed bytes are a list of spans.
// Each span has the number of zeros, the number of other bytes that follow, and these other bytes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>

namespace limber {

// Appends the packed bytes to `packed`. `bytes` must be shorter than 4 GB.
void pack_sparsely(std::string_view bytes, std::string& packed);

// Unpacks bytes piece by piece. The packed bytes need not be valid.
class SparseBytes {
 public:
  SparseBytes() = default;
  //   packed  holds the packed bytes from position `first` on
  explicit SparseBytes(std::string packed, std::size_t first = 0) : packed_(std::move(packed)), at_(first) {}

  // Unpacks the next `size` bytes into `to`. Returns false if the packed bytes hold fewer, or are damaged.
  [[nodiscard]] bool read(char* to, std::size_t size);
  // Returns whether all bytes are unpacked.
  bool is_done() const { return at_ == packed_.size() && zeros_ == 0 && others_ == 0; }

 private:
  bool begin_span();

  std::string packed_;
  std::size_t at_ = 0;                    // position in packed_ of the next byte to read
  std::uint32_t zeros_ = 0, others_ = 0;  // bytes of the current span that are not unpacked yet
};

}  // namespace limber
