// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/resample/limb_thickness.h"

#include <cmath>

#include <doctest/doctest.h>

#include "core/base/error.h"
#include "core/resample/resample.h"
#include "tests/support/bent_tube.h"

using namespace limber;

namespace {

// Makes a straight limb along z that is thick above its middle and thin below.
LabelVolume two_rods(double spacing, double thick, double thin) {
  LabelVolume volume;
  volume.grid.spacing = glm::dvec3(spacing);
  volume.grid.size = {60, 60, 120};
  volume.voxels.assign(volume.grid.voxel_count(), 0);
  for (int z = 1; z < 119; ++z)
    for (int y = 0; y < 60; ++y)
      for (int x = 0; x < 60; ++x)
        if (std::hypot(x - 30, y - 30) * spacing < (z < 60 ? thin : thick)) volume.at({x, y, z}) = 1;
  return volume;
}

// Returns the tube with every length multiplied by `factor`.
test::BentTube scaled_tube(double factor) {
  test::BentTube tube = test::bent_tube();
  tube.volume.grid.spacing *= factor;
  tube.volume.grid.origin *= factor;
  for (Bone& bone : tube.rig.bones) bone.head *= factor, bone.tail *= factor;
  return tube;
}

}  // namespace

TEST_CASE("limb thickness: it is the limb's own at the joint, to a voxel, wherever across the limb the joint lies") {
  for (const double spacing : {1.0, 0.1, 10.0}) {
    CAPTURE(spacing);
    const LabelVolume volume = two_rods(spacing, 20 * spacing, 8 * spacing);
    const TissueVoxels tissue(volume);
    const TissueDepth depth(tissue, volume.grid.spacing);
    for (const double aside : {0.0, 5.0}) {
      const auto thin = limb_thickness(depth, volume.grid, glm::dvec3(30 + aside, 30, 25) * spacing),
                 thick = limb_thickness(depth, volume.grid, glm::dvec3(30, 30 + aside, 90) * spacing);
      REQUIRE((thin && thick));
      CHECK(std::abs(*thin / spacing - 16) <= 1);
      CHECK(std::abs(*thick / spacing - 40) <= 1);
    }
    const auto in_air = limb_thickness(depth, volume.grid, glm::dvec3(45, 30, 25) * spacing);
    REQUIRE(in_air);
    CHECK(std::abs(*in_air / spacing - 16) <= 1);
    CHECK_FALSE(limb_thickness(depth, volume.grid, glm::dvec3(300, 30, 25) * spacing).has_value());
  }
}

TEST_CASE("fem: a body of another size is meshed and posed alike" * doctest::test_suite("slow")) {
  const auto posed = [](const test::BentTube& tube) {
    return resample(tube.volume, tube.tissues, tube.rig, tube.weights, tube.pose(70), Fem{.contact = true});
  };
  const Posed usual = posed(scaled_tube(1));
  REQUIRE(usual.report.mesh);
  CHECK(usual.report.solve->converged);
  CHECK(usual.report.mesh->tets > 500);
  const auto share_that_differs = [&](double factor) {
    const Posed other = posed(scaled_tube(factor));
    CHECK(other.report.solve->converged);
    CHECK(other.report.mesh->tets == usual.report.mesh->tets);
    REQUIRE(other.volume.grid.size == usual.volume.grid.size);
    std::int64_t differ = 0;
    for (std::size_t i = 0; i < usual.volume.voxels.size(); ++i)
      differ += usual.volume.voxels[i] != other.volume.voxels[i];
    return double(differ) / double(usual.report.tissue_voxels);
  };
  // A scale by a power of two does not change any rounding.
  CHECK(share_that_differs(0.125) == 0);
  CHECK(share_that_differs(8) == 0);
  // With other factors, rounding may assign a point of the mesher's lattice that lies halfway between two voxels to
  // either voxel.
  CHECK(share_that_differs(0.1) < 0.03);
  CHECK(share_that_differs(10) < 0.03);
}

TEST_CASE("fem: where no bone that moves is as large as the tets, the user is told so") {
  const test::BentTube tube = test::bent_tube();
  CHECK_THROWS_WITH_AS(
      resample(tube.volume, tube.tissues, tube.rig, tube.weights, tube.pose(70), Fem{.spacing_mm = 12}),
      doctest::Contains("use a finer quality"), Error);
}
