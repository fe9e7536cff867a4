// SPDX-License-Identifier: AGPL-3.0-or-later
// What the header of a volume file promises, in the terms that all formats share, and the checks that every promise
// must pass before a byte of data is believed. Parsers (nrrd_header, meta_header, nifti_header, virtual_family) turn
// header bytes into this and touch no other file; voxel_stream then delivers exactly the promised bytes or throws.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/file.h"
#include "core/tissue/tissue_table.h"
#include "core/volume/grid.h"

namespace limber {

enum class VoxelType : std::uint8_t { Int8, UInt8, Int16, UInt16, Int32, UInt32, Int64, UInt64, Float32, Float64 };

int size_of(VoxelType type);                                           // bytes
std::string_view to_string(VoxelType type);                            // "uint8" ... "float64"
std::optional<VoxelType> voxel_type_from_text(std::string_view text);  // the names above

// body(T{}) with the C++ type of a voxel.
template <class Body>
auto visit_voxel_type(VoxelType type, const Body& body) {
  switch (type) {
    case VoxelType::Int8: return body(std::int8_t{});
    case VoxelType::UInt8: return body(std::uint8_t{});
    case VoxelType::Int16: return body(std::int16_t{});
    case VoxelType::UInt16: return body(std::uint16_t{});
    case VoxelType::Int32: return body(std::int32_t{});
    case VoxelType::UInt32: return body(std::uint32_t{});
    case VoxelType::Int64: return body(std::int64_t{});
    case VoxelType::UInt64: return body(std::uint64_t{});
    case VoxelType::Float32: return body(float{});
    default: return body(double{});
  }
}

enum class Encoding : std::uint8_t { Raw, Deflate, Bzip2, Ascii, Hex };  // Deflate: gzip or zlib, told apart by content

using KeyValues = std::map<std::string, std::string, std::less<>>;

struct VolumeHeader {
  std::string format;  // as FileType::format
  VoxelType voxel_type = VoxelType::UInt8;
  Grid grid;
  Encoding encoding = Encoding::Raw;
  bool big_endian = false;
  double slope = 1, intercept = 0;  // value = slope * stored + intercept

  // Where the data are. No names: in the header's own file from `byte_skip` on. Several names share the slices evenly.
  std::vector<std::string> data_names;
  std::int64_t line_skip = 0;     // lines to pass first, in every data file
  std::int64_t byte_skip = 0;     // then bytes, before decoding; -1: the data are the last bytes of the file
  std::int64_t decoded_skip = 0;  // then bytes, after decoding
  std::optional<std::int64_t> compressed_bytes;  // as the header says, true or not

  KeyValues keys;     // NRRD's `key:=value` lines
  TissueTable named;  // what the header says of file values; labels are not yet given
  std::vector<std::string> warnings;
};

// Size, spacing and origin as a parser found them, any number of axes.
struct RawGrid {
  std::vector<std::int64_t> sizes;
  glm::dvec3 spacing{1}, origin{0};
  glm::dmat3 direction{1};
};

// The grid, when it can be believed: at least one voxel a side, at most 2^40 in all, three axes, spacing positive and
// finite, direction finite and invertible with columns of unit length. Adds a warning for axes that are not at right
// angles.
//   where  the file, for messages            throws Error naming the field
Grid checked_grid(const RawGrid& raw, const std::string& where, std::vector<std::string>& warnings);

// Throws Error unless value = slope * stored + intercept can be reckoned with: both finite, the slope not 0, neither
// beyond 1e15, and the slope no smaller than 1e-15.
void check_scale(double slope, double intercept, const std::string& where);

// A Grid whose world_from_voxel has these columns (mm), split into lengths and unit axes.
RawGrid grid_from_columns(const std::vector<std::int64_t>& sizes, const glm::dmat3& columns, const glm::dvec3& origin);

// Names made by a printf pattern with one %d (such as "slice%03d.raw") from `first` to `last`; none when the pattern is
// anything else or makes more than 65 536 names.
std::optional<std::vector<std::string>> names_of_pattern(std::string_view pattern, std::int64_t first,
                                                         std::int64_t last, std::int64_t step);

}  // namespace limber
