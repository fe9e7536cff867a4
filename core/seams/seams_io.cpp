// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/seams/seams_io.h"

#include <cmath>
#include <string>

#include "core/base/error.h"
#include "core/volume_io/volume_io.h"

namespace limber {

namespace {

// Two grids count as equal if the distances between their corners are at most this, in mm per voxel of the longest
// axis.
constexpr double kSamePlace = 1e-3;

// Returns for each label of the file which faces it marks as cut: the sum of 1, 2 and 4 (seams_io.h), which is the
// label's file value.
std::vector<int> faces_by_label(const TissueTable& tissues, const Path& path) {
  std::vector<int> faces(65536, 0);
  for (const Tissue& tissue : tissues.tissues) {
    const double value = tissue.file_value;
    if (!(value >= 1 && value <= 7) || value != std::floor(value))
      throw Error("this is not a file of seams: it has the value " + std::to_string(value), path.string(),
                  "write the seams with 'limber prepare --seams'");
    faces[tissue.label] = static_cast<int>(value);
  }
  return faces;
}

bool is_same_place(const Grid& a, const Grid& b) {
  if (a.size != b.size) return false;
  const AffineTransform of_a = world_from_voxel(a), of_b = world_from_voxel(b);
  for (const glm::dvec3& corner : {glm::dvec3(0), glm::dvec3(a.size)})
    if (glm::length(of_a * corner - of_b * corner) > kSamePlace * double(1 + std::max({a.size.x, a.size.y, a.size.z})))
      return false;
  return true;
}

}  // namespace

void write_seams(const Seams& seams, const Grid& grid, const Path& path) {
  LabelVolume faces{grid, ZeroedVector<Label>(grid.voxel_count())};
  seams.for_each(
      [&](const glm::ivec3& lower, int axis) { faces.at(lower) = static_cast<Label>(faces.at(lower) | 1 << axis); });
  write_volume(faces, path, {}, {"NRRD", "uint8", true});
}

Seams read_seams(const Path& path, const LabelVolume& volume, Progress& progress) {
  const VolumeFile file = read_volume(path, progress);
  if (!is_same_place(file.volume.grid, volume.grid))
    throw Error("the seams lie on another grid than the volume", path.string(),
                "find the seams of this volume: limber prepare --seams");
  const std::vector<int> faces = faces_by_label(file.tissues, path);
  Seams seams(volume.grid.size);
  const glm::ivec3 size = volume.grid.size;
  glm::ivec3 v;
  for (v.z = 0; v.z < size.z; ++v.z)
    for (v.y = 0; v.y < size.y; ++v.y)
      for (v.x = 0; v.x < size.x; ++v.x) {
        const int cut = faces[file.volume.at(v)];
        if (cut == 0 || volume.at(v) == 0) continue;
        for (int axis = 0; axis < 3; ++axis) {
          glm::ivec3 above = v;
          ++above[axis];
          if ((cut >> axis & 1) && volume.at_or_air(above)) seams.cut(v, axis);
        }
      }
  return seams;
}

}  // namespace limber
