// SPDX-License-Identifier: AGPL-3.0-or-later
// Compares the program's skin weights with those that an artist painted, on a whole body whose bones are drawn as
// tubes.
#include <algorithm>
#include <cmath>
#include <fstream>
#include <numeric>
#include <sstream>

#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

#include "core/base/file.h"
#include "core/binding/heat_diffusion.h"
#include "core/rig_io/rig_io.h"
#include "core/volume_io/volume_io.h"
#include "tests/support/shared_data.h"

using namespace limber;
using namespace limber::test;

namespace {
std::vector<glm::dvec3> vertices_of_obj(const Path& path) {
  std::ifstream in(path);
  std::vector<glm::dvec3> vertices;
  for (std::string line; std::getline(in, line);) {
    std::istringstream words(line);
    std::string kind;
    glm::dvec3 p;
    if (words >> kind >> p.x >> p.y >> p.z && kind == "v") vertices.push_back(p);
  }
  return vertices;
}

// Returns the tissue voxel nearest to a point, searched within three voxels.
glm::ivec3 nearest_tissue(const LabelVolume& volume, const AffineTransform& from_world, const glm::dvec3& point) {
  const glm::dvec3 at = from_world * point;
  const glm::ivec3 centre(glm::round(at));
  glm::ivec3 best = centre;
  double least = INFINITY;
  for (int z = -3; z <= 3; ++z)
    for (int y = -3; y <= 3; ++y)
      for (int x = -3; x <= 3; ++x) {
        const glm::ivec3 v = centre + glm::ivec3(x, y, z);
        if (volume.at_or_air(v) == 0) continue;
        if (const double d = glm::length(glm::dvec3(v) - at); d < least) least = d, best = v;
      }
  return best;
}
}  // namespace

TEST_CASE("painted body: the strongest bone is the artist's on most of the surface" * doctest::test_suite("slow")) {
  NEEDS_SHARED("data/makehuman/body_4mm.nrrd");
  const Path folder = shared_path("data/makehuman");
  const VolumeFile file = read_volume(folder / "body_4mm.nrrd");
  const Armature armature = read_armature(folder / "body.armature.json");
  const TissueVoxels tissue(file.volume);
  const SkinWeights weights = diffuse_heat(file.volume, with_bones(file.tissues, {4}), armature);

  const std::vector<glm::dvec3> vertices = vertices_of_obj(folder / "surface.obj");
  std::vector<std::vector<double>> painted(vertices.size(), std::vector<double>(armature.bones.size()));
  const auto json = nlohmann::json::parse(read_file(folder / "surface_weights.json"));
  for (const auto& [name, list] : json["bones"].items())
    for (const auto& entry : list)
      painted[entry[0].get<size_t>()][require_bone(armature, name)] += entry[1].get<double>();

  const AffineTransform from_world = voxel_from_world(file.volume.grid);
  std::int64_t agree = 0;
  double difference = 0;
  for (size_t i = 0; i < vertices.size(); ++i) {
    const glm::ivec3 v = nearest_tissue(file.volume, from_world, vertices[i]);
    const int brick = tissue.brick_at(v);
    const Influence& ours = weights.chunk(brick)[tissue.index_of(v) - tissue.bricks()[brick].first];
    const double sum = std::max(1e-9, std::accumulate(painted[i].begin(), painted[i].end(), 0.0));
    agree += std::max_element(painted[i].begin(), painted[i].end()) - painted[i].begin() == ours.bone[0];
    for (size_t b = 0; b < armature.bones.size(); ++b)
      difference += std::abs(painted[i][b] / sum - ours.of(static_cast<int>(b)));
  }
  const double share = double(agree) / vertices.size(), mean = difference / (vertices.size() * armature.bones.size());
  MESSAGE("the strongest bone agrees on ", 100 * share, " % of ", vertices.size(), " vertices; mean |dw| ", mean);
  CHECK(share > 0.91);
  CHECK(mean < 0.0097);
}
