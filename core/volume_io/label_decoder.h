// SPDX-License-Identifier: AGPL-3.0-or-later
// Converts a file's voxel values to 16-bit labels. A value from 0 to 65 535 is its own label, unless that label was
// given to another value before. Any other whole number (negative or above 65 535) gets the highest label that is not
// used yet. values() returns the file's values, so that they can be written back unchanged.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <unordered_map>
#include <vector>

#include "core/volume/label_volume.h"
#include "core/volume_io/volume_header.h"

namespace limber {

class LabelDecoder {
 public:
  enum class Problem { None, Fractional, TooLarge, TooMany };  // TooLarge: above 2^53, where doubles are not exact

  // Converts `count` stored voxels in native byte order to labels. Stops at the first voxel whose value cannot be a
  // label; bad_value() then returns this value.
  //   returns  None, or the reason for which the value cannot be a label
  Problem decode(const void* voxels, std::size_t count, VoxelType type, double slope, double intercept, Label* labels);

  double bad_value() const { return bad_value_; }
  // Returns the labels seen so far and their values in the file, sorted by label. Label 0 is always air.
  std::vector<std::pair<Label, double>> values() const;

 private:
  enum : std::uint8_t { kFree, kItself, kOther };

  template <class T>
  Problem decode_whole(const T* voxels, std::size_t count, Label* labels);
  template <class T>
  Problem decode_real(const T* voxels, std::size_t count, double slope, double intercept, Label* labels);
  Problem assign(std::int64_t value, Label& label);

  std::array<std::uint8_t, 65536> use_{};
  std::unordered_map<std::int64_t, Label> label_of_;  // labels of all values that are not their own label
  std::int64_t next_free_ = 65535;
  double bad_value_ = 0;
};

// Swaps the bytes of `count` voxels of `size` bytes in place.
void swap_bytes(void* voxels, std::size_t count, int size);

}  // namespace limber
