// SPDX-License-Identifier: AGPL-3.0-or-later
// Fuzzes the import of a DICOM series, with images whose elements are arbitrary: they become a volume with a valid grid
// and all of its voxels, or are refused with Error. GDCM itself is not fuzzed: it ends its process on some damaged
// files, so the program runs it in a separate one. The two functions through which the program calls GDCM are replaced
// by functions that read a plain list of elements. An image is the number of its elements, then for each group and
// element (4 bytes), length (1 byte) and bytes; then its pixels.
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <memory>
#include <string>
#include <vector>

#include <dlfcn.h>
#include <unistd.h>

#include "core/base/error.h"
#include "core/platform/module.h"
#include "core/volume_io/dicom.h"
#include "core/volume_io/dicom_codec.h"

namespace {
constexpr std::size_t kMostImages = 4;

struct Image {
  std::string bytes;
  std::size_t at = 0;
  explicit Image(const LimberDicomFile& file) : bytes(static_cast<std::size_t>(file.size), '\0') {
    bytes.resize(file.read_at(file.context, 0, bytes.data(), bytes.size()));
  }
  std::string_view take(std::size_t size) {
    const std::string_view part = std::string_view(bytes).substr(at, size);
    at += part.size();
    return part;
  }
  std::size_t byte() {
    const std::string_view one = take(1);
    return one.empty() ? 0 : static_cast<unsigned char>(one[0]);
  }
};
}  // namespace

// Replaces the function of the module that calls GDCM.
extern "C" int limber_dicom_elements(const LimberDicomFile* file, LimberDicomElement visit, void* context) {
  Image image(*file);
  for (std::size_t left = image.byte(); left > 0; --left) {
    const std::size_t group = image.byte() << 8 | image.byte(), element = image.byte() << 8 | image.byte();
    const std::string_view value = image.take(image.byte());
    visit(context, static_cast<std::uint16_t>(group), static_cast<std::uint16_t>(element), value.data(), value.size());
  }
  return 0;
}

extern "C" int limber_dicom_pixels(const LimberDicomFile* file, char* pixels, std::size_t size) {
  const Image image(*file);
  for (std::size_t i = 0; i < size; ++i) pixels[i] = image.bytes[i % image.bytes.size()];
  return 0;
}

namespace limber {
void* open_module(const std::string&) { return ::dlopen(nullptr, RTLD_NOW); }
void* symbol_of(void* module, const char* name) { return ::dlsym(module, name); }
std::optional<Path> find_own_program(const std::string&) { return std::nullopt; }
std::optional<Path> find_program(const std::string&) { return std::nullopt; }
}  // namespace limber

// The input is a sequence of images. Each image is preceded by its length (two bytes).
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace limber;
  static const Path folder = [] {
    const auto path = std::filesystem::temp_directory_path() / ("fuzz-dicom-" + std::to_string(::getpid()));
    std::filesystem::create_directories(path);
    return path;
  }();
  VolumeLocation location{folder, true, {}};
  for (std::size_t at = 0; at + 2 < size && location.headers.size() < kMostImages;) {
    const std::size_t length = std::min<std::size_t>(data[at] | data[at + 1] << 8, size - at - 2);
    location.headers.push_back(folder / std::to_string(location.headers.size()));
    std::ofstream(location.headers.back(), std::ios::binary)
        .write(reinterpret_cast<const char*>(data) + at + 2, static_cast<std::streamsize>(length));
    at += 2 + length;
  }
  if (location.headers.empty()) return 0;
  try {
    const OpenedVolume opened = open_dicom(std::make_shared<LocalFiles>(location));
    const Grid& grid = opened.header.grid;
    for (int axis = 0; axis < 3; ++axis)
      if (!(grid.spacing[axis] > 0) || !std::isfinite(grid.spacing[axis]) || !std::isfinite(grid.origin[axis]))
        std::abort();
    std::vector<char> slice(static_cast<std::size_t>(grid.size.x) * grid.size.y * size_of(opened.header.voxel_type));
    for (int z = 0; z < grid.size.z; ++z) opened.voxels->read(slice.data(), slice.size());
    opened.voxels->finish();
  } catch (const Error&) {
  }
  return 0;
}
