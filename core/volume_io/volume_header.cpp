// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/volume_io/volume_header.h"

#include <cmath>
#include <cstdio>

#include "core/base/error.h"
#include "core/base/text_parse.h"

namespace limber {

namespace {
constexpr std::array<std::string_view, 10> kTypeNames = {"int8",   "uint8", "int16",  "uint16",  "int32",
                                                         "uint32", "int64", "uint64", "float32", "float64"};
constexpr std::int64_t kMostVoxels = std::int64_t{1} << 40;
// Largest deviation from 1 at which the length of a direction vector is treated as 1, because headers round to 6
// digits. A larger deviation is intended: the vector's length then scales the spacing.
constexpr double kUnitTolerance = 1e-4;
// Limits of the triple product of the three voxel axes, which is 1 for axes at right angles and 0 for axes in one
// plane. At or below kFlat the axes are refused. Below 1 - kRightAngles the reader gives a warning.
constexpr double kFlat = 1e-3, kRightAngles = 1e-3;
}  // namespace

int size_of(VoxelType type) {
  constexpr std::array<int, 10> kSizes = {1, 1, 2, 2, 4, 4, 8, 8, 4, 8};
  return kSizes[static_cast<int>(type)];
}

std::string_view to_string(VoxelType type) { return kTypeNames[static_cast<int>(type)]; }

std::optional<VoxelType> voxel_type_from_text(std::string_view text) {
  for (std::size_t i = 0; i < kTypeNames.size(); ++i)
    if (kTypeNames[i] == text) return static_cast<VoxelType>(i);
  return std::nullopt;
}

RawGrid grid_from_columns(const std::vector<std::int64_t>& sizes, const glm::dmat3& columns, const glm::dvec3& origin) {
  RawGrid raw{sizes, glm::dvec3(1), origin, columns};
  for (int axis = 0; axis < 3; ++axis) {
    raw.spacing[axis] = glm::length(columns[axis]);
    if (raw.spacing[axis] > 0 && std::isfinite(raw.spacing[axis]))
      raw.direction[axis] = columns[axis] / raw.spacing[axis];
  }
  return raw;
}

Grid checked_grid(const RawGrid& raw, const std::string& where, std::vector<std::string>& warnings) {
  Grid grid{glm::ivec3(1), raw.spacing, raw.origin, raw.direction};
  std::int64_t voxels = 1;
  for (std::size_t axis = 0; axis < raw.sizes.size(); ++axis) {
    const std::int64_t size = raw.sizes[axis];
    if (size < 1)
      throw Error("axis " + std::to_string(axis + 1) + " has " + std::to_string(size) + " voxels", where,
                  "every side needs at least one voxel; export the volume again");
    if (axis >= 3)
      throw Error("the file is " + std::to_string(raw.sizes.size()) + "-D (axis " + std::to_string(axis + 1) + " has " +
                      std::to_string(size) + ")",
                  where, "export one 3-D volume");
    if (size > kMostVoxels || voxels > kMostVoxels / size)
      throw Error("the volume is too large", where,
                  "the header states more than 10^12 voxels; export the volume again");
    voxels *= size;
    if (size > std::numeric_limits<std::int32_t>::max())
      throw Error("axis " + std::to_string(axis + 1) + " has " + std::to_string(size) + " voxels", where,
                  "use a coarser spacing");
    grid.size[static_cast<int>(axis)] = static_cast<int>(size);
  }
  if (raw.sizes.empty()) throw Error("the header names no size", where, "export the volume again");

  for (int axis = 0; axis < 3; ++axis) {
    const double spacing = raw.spacing[axis];
    if (!std::isfinite(spacing) || spacing <= 0 || spacing > 1e6 || spacing < 1e-9)
      throw Error("the spacing along axis " + std::to_string(axis + 1) + " is " + text_of(spacing) + " mm", where,
                  "spacing must be positive and finite; correct the header");
    if (!std::isfinite(raw.origin[axis]) || std::abs(raw.origin[axis]) > 1e12)
      throw Error("the origin is not a finite position", where, "correct the header");
    const double length = glm::length(raw.direction[axis]);
    if (!std::isfinite(length) || length < 1e-9 || length > 1e9)
      throw Error("the direction of axis " + std::to_string(axis + 1) + " has no finite length", where,
                  "correct the header");
    if (std::abs(length - 1) > kUnitTolerance) {
      grid.spacing[axis] *= length;
      grid.direction[axis] /= length;
    }
    grid.direction[axis] += glm::dvec3(0);  // adding 0 turns -0 into 0
  }
  grid.origin += glm::dvec3(0);
  const double triple = std::abs(glm::determinant(grid.direction));
  if (!(triple > kFlat))
    throw Error("the direction cannot be inverted", where, "two axes are parallel; correct the header");
  if (triple < 1 - kRightAngles)
    warnings.push_back("the voxel axes are not at right angles: " + where + ": volumes in mm3 are off by " +
                       std::to_string(std::lround((1 - triple) * 1000) / 10.0).substr(0, 4) + " %");
  return grid;
}

void check_scale(double slope, double intercept, const std::string& where) {
  constexpr double kMost = 1e15;
  // The conditions are false for NaN, so NaN is refused too.
  const bool can_be = std::abs(slope) <= kMost && std::abs(slope) >= 1 / kMost && std::abs(intercept) <= kMost;
  if (!can_be)
    throw Error("the values are scaled by " + text_of(slope) + " and shifted by " + text_of(intercept), where,
                "no image has such values; correct the header");
}

std::optional<std::vector<std::string>> names_of_pattern(std::string_view pattern, std::int64_t first,
                                                         std::int64_t last, std::int64_t step) {
  // Accepts a pattern with only one directive such as %d, %5d or %05d. This suffices for slice numbers.
  const std::size_t percent = pattern.find('%');
  if (percent == std::string_view::npos) return std::nullopt;
  std::size_t end = percent + 1;
  const bool zeros = end < pattern.size() && pattern[end] == '0';
  int width = 0;
  while (end < pattern.size() && pattern[end] >= '0' && pattern[end] <= '9' && width < 20)
    width = width * 10 + (pattern[end++] - '0');
  if (end >= pattern.size() || (pattern[end] != 'd' && pattern[end] != 'i' && pattern[end] != 'u') || width > 20 ||
      pattern.find('%', end) != std::string_view::npos || step == 0)
    return std::nullopt;

  constexpr std::int64_t kMostNames = 65536, kLargest = std::int64_t{1} << 40;
  if (std::abs(first) > kLargest || std::abs(last) > kLargest || std::abs(step) > kLargest) return std::nullopt;
  if ((last - first) / step < 0 || (last - first) / step >= kMostNames) return std::nullopt;
  std::vector<std::string> names;
  for (std::int64_t number = first; step > 0 ? number <= last : number >= last; number += step) {
    std::string digits = std::to_string(std::abs(number));
    const int fill = width - static_cast<int>(digits.size()) - (number < 0);
    if (zeros && fill > 0) digits.insert(0, fill, '0');
    if (number < 0) digits.insert(0, 1, '-');
    if (!zeros && fill > 0) digits.insert(0, fill, ' ');
    names.push_back(std::string(pattern.substr(0, percent)) + digits + std::string(pattern.substr(end + 1)));
  }
  return names;
}

}  // namespace limber
