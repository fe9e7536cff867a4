// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/study/tissue_legend.h"

#include <algorithm>
#include <cstdio>

#include "core/study/text.h"

namespace limber {

namespace {

constexpr int kSparse = 4;

// Returns the first label along a ray that is not air; 0: the ray meets only air.
Label first_label(const LabelVolume& volume, const glm::dvec3& from, const glm::dvec3& step, int steps) {
  for (int i = 0; i < steps; ++i) {
    const glm::ivec3 voxel(glm::floor(from + step * double(i) + 0.5));
    if (volume.grid.contains(voxel))
      if (const Label label = volume.voxels[std::size_t(volume.grid.index(voxel))]; label != 0) return label;
  }
  return 0;
}

}  // namespace

void add_shown(const LabelVolume& volume, const TissueTable& tissues, PictureFrame frame, ShownPart part,
               TissueLegend& legend) {
  frame.size = glm::max(frame.size / kSparse, glm::ivec2(1));
  const Grid& grid = volume.grid;
  const AffineTransform to_voxel = voxel_from_world(grid);
  // Rays advance by half a voxel per step, over a distance in which they pass the whole body.
  const double reach = glm::length(glm::dvec3(grid.size) * grid.spacing),
               step_mm = 0.5 * std::min({grid.spacing.x, grid.spacing.y, grid.spacing.z});
  const glm::dvec3 ahead = -frame.towards_eye() * step_mm;
  const int steps = part == ShownPart::Slice ? 1 : static_cast<int>(2 * reach / step_mm);
  const glm::dvec3 begin = part == ShownPart::Surface ? frame.towards_eye() * reach : glm::dvec3(0);
  const glm::dvec3 step = to_voxel * (frame.centre + ahead) - to_voxel * frame.centre;
  const double pixel = frame.height_mm / frame.size.y;
  for (int y = 0; y < frame.size.y; ++y)
    for (int x = 0; x < frame.size.x; ++x) {
      const glm::dvec3 world = frame.centre + frame.right * ((x + 0.5 - frame.size.x / 2.0) * pixel) -
                               frame.up * ((y + 0.5 - frame.size.y / 2.0) * pixel) + begin;
      const Tissue* tissue = tissues.find(first_label(volume, to_voxel * world, step, steps));
      if (!tissue) continue;
      const auto colour = glm::u8vec3(glm::clamp(tissue->colour, 0.0f, 1.0f) * 255.0f + 0.5f);
      legend.try_emplace(tissue->file_value, ShownTissue{tissue->name, colour});
    }
}

std::string html_of(const TissueLegend& legend) {
  if (legend.empty()) return "";
  std::string text = "<p class=\"tissue-legend\">";
  for (const auto& [value, tissue] : legend) {
    char colour[8];
    std::snprintf(colour, sizeof colour, "#%02x%02x%02x", tissue.colour.r, tissue.colour.g, tissue.colour.b);
    text += "<span><i style=\"background:" + std::string(colour) + "\"></i>" +
            escaped(tissue.name.empty() ? "label " + number(value) : tissue.name) + "</span>";
  }
  return text + "</p>";
}

}  // namespace limber
