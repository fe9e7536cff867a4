// SPDX-License-Identifier: AGPL-3.0-or-later
// Fuzzes the parsers of volume headers: a parser returns a grid that passed every check, or throws Error.
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "core/base/error.h"
#include "core/volume_io/metaimage.h"
#include "core/volume_io/nifti.h"
#include "core/volume_io/nrrd.h"
#include "core/volume_io/virtual_family.h"

namespace {
template <class Parse>
void try_parser(const Parse& parse) {
  try {
    const limber::VolumeHeader header = parse();
    const limber::Grid& grid = header.grid;
    for (int axis = 0; axis < 3; ++axis)
      if (grid.size[axis] < 1 || !(grid.spacing[axis] > 0) || !std::isfinite(grid.spacing[axis]) ||
          !std::isfinite(grid.origin[axis]))
        std::abort();
    if (grid.voxel_count() < 1 || !(std::abs(glm::determinant(grid.direction)) > 0)) std::abort();
  } catch (const limber::Error&) {
  }
}
}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  try_parser([&] { return limber::parse_nrrd_header(bytes, "f"); });
  try_parser([&] { return limber::parse_meta_header(bytes, "f"); });
  try_parser([&] { return limber::parse_nifti_header(bytes, static_cast<std::int64_t>(size), "f").volume; });
  try_parser([&] { return limber::parse_nifti_header(bytes, std::nullopt, "f").volume; });
  try_parser([&] { return limber::parse_virtual_family(bytes, 1000, "f"); });
  limber::looks_like_meta_header(bytes);
  limber::looks_like_virtual_family(bytes);
  return 0;
}
