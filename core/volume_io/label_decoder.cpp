// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/volume_io/label_decoder.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <type_traits>

namespace limber {

namespace {
constexpr std::int64_t kLargestExact = std::int64_t{1} << 53;
// Rounding tolerance of scaled voxel values, relative to the value. A scaled value this close to a whole number counts
// as that whole number, since slope * stored is rounded.
constexpr double kScaledTolerance = 1e-6;

template <class Word>
void swap_words(void* voxels, std::size_t count) {
  auto* bytes = static_cast<unsigned char*>(voxels);
  for (std::size_t i = 0; i < count; ++i) {
    Word word;
    std::memcpy(&word, bytes + i * sizeof(Word), sizeof(Word));
    if constexpr (sizeof(Word) == 2) word = __builtin_bswap16(word);
    if constexpr (sizeof(Word) == 4) word = __builtin_bswap32(word);
    if constexpr (sizeof(Word) == 8) word = __builtin_bswap64(word);
    std::memcpy(bytes + i * sizeof(Word), &word, sizeof(Word));
  }
}
}  // namespace

void swap_bytes(void* voxels, std::size_t count, int size) {
  if (size == 2) swap_words<std::uint16_t>(voxels, count);
  if (size == 4) swap_words<std::uint32_t>(voxels, count);
  if (size == 8) swap_words<std::uint64_t>(voxels, count);
}

// Finds the label for a voxel value of the file and writes it to `label`: the value itself when possible, else the
// label that the value got earlier, else the highest label that is still unused. Returns TooMany when no label is
// unused.
LabelDecoder::Problem LabelDecoder::assign(std::int64_t value, Label& label) {
  if (value >= 0 && value <= 65535 && use_[value] != kOther) {
    use_[value] = kItself;
    label = static_cast<Label>(value);
    return Problem::None;
  }
  if (const auto known = label_of_.find(value); known != label_of_.end()) {
    label = known->second;
    return Problem::None;
  }
  while (next_free_ > 0 && use_[next_free_] != kFree) --next_free_;
  if (next_free_ == 0) {
    bad_value_ = static_cast<double>(value);
    return Problem::TooMany;
  }
  use_[next_free_] = kOther;
  label = static_cast<Label>(next_free_);
  label_of_.emplace(value, label);
  return Problem::None;
}

template <class T>
LabelDecoder::Problem LabelDecoder::decode_whole(const T* voxels, std::size_t count, Label* labels) {
  if constexpr (std::is_unsigned_v<T> && sizeof(T) <= 2) {
    // Every value of this voxel type is a valid label, so each value is its own label.
    for (std::size_t i = 0; i < count; ++i) {
      labels[i] = voxels[i];
      use_[voxels[i]] = kItself;
    }
  } else {
    T previous = 0;
    Label label = 0;
    use_[0] = kItself;
    for (std::size_t i = 0; i < count; ++i) {
      const T value = voxels[i];
      if (value != previous) {
        if constexpr (sizeof(T) == 8) {
          if (value > static_cast<T>(kLargestExact) ||
              (std::is_signed_v<T> && static_cast<std::int64_t>(value) < -kLargestExact)) {
            bad_value_ = static_cast<double>(value);
            return Problem::TooLarge;
          }
        }
        if (const auto problem = assign(static_cast<std::int64_t>(value), label); problem != Problem::None)
          return problem;
        previous = value;
      }
      labels[i] = label;
    }
  }
  return Problem::None;
}

template <class T>
LabelDecoder::Problem LabelDecoder::decode_real(const T* voxels, std::size_t count, double slope, double intercept,
                                                Label* labels) {
  const bool scaled = slope != 1 || intercept != 0;
  double previous = 0;
  Label label = 0;
  use_[0] = kItself;
  for (std::size_t i = 0; i < count; ++i) {
    double value = static_cast<double>(voxels[i]);
    if (scaled) {
      value = value * slope + intercept;
      const double whole = std::nearbyint(value);
      if (std::abs(value - whole) <= kScaledTolerance * std::max(1.0, std::abs(whole))) value = whole;
    }
    if (value != previous) {  // NaN differs from every value, so it is always checked
      const bool whole = value == std::floor(value) && std::isfinite(value);
      if (!whole || std::abs(value) > static_cast<double>(kLargestExact)) {
        bad_value_ = value;
        return whole ? Problem::TooLarge : Problem::Fractional;
      }
      if (const auto problem = assign(static_cast<std::int64_t>(value), label); problem != Problem::None)
        return problem;
      previous = value;
    }
    labels[i] = label;
  }
  return Problem::None;
}

LabelDecoder::Problem LabelDecoder::decode(const void* voxels, std::size_t count, VoxelType type, double slope,
                                           double intercept, Label* labels) {
  const auto as = [&]<class T>(T) {
    if constexpr (std::is_integral_v<T>)
      if (slope == 1 && intercept == 0) return decode_whole(static_cast<const T*>(voxels), count, labels);
    return decode_real(static_cast<const T*>(voxels), count, slope, intercept, labels);
  };
  return visit_voxel_type(type, as);
}

std::vector<std::pair<Label, double>> LabelDecoder::values() const {
  std::vector<std::pair<Label, double>> values;
  for (int label = 0; label <= 65535; ++label)
    if (use_[label] == kItself) values.emplace_back(static_cast<Label>(label), label);
  for (const auto& [value, label] : label_of_) values.emplace_back(label, static_cast<double>(value));
  std::sort(values.begin(), values.end());
  return values;
}

}  // namespace limber
