// SPDX-License-Identifier: AGPL-3.0-or-later
// Implements the writing functions of volume_io.h. The voxels are written chunk by chunk: the labels of a chunk are
// converted to file values, compressed and written.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <optional>
#include <span>

#include "core/base/error.h"
#include "core/platform/memory_pages.h"
#include "core/volume_io/vector_volume_io.h"
#include "core/volume_io/volume_files.h"
#include "core/volume_io/volume_format.h"
#include "core/volume_io/volume_io.h"

namespace limber {

namespace {
const VolumeFormat::Written& writer_of(const Path& path) {
  if (const VolumeFormat::Written* written = how_written(path)) return *written;
  throw Error("volumes cannot be written with this extension", path.string(), "use one of " + writable_endings());
}

void write(const Voxels& voxels, const Path& path) { writer_of(path).write(voxels, path); }

// Calls body(labels, count, is_air) for one short run of labels after the other. If is_air is true, all labels of the
// run are air, so the body need not look at each voxel: most of a body's grid is air.
template <class Body>
void in_stretches(const Label* labels, std::size_t count, const Body& body) {
  constexpr std::size_t kStretch = 64;
  for (std::size_t done = 0; done < count; done += kStretch) {
    const std::size_t some = std::min(kStretch, count - done);
    body(labels + done, some, is_all_zero(labels + done, some * sizeof(Label)));
  }
}

// Returns a voxel type that holds all values from `lowest` to `highest`. This is `wanted` when it suffices, else the
// narrowest wider type of its family (signed, unsigned or real). A negative `lowest` turns an unsigned type into a
// signed one.
VoxelType type_that_holds(double lowest, double highest, std::optional<VoxelType> wanted) {
  using enum VoxelType;
  const auto holds = [&](VoxelType type) {
    return visit_voxel_type(type, [&]<class T>(T) {
      if constexpr (std::is_floating_point_v<T>) {
        const double exact = std::ldexp(1.0, std::numeric_limits<T>::digits);
        return -exact <= lowest && highest <= exact;
      } else {
        return static_cast<double>(std::numeric_limits<T>::lowest()) <= lowest &&
               highest <= static_cast<double>(std::numeric_limits<T>::max());
      }
    });
  };
  if (wanted && holds(*wanted)) return *wanted;
  const bool real = wanted && (*wanted == Float32 || *wanted == Float64);
  if (real) return Float64;
  const bool is_signed =
      lowest < 0 || (wanted && (*wanted == Int8 || *wanted == Int16 || *wanted == Int32 || *wanted == Int64));
  const std::array<VoxelType, 4> family =
      is_signed ? std::array{Int8, Int16, Int32, Int64} : std::array{UInt8, UInt16, UInt32, UInt64};
  for (VoxelType type : family)
    if (holds(type) && (!wanted || size_of(type) >= size_of(*wanted))) return type;
  return is_signed ? Int64 : UInt64;
}

}  // namespace

void check_writable(const Path& path) {
  writer_of(path);
  check_place(path);
}

std::vector<Path> files_written_as(const Path& path) {
  std::vector<Path> files{path};
  if (const VolumeFormat::Written* written = how_written(path))
    for (const std::string& ending : written->beside) files.push_back(Path(path).replace_extension(ending));
  return files;
}

void write_volume(const LabelVolume& volume, const Path& path, const TissueTable& tissues, const FileType& type) {
  writer_of(path);
  std::vector<std::uint8_t> present(65536);
  in_stretches(volume.voxels.data(), volume.voxels.size(), [&](const Label* labels, std::size_t count, bool air) {
    if (air) present[0] = 1;
    else
      for (std::size_t i = 0; i < count; ++i) present[labels[i]] = 1;
  });
  std::vector<double> value_of(65536);
  for (std::size_t label = 0; label < value_of.size(); ++label) value_of[label] = static_cast<double>(label);
  for (const Tissue& tissue : tissues.tissues) value_of[tissue.label] = tissue.label == 0 ? 0 : tissue.file_value;
  double lowest = 0, highest = 0;
  for (std::size_t label = 0; label < value_of.size(); ++label)
    if (present[label]) {
      lowest = std::min(lowest, value_of[label]);
      highest = std::max(highest, value_of[label]);
    }

  Voxels voxels{volume.grid,
                type_that_holds(lowest, highest, voxel_type_from_text(type.voxel_type)),
                1,
                type.compressed || type.format != format_written_as(path),
                {},
                tissues,
                type.format == "NIfTI-2" ? 2 : 1};
  visit_voxel_type(voxels.type, [&]<class T>(T) {
    std::vector<T> stored(65536);
    for (std::size_t label = 0; label < stored.size(); ++label)
      if (present[label]) stored[label] = static_cast<T>(value_of[label]);
    voxels.fill = [&volume, stored = std::move(stored)](std::int64_t first, std::size_t count, void* to) {
      T* out = static_cast<T*>(to);
      in_stretches(&volume.voxels[static_cast<std::size_t>(first)], count,
                   [&](const Label* labels, std::size_t some, bool air) {
                     if (air) std::fill_n(out, some, stored[0]);
                     else std::transform(labels, labels + some, out, [&](Label label) { return stored[label]; });
                     out += some;
                   });
    };
  });
  write(voxels, path);
}

void write_grey_volume(const GreyVolume& volume, const Path& path) {
  writer_of(path);
  // The file keeps its original voxel type when this type can hold every value. Interpolated values are fractional, so
  // they are written as floats.
  const auto wanted = voxel_type_from_text(volume.type.voxel_type).value_or(VoxelType::Float32);
  const bool keeps = visit_voxel_type(wanted, [&]<class T>(T) {
    if constexpr (std::is_floating_point_v<T>) return true;
    else
      return std::all_of(volume.voxels.begin(), volume.voxels.end(), [](float v) {
        return v == std::floor(v) && static_cast<double>(v) >= static_cast<double>(std::numeric_limits<T>::lowest()) &&
               static_cast<double>(v) < static_cast<double>(std::numeric_limits<T>::max()) + 1;
      });
  });
  Voxels voxels{volume.grid,
                keeps ? wanted : VoxelType::Float32,
                1,
                volume.type.compressed || volume.type.format != format_written_as(path),
                {},
                {},
                volume.type.format == "NIfTI-2" ? 2 : 1};
  visit_voxel_type(voxels.type, [&]<class T>(T) {
    voxels.fill = [&volume](std::int64_t first, std::size_t count, void* to) {
      T* out = static_cast<T*>(to);
      for (std::size_t i = 0; i < count; ++i)
        out[i] = static_cast<T>(volume.voxels[static_cast<std::size_t>(first) + i]);
    };
  });
  write(voxels, path);
}

void write_vector_volume(const Grid& grid, std::span<const glm::vec3> vectors, const Path& path) {
  Voxels voxels{grid, VoxelType::Float32, 3, true, {}, {}, 1};
  voxels.fill = [&vectors](std::int64_t first, std::size_t count, void* to) {
    std::memcpy(to, &vectors[static_cast<std::size_t>(first)], count * sizeof(glm::vec3));
  };
  write(voxels, path);
}

void write_displacement_field(const Grid& grid, std::span<const glm::vec3> to_posed, FieldDirection direction,
                              const Path& path) {
  const bool to_rest = direction == FieldDirection::ToRest;
  Voxels voxels{grid, VoxelType::Float32, 3, true, {}, {}, 1};
  voxels.description = to_rest ? "displacement, mm, LPS: rest minus posed, at posed voxels (as ITK warps rest)"
                               : "displacement, mm, LPS: posed minus rest, at posed voxels";
  voxels.keys = {{kFieldDirectionKey, to_rest ? kToRest : kToPosed}};
  voxels.fill = [&to_posed, to_rest](std::int64_t first, std::size_t count, void* to) {
    auto* out = static_cast<glm::vec3*>(to);
    for (std::size_t i = 0; i < count; ++i)
      out[i] = to_rest ? glm::vec3(0) - to_posed[static_cast<std::size_t>(first) + i]
                       : to_posed[static_cast<std::size_t>(first) + i];
  };
  write(voxels, path);
}

void write_scalar_volume(const Grid& grid, std::span<const float> values, const Path& path) {
  Voxels voxels{grid, VoxelType::Float32, 1, true, {}, {}, 1};
  voxels.fill = [&values](std::int64_t first, std::size_t count, void* to) {
    std::memcpy(to, &values[static_cast<std::size_t>(first)], count * sizeof(float));
  };
  write(voxels, path);
}

}  // namespace limber
