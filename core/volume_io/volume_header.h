// SPDX-License-Identifier: AGPL-3.0-or-later
// The header of a volume file in terms that all formats share, and the checks that it must pass before any data are
// read. The parsers (nrrd, metaimage, nifti, virtual_family, vti) convert a header's bytes to a VolumeHeader and read
// no other file. Then voxel_stream reads exactly the bytes that the header promises, or throws.
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

int size_of(VoxelType type);  // returns the size of a voxel in bytes
// Returns the name of the type: "uint8" ... "float64".
std::string_view to_string(VoxelType type);
// Inverse of to_string(); nothing for any other text.
std::optional<VoxelType> voxel_type_from_text(std::string_view text);

// Calls body(T{}), where T is the C++ type of a voxel, and returns its result.
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

// Encoding of the voxel data. Deflate means gzip or zlib; the first byte of the data tells which.
enum class Encoding : std::uint8_t { Raw, Deflate, Bzip2, Ascii, Hex };

using KeyValues = std::map<std::string, std::string, std::less<>>;

struct VolumeHeader {
  std::string format;  // name of the format, see FileType::format
  VoxelType voxel_type = VoxelType::UInt8;
  Grid grid;
  Encoding encoding = Encoding::Raw;
  bool big_endian = false;
  double slope = 1, intercept = 0;  // a voxel's value is slope * stored + intercept

  // Names of the files with the voxel data. If there are none, the data are in the header's own file, from `byte_skip`
  // on. If there are several, each file has the same number of slices.
  std::vector<std::string> data_names;
  std::int64_t line_skip = 0;     // lines to skip first, in each data file
  std::int64_t byte_skip = 0;     // bytes to skip next, before decoding; -1: the data are the file's last bytes
  std::int64_t decoded_skip = 0;  // bytes to skip after decoding, before the first voxel
  std::optional<std::int64_t> compressed_bytes;  // size that the header states, possibly wrong

  KeyValues keys;     // keys and values of an NRRD header's lines `key:=value`
  TissueTable named;  // names and colours of voxel values according to the header; Tissue::label is not set
  std::vector<std::string> warnings;
};

// A grid as a parser has read it, before any check. It can have any number of axes. Spacing and origin are in mm.
struct RawGrid {
  std::vector<std::int64_t> sizes;
  glm::dvec3 spacing{1}, origin{0};
  glm::dmat3 direction{1};
};

// Checks a grid and returns it. The grid must have at least one voxel along each axis, at most 2^40 voxels, at most
// three axes with more than one voxel, a positive finite spacing, and a finite invertible direction. When a column of
// the direction is not of unit length, its length scales the spacing. Adds a warning when the axes are not at right
// angles. Throws an Error that names the wrong field.
//   where  the file, for messages
Grid checked_grid(const RawGrid& raw, const std::string& where, std::vector<std::string>& warnings);

// Throws Error unless value = slope * stored + intercept can be computed reliably: |slope| must lie in [1e-15, 1e15],
// and |intercept| must be at most 1e15.
void check_scale(double slope, double intercept, const std::string& where);

// Returns a grid. The columns of `columns` are the steps from voxel to voxel along the grid's axes, mm: their lengths
// become the spacing, their directions the direction.
RawGrid grid_from_columns(const std::vector<std::int64_t>& sizes, const glm::dmat3& columns, const glm::dvec3& origin);

// Returns the file names that a printf pattern with one %d (such as "slice%03d.raw") yields for the numbers `first`,
// `first` + `step` and so on to `last`. Returns nothing for any other pattern and for more than 65 536 names.
std::optional<std::vector<std::string>> names_of_pattern(std::string_view pattern, std::int64_t first,
                                                         std::int64_t last, std::int64_t step);

}  // namespace limber
