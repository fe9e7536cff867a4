// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/seams/skin_layers.h"

#include <optional>
#include <string>

#include <doctest/doctest.h>

using namespace limber;

namespace {

// A ray along x through the tissues of a word, from the air on: S skin, f fat, m muscle, b bone.
void add_ray(SkinLayers& layers, const std::string& tissues, bool upwards = true) {
  const int last = static_cast<int>(tissues.size()) - 1;
  layers.add_ray({upwards ? 0 : last, 0, 0}, upwards ? 1 : 0, [&](const glm::ivec3& v) -> std::optional<Layer> {
    const int place = upwards ? v.x : last - v.x;
    if (place < 0 || place > last) return std::nullopt;
    const char c = tissues[place];
    return c == 'S' ? Layer::Sheet : c == 'f' ? Layer::Fat : c == 'm' ? Layer::Muscle : Layer::Deep;
  });
}

}  // namespace

TEST_CASE("skin layers: what lies nearer to the surface than it does on free skin surprises") {
  SkinLayers layers(glm::dvec3(5));  // six voxels are looked at
  for (int ray = 0; ray < 1000; ++ray) {
    add_ray(layers, ray % 2 ? "Sfmmmm" : "SSfmmm", ray % 3 != 0);
    add_ray(layers, "Sfmm");    // comes out again
    add_ray(layers, "SSSSSS");  // along the skin
  }
  layers.finish();
  CHECK(layers.surprise(0, Layer::Fat, 0) == 1);
  CHECK(layers.surprise(0, Layer::Fat, 1) == 0);
  CHECK(layers.surprise(0, Layer::Muscle, 1) == 1);
  CHECK(layers.surprise(0, Layer::Muscle, 2) == 0);
  CHECK(layers.surprise(0, Layer::Deep, 5) == 1);
  CHECK(layers.reach(0) == 6);
  CHECK(layers.surprise(0, Layer::Deep, 6) == 0);
}

TEST_CASE("skin layers: too little free skin tells nothing, and neither does another axis") {
  SkinLayers layers(glm::dvec3(5));
  for (int ray = 0; ray < 100; ++ray) add_ray(layers, "Sfmmmm");
  layers.finish();
  CHECK(layers.reach(0) == 0);
  CHECK(layers.surprise(0, Layer::Muscle, 0) == 0);
  CHECK(layers.reach(1) == 0);
}
