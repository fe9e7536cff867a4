// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/volume_io/vector_volume_io.h"

#include <algorithm>
#include <cmath>

#include "core/base/error.h"
#include "core/platform/memory.h"
#include "core/volume_io/voxel_source.h"

namespace limber {

namespace {
constexpr const char* kWhatToDo = "give a field as `limber resample --field OUT.nrrd` writes it";
constexpr std::size_t kChunk = 1 << 12;  // number of voxels that are read at a time
}  // namespace

VectorVolume read_vector_volume(const Path& path) {
  const OpenedVolume opened = open_volume(path, no_progress(), Holding::Vectors);
  const VolumeHeader& header = opened.header;
  VectorVolume field{header.grid, {}, header.warnings};
  field.grid.size.x /= 3;
  const auto count = static_cast<std::size_t>(field.grid.voxel_count());
  if (double(count) * sizeof(glm::vec3) > 0.9 * double(available_memory()))
    throw Error("the field does not fit in memory", path.string(), "use a coarser spacing or a larger machine");
  field.voxels.resize(count);
  const auto said = header.keys.find(kFieldDirectionKey);
  const bool to_rest = said != header.keys.end() && said->second == kToRest;
  if (said != header.keys.end() && !to_rest && said->second != kToPosed)
    throw Error("the direction of the field is " + said->second.substr(0, 40), path.string(),
                std::string("the key ") + kFieldDirectionKey + " must be " + kToPosed + " or " + kToRest);
  std::vector<glm::vec3> chunk(kChunk);
  for (std::size_t first = 0; first < count; first += kChunk) {
    const std::size_t some = std::min(kChunk, count - first);
    opened.voxels->read(chunk.data(), some * sizeof(glm::vec3));
    for (std::size_t i = 0; i < some; ++i)
      if (!std::isfinite(chunk[i].x) || !std::isfinite(chunk[i].y) || !std::isfinite(chunk[i].z))
        throw Error("the field has a displacement that is not a number", path.string(), kWhatToDo);
    if (to_rest)
      for (std::size_t i = 0; i < some; ++i) chunk[i] = glm::vec3(0) - chunk[i];
    // A chunk of zeros (air) is not copied into the field: memory that is never written stays zero and takes no space.
    if (std::any_of(chunk.begin(), chunk.begin() + std::ptrdiff_t(some),
                    [](const glm::vec3& v) { return v != glm::vec3(0); }))
      std::copy_n(chunk.begin(), some, field.voxels.begin() + first);
  }
  for (const std::string& warning : opened.voxels->finish()) field.warnings.push_back(warning);
  return field;
}

}  // namespace limber
