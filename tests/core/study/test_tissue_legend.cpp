// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/study/tissue_legend.h"

#include <doctest/doctest.h>

using namespace limber;

namespace {

// A cube of 20 mm: fat, covered by skin of 2 mm, with a bone of 4 mm in its middle.
LabelVolume layered() {
  LabelVolume volume{{.size = {20, 20, 20}, .spacing = glm::dvec3(1), .origin = glm::dvec3(-9.5)}, {}};
  for (int z = 0; z < 20; ++z)
    for (int y = 0; y < 20; ++y)
      for (int x = 0; x < 20; ++x) {
        const glm::dvec3 from = glm::abs(glm::dvec3(x, y, z) - 9.5);
        const double out = std::max({from.x, from.y, from.z});
        volume.voxels.push_back(out > 8 ? 1 : out > 2 ? 2 : 3);
      }
  return volume;
}

std::string shown(ShownPart part, double height_mm = 30) {
  TissueTable tissues;
  tissues.tissues = {{.label = 1, .file_value = 11, .name = "skin", .colour = {1, 0, 0}},
                     {.label = 2, .file_value = 12, .name = "fat & oil", .colour = {0, 1, 0}},
                     {.label = 3, .file_value = 13, .colour = {0, 0, 1}}};
  TissueLegend legend;
  add_shown(layered(), tissues, {.height_mm = height_mm}, part, legend);
  std::string names;
  for (const auto& [value, tissue] : legend) names += std::to_string(int(value)) + " ";
  if (part == ShownPart::Slice && height_mm == 30)
    CHECK(html_of(legend) ==
          "<p class=\"tissue-legend\"><span><i style=\"background:#ff0000\"></i>skin</span><span><i "
          "style=\"background:#00ff00\"></i>fat &amp; oil</span><span><i style=\"background:#0000ff\"></i>label "
          "13</span></p>");
  return names;
}

}  // namespace

TEST_CASE("study pictures: a legend has the tissues that the picture shows, and no others") {
  CHECK(shown(ShownPart::Slice) == "11 12 13 ");
  CHECK(shown(ShownPart::Surface) == "11 ");
  CHECK(shown(ShownPart::CutSurface) == "11 12 13 ");
  CHECK(shown(ShownPart::Slice, 3) == "13 ");
  CHECK(html_of({}).empty());
}
