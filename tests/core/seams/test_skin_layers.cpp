// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/seams/skin_layers.h"

#include <algorithm>
#include <string>

#include <doctest/doctest.h>

using namespace limber;

namespace {

constexpr int kLongest = 6, kSide = 64;

std::vector<TissueKind> kinds() {
  std::vector<TissueKind> kind(65536, TissueKind::Unknown);
  kind['S'] = TissueKind::Skin;
  kind['f'] = TissueKind::Fat;
  kind['m'] = TissueKind::Muscle;
  kind['b'] = TissueKind::Bone;
  return kind;
}

// Makes rows of tissue along x, one voxel thick, with air around. Each row is a word: S skin, f fat, m muscle, b bone.
SkinLayers layers_of(const std::vector<std::string>& words, double spacing) {
  LabelVolume volume;
  volume.grid.size = {kLongest + 2, 2 * kSide + 1, 2 * kSide + 1};
  volume.grid.spacing = glm::dvec3(spacing);
  volume.voxels.resize(volume.grid.voxel_count());
  for (std::size_t i = 0; i < words.size(); ++i)
    for (std::size_t x = 0; x < words[i].size(); ++x)
      volume.at({1 + int(x), 1 + 2 * int(i % kSide), 1 + 2 * int(i / kSide)}) = static_cast<Label>(words[i][x]);
  const TissueVoxels tissue(volume);
  return SkinLayers(skin_rays(volume, tissue, kinds()), volume.grid.spacing, [](std::int64_t) { return true; });
}

}  // namespace

TEST_CASE("skin layers: what lies nearer to the surface than it does on free skin surprises") {
  std::vector<std::string> words;
  for (int ray = 0; ray < 1000; ++ray) {
    std::string word = ray % 2 ? "Sfmmmm" : "SSfmmm";
    if (ray % 3 == 0) std::reverse(word.begin(), word.end());
    // The second row reaches air again on its other side; the third never leaves the skin.
    words.insert(words.end(), {word, "Sfmm", "SSSSSS"});
  }
  const SkinLayers layers = layers_of(words, 5);  // at 5 mm, six voxels of each row are examined
  CHECK(layers.surprise(0, Layer::Fat, 0) == 1);
  CHECK(layers.surprise(0, Layer::Fat, 1) == 0);
  CHECK(layers.surprise(0, Layer::Muscle, 1) == 1);
  CHECK(layers.surprise(0, Layer::Muscle, 2) == 0);
  CHECK(layers.surprise(0, Layer::Deep, 5) == 1);
  CHECK(layers.reach(0) == 6);
  CHECK(layers.surprise(0, Layer::Deep, 6) == 0);
}

TEST_CASE("skin layers: too little free skin tells nothing, and neither does another axis") {
  const SkinLayers layers = layers_of(std::vector<std::string>(100, "Sfmmmm"), 5);
  CHECK(layers.reach(0) == 0);
  CHECK(layers.surprise(0, Layer::Muscle, 0) == 0);
  CHECK(layers.reach(1) == 0);
}

TEST_CASE("skin layers: only the skin that is asked for counts") {
  LabelVolume volume;
  volume.grid.size = {8, 1, 1};
  volume.voxels = {0, 'S', 'f', 'm', 'm', 'b', 'm', 'm'};
  const TissueVoxels tissue(volume);
  const std::vector<SkinRay> rays = skin_rays(volume, tissue, kinds());
  REQUIRE(rays.size() == 0);  // within thirty voxels, the row reaches air again
  volume.grid.spacing = {5, 5, 5};
  const std::vector<SkinRay> short_rays = skin_rays(volume, tissue, kinds());
  REQUIRE(short_rays.size() == 1);
  CHECK(short_rays[0].place == 0);
  CHECK(short_rays[0].first == std::array<std::uint16_t, kLayers>{6, 1, 2, 4});
}
