// SPDX-License-Identifier: AGPL-3.0-or-later
// Whole volume files, header and data: read, or refused with Error, within the memory that libFuzzer is given.
#include <cstdint>
#include <filesystem>
#include <fstream>

#include <unistd.h>

#include "core/base/error.h"
#include "core/volume/vector_volume_io.h"
#include "core/volume/volume_io.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const limber::Path folder = [] {
    const auto path = std::filesystem::temp_directory_path() / ("limber-fuzz-" + std::to_string(::getpid()));
    std::filesystem::create_directories(path);
    return path;
  }();
  for (const char* name : {"a.nrrd", "a.nii"}) {
    const limber::Path path = folder / name;
    std::ofstream(path, std::ios::binary).write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(size));
    try {
      limber::summarize_volume(path);
      limber::read_volume(path);
    } catch (const limber::Error&) {
    }
    try {
      limber::read_vector_volume(path);
    } catch (const limber::Error&) {
    }
  }
  return 0;
}
