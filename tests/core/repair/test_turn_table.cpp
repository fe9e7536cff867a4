// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/repair/turn_table.h"

#include <array>
#include <cmath>

#include <doctest/doctest.h>

#include "core/deform/blend_rule.h"

using namespace limber;

namespace {

// Returns the weight of bone 1 at a point; bone 0 has the rest. The weight varies along all three axes.
double share_at(const glm::dvec3& p) { return 0.5 + 0.3 * std::sin(0.02 * p.x + 0.01 * p.y) + 0.002 * p.z; }

// Returns det F, the volume ratio, of the blend of two bones at p, by central differences. Bone 1 turns by `angle`
// about `axis` through the origin, bone 0 stays.
double volume_ratio(Blend blend, double angle, const glm::dvec3& axis, const glm::dvec3& p) {
  const std::array<RigidTransform, 2> motions{RigidTransform{}, RigidTransform{glm::angleAxis(angle, axis), {}}};
  const std::array<SkinTransform, 2> bones{skin_transform(motions[0]), skin_transform(motions[1])};
  const auto posed = [&](const glm::dvec3& rest) {
    const std::array<BoneWeight, 2> influences{{{0, 1 - share_at(rest)}, {1, share_at(rest)}}};
    return blend_point(blend, bones, influences, rest);
  };
  constexpr double h = 1e-4;
  glm::dmat3 F;
  for (int i = 0; i < 3; ++i) {
    glm::dvec3 step(0);
    step[i] = h;
    F[i] = (posed(p + step) - posed(p - step)) / (2 * h);
  }
  return glm::determinant(F);
}

}  // namespace

TEST_CASE("turn table: the local volume of a blended turn is what the blend's own derivatives give, by every blend") {
  const glm::dvec3 axis = glm::normalize(glm::dvec3(1, 2, -0.5));
  for (std::size_t b = 0; b < blend_rules().size(); ++b)
    for (const double angle : {-1.2, 0.4, 1.57, 2.4})
      for (const glm::dvec3& p : {glm::dvec3(10, -30, 20), glm::dvec3(-40, 12, 5), glm::dvec3(0, 60, -25)}) {
        const auto blend = static_cast<Blend>(b);
        const TurnTable table(blend, angle);
        constexpr double h = 1e-5;
        glm::dvec3 slope;
        for (int i = 0; i < 3; ++i) {
          glm::dvec3 step(0);
          step[i] = h;
          slope[i] = (share_at(p + step) - share_at(p - step)) / (2 * h);
        }
        const TurnTable::Values at = table.at(static_cast<float>(share_at(p)));
        const glm::dvec3 away = p - axis * glm::dot(axis, p);
        const double det =
            at.volume + at.away * glm::dot(away, slope) + at.about * glm::dot(glm::cross(axis, p), slope);
        INFO(blend_rules()[b]->word, " turned by ", angle);
        CHECK(det == doctest::Approx(volume_ratio(blend, angle, axis, p)).epsilon(2e-3));
      }
}

TEST_CASE("turn table: a share of 0 stays, a share of 1 turns by the whole angle, and half by half of it") {
  for (std::size_t b = 0; b < blend_rules().size(); ++b)
    for (const double angle : {-1.5, 0.3, 2.0}) {
      const TurnTable table(static_cast<Blend>(b), angle);
      CHECK(table.angle_at(0).first == doctest::Approx(0));
      CHECK(table.angle_at(1).first == doctest::Approx(angle));
      CHECK(table.angle_at(0.5).first == doctest::Approx(angle / 2));
    }
}
