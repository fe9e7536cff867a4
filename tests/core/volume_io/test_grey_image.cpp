// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/volume_io/grey_image.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include <doctest/doctest.h>

#include "core/base/error.h"

using namespace limber;

namespace {

// Makes voxels of 2 x 1 x 3 mm whose value gives their index. Rows run to the patient's right.
GreyVolume numbered() {
  GreyVolume volume;
  volume.grid = {{4, 5, 3}, {2, 1, 3}, {10, 20, 30}, glm::dmat3(-1, 0, 0, 0, 1, 0, 0, 0, 1)};
  for (int z = 0; z < 3; ++z)
    for (int y = 0; y < 5; ++y)
      for (int x = 0; x < 4; ++x) volume.voxels.push_back(static_cast<float>(100 * z + 10 * y + x));
  return volume;
}

GreyFrame axial(const GreyVolume& volume, const glm::ivec3& voxel) {
  return {.middle = world_from_voxel(volume.grid) * glm::dvec3(voxel), .size = {1, 1}, .millimetres_per_pixel = 1};
}

}  // namespace

TEST_CASE("grey image: many values that differ everywhere are an image, unless they have names") {
  std::mt19937 random(5);
  LabelVolume volume{{{20, 20, 20}, {1, 1, 1}, {0, 0, 0}, glm::dmat3(1)}, ZeroedVector<Label>(8000)};
  TissueTable tissues;
  for (int value = 1; value <= 300; ++value) {
    Tissue& tissue = tissues.tissues.emplace_back();
    tissue.label = static_cast<Label>(value);
    tissue.file_value = value;
  }
  for (Label& label : volume.voxels) label = static_cast<Label>(1 + random() % 300);
  const auto doubt = grey_image_doubt(volume, tissues);
  REQUIRE(doubt);
  CHECK(doubt->starts_with("it has 300 values, and "));
  CHECK_THROWS_WITH_AS(require_labels(volume, tissues, "ct.nrrd"), doctest::Contains("ct.nrrd"), Error);
  TissueTable named = tissues;
  for (Tissue& tissue : named.tissues) tissue.name = "Tissue " + std::to_string(tissue.label);
  CHECK_FALSE(grey_image_doubt(volume, named));
  CHECK_NOTHROW(require_labels(volume, named, "ct.nrrd"));
  for (std::size_t i = 0; i < volume.voxels.size(); ++i) volume.voxels[i] = static_cast<Label>(1 + i / 20 % 300);
  CHECK_FALSE(grey_image_doubt(volume, tissues));
}

TEST_CASE("grey image: a slice shows the voxel at each place of the world, nothing outside") {
  const GreyVolume volume = numbered();
  for (int z = 0; z < 3; ++z)
    for (int y = 0; y < 5; ++y)
      for (int x = 0; x < 4; ++x) {
        const auto picture = grey_slice(volume, axial(volume, {x, y, z}));
        REQUIRE(picture.size() == 1);
        CHECK(picture[0] == 100 * z + 10 * y + x);
      }
  // The right of the picture is the patient's left, so pixels run backwards along the rows.
  GreyFrame frame = axial(volume, {1, 2, 1});
  frame.size = {9, 1};
  frame.millimetres_per_pixel = 2;
  const auto row = grey_slice(volume, frame);
  for (const auto& [pixel, value] : {std::pair(2, 123), {3, 122}, {4, 121}, {5, 120}}) CHECK(row[pixel] == value);
  frame.middle.x += 0.8;  // mm: less than half a voxel, so the nearest voxel stays the same
  CHECK(grey_slice(volume, frame)[3] == 122);
  frame.middle.x += 0.4;
  CHECK(grey_slice(volume, frame)[3] == 121);
  CHECK(std::isnan(row[1]));
  CHECK(std::isnan(row[6]));
}

TEST_CASE("grey image: a projection shows the largest value on each line of sight") {
  GreyVolume volume = numbered();
  volume.voxels[volume.grid.index({2, 1, 1})] = 5000;
  volume.voxels[volume.grid.index({3, 1, 1})] = std::numeric_limits<float>::quiet_NaN();
  for (const auto& [voxel, value] : {std::pair(glm::ivec3(2, 1, 0), 5000), {{2, 2, 0}, 222}, {{3, 1, 0}, 213}}) {
    const auto picture = grey_projection(volume, axial(volume, voxel));
    CHECK(picture[0] == value);
  }
  // Views from the front. The middle of the picture lies far behind the image, which does not matter: only its position
  // across the line of sight counts.
  GreyFrame front{.middle = world_from_voxel(volume.grid) * glm::dvec3(2, 40, 1), .down = {0, 0, -1}};
  CHECK(grey_projection(volume, front)[0] == 5000);
  front.middle.z += 3;
  CHECK(grey_projection(volume, front)[0] == 242);
  front.middle.z += 30;
  CHECK(std::isnan(grey_projection(volume, front)[0]));
}

TEST_CASE("grey image: the window leaves outliers out and maps its ends to black and white") {
  GreyVolume volume{{{100, 100, 1}, {1, 1, 1}, {0, 0, 0}, glm::dmat3(1)}, {}, {}, {}};
  for (int i = 0; i < 10000; ++i) volume.voxels.push_back(static_cast<float>(i % 1001));
  volume.voxels[7] = 1e9f;
  volume.voxels[8] = std::numeric_limits<float>::infinity();
  const GreyWindow window = usual_window(volume);
  CHECK(window.level == doctest::Approx(500).epsilon(0.01));
  CHECK(window.width == doctest::Approx(980).epsilon(0.01));
  CHECK(grey_of(static_cast<float>(window.level - 0.51 * window.width), window) == 0);
  CHECK(grey_of(static_cast<float>(window.level), window) == 128);
  CHECK(grey_of(static_cast<float>(window.level + 0.51 * window.width), window) == 255);
  CHECK(grey_of(std::numeric_limits<float>::quiet_NaN(), window) == 0);
  CHECK(usual_window(GreyVolume{}) == GreyWindow{});
}
