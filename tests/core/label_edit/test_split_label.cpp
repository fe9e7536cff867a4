// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/label_edit/split_label.h"

#include <doctest/doctest.h>

#include "core/base/error.h"
#include "tests/core/label_edit/random_labels.h"

using namespace limber;
using namespace limber::test;

namespace {

// Two legs of bone (1), seen along y: rods along z, one around x = 10 and one around x = 30, in muscle (2).
LabelVolume legs(bool joined = false) {
  return volume_of({{40, 12, 50}, {2, 2, 2}}, [=](const glm::ivec3& v) {
    const bool rod = (std::abs(v.x - 10) < 4 || std::abs(v.x - 30) < 4) && std::abs(v.y - 6) < 4 && v.z > 2 && v.z < 47;
    const bool bridge = joined && v.z > 42 && v.z < 47 && v.x > 8 && v.x < 32 && std::abs(v.y - 6) < 4;
    return Label(rod || bridge ? 1 : 2);
  });
}

}  // namespace

TEST_CASE("split: a cut across one leg divides it there, and leaves the other leg alone") {
  const LabelVolume volume = legs();
  LabelVolume split = volume;
  apply_change(split_label(volume, 1, {{0, 0, 61}, {40, 0, 61}, {0, 1, 0}}, 7), split);
  for_voxels(volume.grid, [&](const glm::ivec3& v) {
    const bool upper = v.z * 2 > 61;  // the smaller part gets label 7: 16 of 44 layers
    CHECK(split.at(v) == (volume.at(v) == 1 && v.x < 20 && upper ? 7 : volume.at(v)));
  });
  // The same line drawn backwards gives the same parts.
  LabelVolume back = volume;
  apply_change(split_label(volume, 1, {{40, 0, 61}, {0, 0, 61}, {0, 1, 0}}, 7), back);
  CHECK(back.voxels == split.voxels);
}

TEST_CASE("split: a slanted cut divides along its plane") {
  const LabelVolume volume = legs();
  const glm::dvec3 from(4, 0, 21), to(36, 0, 41);
  LabelVolume split = volume;
  apply_change(split_label(volume, 1, {from, to, {0, 1, 0}}, 7), split);
  for_voxels(volume.grid, [&](const glm::ivec3& v) {
    const bool left_leg = volume.at(v) == 1 && v.x < 20;
    if (!left_leg) CHECK(split.at(v) == volume.at(v));
    const glm::dvec3 p = glm::dvec3(v) * 2.0;
    const double above = p.z - (from.z + (p.x - from.x) * (to.z - from.z) / (to.x - from.x));
    if (left_leg && std::abs(above) > 1e-6)
      CHECK(split.at(v) == (above > 0 ? 1 : 7));  // the smaller part, here the lower one, gets label 7
  });
}

TEST_CASE("split: a cut that does not divide says so, and changes nothing") {
  const auto message = [](const LabelVolume& volume, const LabelCut& cut, Label label = 1) -> std::string {
    try {
      split_label(volume, label, cut, 7);
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  };
  CHECK(message(legs(), {{0, 0, 61}, {20, 0, 61}, {0, 1, 0}}).starts_with("the cut does not divide the tissue"));
  CHECK(message(legs(true), {{0, 0, 87}, {40, 0, 87}, {0, 1, 0}}).starts_with("the cut does not divide the tissue"));
  CHECK(message(legs(true), {{0, 0, 61}, {40, 0, 61}, {0, 1, 0}}).empty());
  CHECK(message(legs(), {{35, 0, 61}, {45, 0, 61}, {0, 1, 0}}).starts_with("the line does not cut the tissue"));
  CHECK(message(legs(), {{35, 0, 61}, {35, 9, 61}, {0, 1, 0}}).starts_with("the cut has no length"));
  CHECK(message(legs(), {{0, 0, 61}, {40, 0, 61}, {0, 1, 0}}, 55).starts_with("the line does not cut the tissue"));
}
