// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/volume/vector_volume_io.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <regex>

#include "core/base/error.h"
#include "core/base/memory.h"
#include "core/volume/nrrd_header.h"
#include "core/volume/voxel_stream.h"

namespace limber {

namespace {
constexpr const char* kWhatToDo = "give a field as `limber resample --field OUT.nrrd` writes it";
constexpr std::size_t kLargestHeader = 1 << 16;  // bytes
constexpr std::size_t kChunk = 1 << 12;          // voxels

std::string first_bytes(const Path& path) {
  const PlainFile file(path);
  std::string bytes(std::min<std::size_t>(kLargestHeader, static_cast<std::size_t>(file.size())), '\0');
  bytes.resize(file.read_at(0, bytes.data(), bytes.size()));
  return bytes;
}

// The header of a vector field as that of a volume with one number a voxel: its first axis, of three samples, becomes
// one of a single sample, which the parser passes over.
VolumeHeader header_of_one_number(std::string bytes, const std::string& where) {
  if (!looks_like_nrrd_header(bytes)) throw Error("this is no displacement field", where, kWhatToDo);
  const std::size_t end = std::min(bytes.find("\n\n"), bytes.find("\n\r\n"));
  static const std::regex kSizes("(^|\n)sizes:[ \t]*3[ \t]");
  std::smatch match;
  const std::string lines = bytes.substr(0, end);
  if (!std::regex_search(lines, match, kSizes))
    throw Error("the file does not hold three numbers a voxel", where, kWhatToDo);
  bytes[static_cast<std::size_t>(match.position(0) + match.length(0)) - 2] = '1';
  VolumeHeader header = parse_nrrd_header(bytes, where);
  if (header.voxel_type != VoxelType::Float32)
    throw Error("the numbers of the field are of type " + std::string(to_string(header.voxel_type)), where, kWhatToDo);
  if (header.big_endian != (std::endian::native == std::endian::big))
    throw Error("the field's bytes are in the order of another machine", where, kWhatToDo);
  return header;
}
}  // namespace

VectorVolume read_vector_volume(const Path& path) {
  VolumeHeader header = header_of_one_number(first_bytes(path), path.string());
  VectorVolume field{header.grid, {}, header.warnings};
  const auto count = static_cast<std::size_t>(field.grid.voxel_count());
  if (header.grid.size.x > std::numeric_limits<int>::max() / 3 ||
      double(count) * sizeof(glm::vec3) > 0.9 * double(available_memory()))
    throw Error("the field does not fit in memory", path.string(), "use a coarser spacing or a larger machine");
  header.grid.size.x *= 3;  // of the numbers in the file
  VoxelStream stream(path, header);
  field.voxels.resize(count);
  const auto said = header.keys.find(kFieldDirectionKey);
  const bool to_rest = said != header.keys.end() && said->second == kToRest;
  if (said != header.keys.end() && !to_rest && said->second != kToPosed)
    throw Error("the field points " + said->second.substr(0, 40), path.string(), std::string("its key ") + kFieldDirectionKey + " says " + kToPosed + " or " + kToRest);
  std::vector<glm::vec3> chunk(kChunk);
  for (std::size_t first = 0; first < count; first += kChunk) {
    const std::size_t some = std::min(kChunk, count - first);
    stream.read(chunk.data(), some * sizeof(glm::vec3));
    for (std::size_t i = 0; i < some; ++i)
      if (!std::isfinite(chunk[i].x) || !std::isfinite(chunk[i].y) || !std::isfinite(chunk[i].z))
        throw Error("the field has a displacement that is no number", path.string(), kWhatToDo);
    if (to_rest)
      for (std::size_t i = 0; i < some; ++i) chunk[i] = glm::vec3(0) - chunk[i];
    // Air is never written, and takes no memory.
    if (std::any_of(chunk.begin(), chunk.begin() + std::ptrdiff_t(some),
                    [](const glm::vec3& v) { return v != glm::vec3(0); }))
      std::copy_n(chunk.begin(), some, field.voxels.begin() + first);
  }
  for (const std::string& warning : stream.finish()) field.warnings.push_back(warning);
  return field;
}

}  // namespace limber
