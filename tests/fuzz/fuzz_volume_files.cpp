// SPDX-License-Identifier: AGPL-3.0-or-later
// Fuzzes the readers of volume files with header and data: a file is read within libFuzzer's memory limit, or refused
// with Error.
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include <unistd.h>

#include "core/base/error.h"
#include "core/seams/seams_io.h"
#include "core/volume_io/vector_volume_io.h"
#include "core/volume_io/volume_io.h"

// Returns a bar of 4 x 3 x 2 voxels, all tissue but one. A file may hold seams that fit it.
static const limber::LabelVolume& body() {
  static const limber::LabelVolume volume = [] {
    limber::LabelVolume made;
    made.grid.size = {4, 3, 2};
    made.voxels.assign(made.grid.voxel_count(), 1);
    made.voxels[5] = 0;
    return made;
  }();
  return volume;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const limber::Path folder = [] {
    const auto path = std::filesystem::temp_directory_path() / ("limber-fuzz-" + std::to_string(::getpid()));
    std::filesystem::create_directories(path);
    return path;
  }();
  for (const char* name : {"a.nrrd", "a.nii", "a.vti"}) {
    const limber::Path path = folder / name;
    std::ofstream(path, std::ios::binary)
        .write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(size));
    try {
      limber::summarize_volume(path);
      limber::read_volume(path);
    } catch (const limber::Error&) {
    }
    try {
      const limber::Seams seams = limber::read_seams(path, body());
      seams.for_each([](const glm::ivec3& lower, int axis) {
        glm::ivec3 above = lower;
        ++above[axis];
        if (!body().at(lower) || !body().at_or_air(above)) std::abort();
      });
    } catch (const limber::Error&) {
    }
    try {
      limber::read_vector_volume(path);
    } catch (const limber::Error&) {
    }
  }
  return 0;
}
