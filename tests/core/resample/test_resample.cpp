// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/resample/resample.h"

#include <map>

#include <doctest/doctest.h>

#include "core/base/parallel.h"
#include "core/report/metrics.h"
#include "tests/support/bent_tube.h"

using namespace limber;

namespace {

const Method kMethods[] = {Blend::Linear, Blend::DualQuaternion};

Posed posed(const test::BentTube& tube, const Pose& pose, const Method& method, const ResampleSettings& settings = {}) {
  return resample(tube.volume, tube.tissues, tube.rig, tube.weights, pose, method, settings);
}

}  // namespace

TEST_CASE(
    "resample: the rest pose gives back the volume bit for bit, on straight, mirrored, oblique and anisotropic grids") {
  for (const Grid& grid : {Grid{}, test::oblique_grid()}) {
    const test::BentTube tube = test::bent_tube(grid);
    for (const Method& method : kMethods)
      for (int threads : {1, 2, 4}) {
        ThreadCount limit(threads);
        const Posed result = posed(tube, rest_pose(tube.rig), method);
        CHECK(result.volume.grid == tube.volume.grid);
        CHECK(result.volume.voxels == tube.volume.voxels);
        CHECK(result.report.overlap_voxels == 0);
      }
  }
}

TEST_CASE("resample: a bent limb keeps every voxel, has no holes, and its bones stay rigid") {
  for (const Grid& grid : {Grid{}, test::oblique_grid()}) {
    const test::BentTube tube = test::bent_tube(grid);
    for (const Method& method : kMethods)
      for (double degrees : {10.0, 45.0, 90.0}) {
        const Posed result = posed(tube, tube.pose(degrees, 20), method);
        CHECK(result.report.dropped_voxels == 0);
        CHECK(result.report.new_hole_voxels == 0);
        REQUIRE(result.report.bones.size() == 2);
        for (const auto& bone : result.report.bones) {
          CHECK(bone.rigid_residual_mm < 0.01);
          CHECK(bone.voxels > 100);
        }
        for (const TissueChange& change : compare(tube.volume, result.volume, tube.tissues).tissues)
          CHECK(change.components_before == change.components_after);
      }
  }
}

TEST_CASE("resample: skin of one voxel stays closed over a bent limb, and bare tissue stays bare") {
  test::BentTube tube = test::bent_tube();
  for (glm::ivec3 v(0); v.z < tube.volume.grid.size.z; ++v.z)  // removes the skin on one side
    for (v.x = 0, v.y = 12; v.x < 11; ++v.x)
      if (tube.volume.at(v) == test::kSkin) tube.volume.at(v) = test::kFat;
  for (const Method& method : kMethods)
    for (double degrees : {30.0, 60.0, 90.0}) {
      const Posed result = posed(tube, tube.pose(degrees, 20), method);
      const VolumeMetrics change = compare(tube.volume, result.volume, tube.tissues);
      INFO("at ", degrees);
      CHECK(change.skin_share_before < 0.99);
      CHECK(change.skin_share_after > change.skin_share_before - 0.015);
      CHECK(change.skin_share_after < 0.9);
      const Posed as_it_falls = posed(tube, tube.pose(degrees, 20), method, {.nearest = true});
      CHECK(compare(tube.volume, as_it_falls.volume, tube.tissues).skin_share_after < change.skin_share_after - 0.02);
    }
}

TEST_CASE(
    "resample: closing the skin costs the tissue below it next to nothing, since what lies double elsewhere is given "
    "back") {
  const test::BentTube tube = test::bent_tube({}, 84);
  for (const Method& method : kMethods)
    for (double degrees : {20.0, 40.0}) {
      const auto skin_of = [&](const ResampleSettings& settings) {
        const VolumeMetrics change =
            compare(tube.volume, posed(tube, tube.pose(degrees, 20), method, settings).volume, tube.tissues);
        for (const TissueChange& tissue : change.tissues)
          if (tissue.label == test::kSkin) return std::pair(tissue.volume_change_percent, change.skin_share_after);
        return std::pair(0.0, 0.0);
      };
      const auto [mended, closed] = skin_of({});
      const auto [unmended, open] = skin_of({.nearest = true});
      INFO("at ", degrees, ": skin ", mended, " %, by nearest voxels ", unmended, " %");
      CHECK(closed > open + 0.02);
      CHECK(std::abs(mended - unmended) < 3);
    }
}

