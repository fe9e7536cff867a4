// SPDX-License-Identifier: AGPL-3.0-or-later
// From a file's voxel values to labels of 16 bits. A value of 0 to 65 535 is its own label; any other whole number (a
// negative one, one of 32 or 64 bits) gets a label that no value of the file uses. The file's values come back from
// values(), so that they can be written as they were.
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
  enum class Problem { None, Fractional, TooLarge, TooMany };  // TooLarge: beyond 2^53, not exact as a double

  // Turns `count` stored voxels in native byte order into labels. Stops at the first voxel that is no label.
  //   returns  None, or what is wrong with the value bad_value()
  Problem decode(const void* voxels, std::size_t count, VoxelType type, double slope, double intercept, Label* labels);

  double bad_value() const { return bad_value_; }
  // Labels seen so far and their values in the file, by label. Label 0 is always air.
  std::vector<std::pair<Label, double>> values() const;

 private:
  enum : std::uint8_t { kFree, kItself, kOther };

  template <class T>
  Problem decode_whole(const T* voxels, std::size_t count, Label* labels);
  template <class T>
  Problem decode_real(const T* voxels, std::size_t count, double slope, double intercept, Label* labels);
  Problem assign(std::int64_t value, Label& label);

  std::array<std::uint8_t, 65536> use_{};
  std::unordered_map<std::int64_t, Label> label_of_;  // of values that are not their own label
  std::int64_t next_free_ = 65535;
  double bad_value_ = 0;
};

// Swaps the bytes of `count` voxels of `size` bytes in place.
void swap_bytes(void* voxels, std::size_t count, int size);

}  // namespace limber
