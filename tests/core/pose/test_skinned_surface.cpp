// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/pose/skinned_surface.h"

#include <doctest/doctest.h>

#include "core/pose/pose.h"
#include "tests/support/bent_tube.h"

namespace limber::test {

TEST_CASE("skinned surface: at rest it is the body's surface, moved rigidly it moves along, and bent it stays with its bones") {
  const BentTube tube = bent_tube();
  const SkinnedSurface surface = skinned_surface(tube.volume, tube.weights, 3);
  REQUIRE(surface.mesh.V.size() > 100);
  REQUIRE(surface.influences.size() == surface.mesh.V.size());
  const RigidTransform moved{glm::normalize(glm::dquat(0.9, 0.1, -0.3, 0.2)), {10, -20, 30}};
  const auto rest = posed_points(surface, {RigidTransform{}, RigidTransform{}}), rigid = posed_points(surface, {moved, moved});
  const auto bent = posed_points(surface, posed_from_rest(tube.rig, tube.pose(60)));
  const auto motions = posed_from_rest(tube.rig, tube.pose(60));
  for (std::size_t v = 0; v < rest.size(); ++v) {
    CHECK(glm::distance(glm::dvec3(rest[v]), surface.mesh.V[v]) < 1e-3);
    CHECK(glm::distance(glm::dvec3(rigid[v]), moved * surface.mesh.V[v]) < 1e-3);
    for (int bone : {0, 1})
      if (surface.influences[v].of(bone) == 1) CHECK(glm::distance(glm::dvec3(bent[v]), motions[bone] * surface.mesh.V[v]) < 1e-3);
  }
}

}  // namespace limber::test