TEST_CASE("resample: results are the same for 1, 2 and 4 threads, bit for bit") {
  const test::BentTube tube = test::bent_tube();
  for (const Method& method : kMethods) {
    std::vector<Posed> results;
    for (int threads : {1, 2, 4}) {
      ThreadCount limit(threads);
      results.push_back(posed(tube, tube.pose(100, 30), method, {.displacement = true, .jacobian = true}));
    }
    for (const Posed& result : results) {
      CHECK(result.volume.voxels == results[0].volume.voxels);
      CHECK(result.displacement == results[0].displacement);
      CHECK(result.jacobian == results[0].jacobian);
      CHECK(result.report.overlap_voxels == results[0].report.overlap_voxels);
      CHECK(result.report.overlap_by_label == results[0].report.overlap_by_label);
    }
  }
}

TEST_CASE("resample: bones stay rigid though the given weights would bend them") {
  test::BentTube tube = test::bent_tube();
  const TissueVoxels tissue(tube.volume);
  for (std::int64_t b = 0; b < tube.weights.chunk_count(); ++b) {
    SkinWeights::Influences chunk;
    tissue.for_each(b, b + 1, [&](std::int64_t, const glm::ivec3& v) {
      const double far = std::clamp((v.z - 6) / 30.0, 0.0, 1.0);
      chunk.push_back(quantize({{0, 1 - far}, {1, far}}));
    });
    tube.weights.set_chunk(b, std::move(chunk));
  }
  for (const Method& method : kMethods) {
    const Posed result = posed(tube, tube.pose(45), method);
    CHECK(result.report.new_hole_voxels == 0);
    REQUIRE(result.report.bones.size() == 2);
    for (const auto& bone : result.report.bones) CHECK(bone.rigid_residual_mm < 0.01);
  }
}

TEST_CASE("resample: a hollow that a bend would enlarge keeps its size, and what fills it says where it comes from") {
  test::BentTube tube = test::bent_tube();
  const int joint = tube.volume.grid.size.z / 2;
  std::int64_t hollow = 0;
  for (int y : {6, 7, 8, 16, 17, 18})
    for (int z = joint - 4; z <= joint + 4; ++z)
      for (int x = 9; x <= 13; ++x) {
        hollow += tube.volume.at({x, y, z}) != 0;
        tube.volume.at({x, y, z}) = 0;
      }
  const TissueVoxels tissue(tube.volume);
  tube.weights = SkinWeights({tube.rig.bones[0].name, tube.rig.bones[1].name}, tissue);
  for (std::int64_t brick = 0; brick < tube.weights.chunk_count(); ++brick) {
    SkinWeights::Influences chunk;
    tissue.for_each(brick, brick + 1, [&](std::int64_t, const glm::ivec3& v) {
      const double fore = std::clamp(0.5 + (v.z - joint) / 12.0, 0.0, 1.0);
      chunk.push_back(tube.volume.at(v) == test::kBone ? rigid_influence(v.z > joint)
                                                       : quantize({{0, 1 - fore}, {1, fore}}));
    });
    tube.weights.set_chunk(brick, chunk);
  }
  const Posed result =
      posed(tube, tube.pose(70), Blend::DualQuaternion, {.displacement = true, .tiled_displacement = true});
  CHECK(result.report.filled_air_voxels > 0);
  CHECK(compare(tube.volume, result.volume, tube.tissues).enclosed_air_after <= hollow);
  std::int64_t from_nowhere = 0;
  const Grid& grid = result.volume.grid;
  glm::ivec3 v;
  for (v.z = 0; v.z < grid.size.z; ++v.z)
    for (v.y = 0; v.y < grid.size.y; ++v.y)
      for (v.x = 0; v.x < grid.size.x; ++v.x) {
        CHECK(result.tiled_displacement.at(v) == result.displacement[grid.index(v)]);
        if (result.volume.at(v) == 0) continue;
        const glm::dvec3 rest = voxel_from_world(tube.volume.grid) * (world_from_voxel(grid) * glm::dvec3(v) -
                                                                      glm::dvec3(result.displacement[grid.index(v)]));
        // A rest point on the tissue's border may round to either side.
        bool near_tissue = false;
        for (int corner = 0; corner < 8; ++corner)
          near_tissue |= tube.volume.at_or_air(glm::ivec3(glm::floor(rest)) +
                                               glm::ivec3(corner & 1, corner >> 1 & 1, corner >> 2)) != 0;
        from_nowhere += !near_tissue;
      }
  CHECK(from_nowhere == 0);
}
