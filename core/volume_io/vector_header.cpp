// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/volume_io/vector_header.h"

#include <algorithm>
#include <bit>
#include <limits>
#include <regex>

#include "core/base/error.h"
#include "core/volume_io/nrrd.h"

namespace limber {

namespace {
constexpr const char* kWhatToDo = "give a field as `limber resample --field OUT.nrrd` writes it";
constexpr std::size_t kLargestHeader = 1 << 16;  // bytes; a longer header is refused

// Parses the header of a displacement field as if it had one number per voxel instead of three. The size of the first
// axis is changed to one sample for this, since the NRRD parser ignores an axis of one sample.
VolumeHeader header_of_one_number(std::string bytes, const std::string& where) {
  const std::size_t end = std::min(bytes.find("\n\n"), bytes.find("\n\r\n"));
  static const std::regex kSizes("(^|\n)sizes:[ \t]*3[ \t]");
  std::smatch match;
  const std::string lines = bytes.substr(0, end);
  if (!std::regex_search(lines, match, kSizes))
    throw Error("the file does not hold three numbers per voxel", where, kWhatToDo);
  bytes[static_cast<std::size_t>(match.position(0) + match.length(0)) - 2] = '1';
  return parse_nrrd_header(bytes, where);
}
}  // namespace

VolumeHeader parse_vector_header(std::string bytes, const std::string& where) {
  if (!looks_like_nrrd_header(bytes)) throw Error("this is not a displacement field", where, kWhatToDo);
  bytes.resize(std::min(bytes.size(), kLargestHeader));
  VolumeHeader header = header_of_one_number(std::move(bytes), where);
  if (header.voxel_type != VoxelType::Float32)
    throw Error("the numbers of the field are of type " + std::string(to_string(header.voxel_type)), where, kWhatToDo);
  if (header.big_endian != (std::endian::native == std::endian::big))
    throw Error("the field's bytes are in the order of another machine", where, kWhatToDo);
  if (header.grid.size.x > std::numeric_limits<int>::max() / 3)
    throw Error("the field does not fit in memory", where, "use a coarser spacing or a larger machine");
  header.grid.size.x *= 3;
  return header;
}

}  // namespace limber
