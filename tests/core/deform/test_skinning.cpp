// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/deform/skinning.h"

#include <cmath>
#include <cstdio>
#include <numbers>
#include <set>
#include <string>

#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

#include "core/base/file.h"
#include "core/deform/blend_rule.h"
#include "tests/support/shared_data.h"

using namespace limber;

namespace {

constexpr double kPi = std::numbers::pi;
const Blend kBlends[] = {Blend::Linear, Blend::DualQuaternion, Blend::Mixed};

RigidTransform turn(double degrees, const glm::dvec3& axis, const glm::dvec3& about) {
  return rotation_about(about, glm::angleAxis(degrees * kPi / 180, glm::normalize(axis)));
}

std::string output_of(const std::string& command) {
  std::string text;
  FILE* pipe = popen((command + " 2>&1").c_str(), "r");
  REQUIRE(pipe != nullptr);
  char buffer[4096];
  for (size_t n; (n = fread(buffer, 1, sizeof buffer, pipe)) > 0;) text.append(buffer, n);
  pclose(pipe);
  return text;
}

}  // namespace

TEST_CASE("skinning: bones at rest leave every point as it is, bit for bit") {
  const std::vector<SkinTransform> bones = skin_transforms(std::vector<RigidTransform>(3));
  const std::vector<BoneWeight> influences = {{0, 0.3}, {2, 0.1}, {1, 0.37}};
  for (Blend blend : kBlends)
    for (double x : {0.1, 1e5, -3.3333333333333335})
      CHECK(blend_point(blend, bones, influences, {x, x / 3, -x / 7}) == glm::dvec3(x, x / 3, -x / 7));
}

TEST_CASE("skinning: one bone moves its points rigidly, whatever the sum of weights") {
  const RigidTransform posed_from_rest = turn(133, {1, 2, -0.5}, {30, -20, 400});
  const std::vector<SkinTransform> bones = {skin_transform(posed_from_rest)};
  const glm::dvec3 p(12, 340, -56);
  for (Blend blend : kBlends)
    for (double weight : {1.0, 0.25, 3.0})
      CHECK(glm::distance(blend_point(blend, bones, std::vector<BoneWeight>{{0, weight}}, p), posed_from_rest * p) <
            1e-10);
}

TEST_CASE("skinning: no influence leaves the point at rest") {
  const std::vector<SkinTransform> bones = {skin_transform(turn(90, {0, 0, 1}, {1, 2, 3}))};
  for (Blend blend : kBlends) {
    CHECK(blend_point(blend, bones, {}, {5, 6, 7}) == glm::dvec3(5, 6, 7));
    CHECK(blend_point(blend, bones, std::vector<BoneWeight>{{0, 0.0}}, {5, 6, 7}) == glm::dvec3(5, 6, 7));
  }
}

TEST_CASE("skinning: twisting the forearm keeps its thickness with dual quaternions, not with linear blend") {
  const std::vector<SkinTransform> bones = skin_transforms({{}, turn(120, {0, 0, 1}, {0, 0, 0})});
  const std::vector<BoneWeight> half = {{0, 0.5}, {1, 0.5}};
  auto radius = [](const glm::dvec3& p) { return std::hypot(p.x, p.y); };
  CHECK(radius(blend_point(Blend::DualQuaternion, bones, half, {40, 0, 10})) == doctest::Approx(40).epsilon(1e-12));
  CHECK(radius(blend_point(Blend::Linear, bones, half, {40, 0, 10})) == doctest::Approx(20).epsilon(1e-12));
  CHECK(radius(blend_point(Blend::Mixed, bones, half, {40, 0, 10})) >
        radius(blend_point(Blend::Linear, bones, half, {40, 0, 10})));
}

TEST_CASE("skinning: dual quaternions blend alike when a bone's quaternion has the other sign") {
  const RigidTransform a = turn(80, {0, 1, 0}, {5, 0, 0});
  RigidTransform b = turn(-40, {0, 1, 1}, {5, 0, 9});
  const std::vector<BoneWeight> influences = {{0, 0.4}, {1, 0.6}};
  const glm::dvec3 once = blend_point(Blend::DualQuaternion, skin_transforms({a, b}), influences, {1, 2, 3});
  b.rotation = -b.rotation;
  CHECK(glm::distance(once, blend_point(Blend::DualQuaternion, skin_transforms({a, b}), influences, {1, 2, 3})) <
        1e-12);
}

TEST_CASE("skinning: a matrix that stretches a bone moves a point of that bone alone like the matrix") {
  glm::dmat4 stretch(1);
  stretch[1][1] = 1.4;
  const glm::dmat4 rest = glm::dmat4(glm::mat4_cast(glm::angleAxis(0.7, glm::normalize(glm::dvec3(1, 2, 3)))));
  const glm::dmat4 m = glm::mat4_cast(glm::angleAxis(1.1, glm::dvec3(0, 0, 1))) * rest * stretch * glm::inverse(rest);
  const SkinTransform bone = skin_transform(m, rest);
  CHECK(bone.has_stretch);
  for (Blend blend : kBlends)
    CHECK(glm::distance(blend_point(blend, std::vector{bone}, std::vector<BoneWeight>{{0, 1.0}}, {3, 4, 5}),
                        glm::dvec3(m * glm::dvec4(3, 4, 5, 1))) < 1e-12);
}

TEST_CASE("skinning: many points at once equal one at a time") {
  const std::vector<SkinTransform> bones =
      skin_transforms({turn(10, {1, 0, 0}, {0, 0, 1}), turn(70, {0, 1, 1}, {2, 0, 0})});
  std::vector<glm::dvec3> points;
  std::vector<BoneWeight> influences;
  std::vector<std::int64_t> offsets = {0};
  for (int i = 0; i < 10000; ++i) {
    points.emplace_back(i % 17, i % 31, i % 101);
    for (int k = 0; k < i % 3; ++k) influences.push_back({k, 0.1 + (i + k) % 7});
    offsets.push_back(std::ssize(influences));
  }
  for (Blend blend : kBlends) {
    std::vector<glm::dvec3> posed(points.size());
    blend_points(blend, bones, influences, offsets, points, posed);
    int differing = 0;
    for (size_t i = 0; i < points.size(); ++i)
      differing +=
          posed[i] !=
          blend_point(blend, bones, std::span(influences).subspan(offsets[i], offsets[i + 1] - offsets[i]), points[i]);
    CHECK(differing == 0);
  }
}

TEST_CASE("skinning: points of Blender's reference cases agree within 1e-6 of their extent" *
          doctest::test_suite("slow")) {
  for (const std::string name : {"elbow90", "man_arm", "scale", "twist170"}) {
    const std::string file = "reference/lbs_dq/" + name + ".json";
    NEEDS_SHARED(file);
    const auto reference = nlohmann::json::parse(read_file(test::shared_path(file)));
    double low[3] = {1e300, 1e300, 1e300}, high[3] = {-1e300, -1e300, -1e300};
    for (size_t i = 0; i < reference["rest"].size(); ++i) {
      low[i % 3] = std::min(low[i % 3], reference["rest"][i].get<double>());
      high[i % 3] = std::max(high[i % 3], reference["rest"][i].get<double>());
    }
    const double extent = std::max({high[0] - low[0], high[1] - low[1], high[2] - low[2]});
    for (const std::string method : {"lbs", "dqs"}) {
      const auto result =
          nlohmann::json::parse(output_of(std::string(LIMBER_PROGRAM) + " skin-points " +
                                          test::shared_path(file).string() + " --json --method " + method));
      const auto& expected = reference[std::string("deformed_") + (method[0] == 'l' ? "lbs" : "dq")];
      REQUIRE(result["points"].size() == expected.size());
      double largest = 0;
      for (size_t i = 0; i < expected.size(); ++i)
        largest = std::max(largest, std::abs(result["points"][i].get<double>() - expected[i].get<double>()));
      CAPTURE(name);
      CAPTURE(method);
      CHECK(largest / extent < 1e-6);
      MESSAGE(name, " ", method, ": largest error ", largest / extent, " of the extent");
    }
  }
}

TEST_CASE(
    "skinning: mixed blending goes a fixed share of the way from linear blending to dual quaternions, with stretches "
    "too") {
  std::vector<SkinTransform> bones = {skin_transform(turn(20, {0, 0, 1}, {5, 0, 0})),
                                      skin_transform(turn(130, {1, 0, 0.2}, {0, 8, 30}))};
  const std::vector<BoneWeight> influences = {{0, 0.35}, {1, 0.65}};
  const auto expected = [&](const glm::dvec3& p) {
    return glm::mix(blend_point(Blend::Linear, bones, influences, p),
                    blend_point(Blend::DualQuaternion, bones, influences, p), kQuaternionShare);
  };
  for (const glm::dvec3& p : {glm::dvec3(10, -4, 55), glm::dvec3(-30, 2, 0)})
    CHECK(glm::distance(blend_point(Blend::Mixed, bones, influences, p), expected(p)) < 1e-10);
  const SkinTransform together = blended_transform(Blend::Mixed, bones, influences);
  const BoneWeight whole{0, 1};
  CHECK(glm::distance(blend_point(Blend::Mixed, {&together, 1}, {&whole, 1}, {10, -4, 55}), expected({10, -4, 55})) <
        1e-10);
  glm::dmat4 stretched(1);
  stretched[1][1] = 1.5;
  bones[1] = skin_transform(stretched, glm::dmat4(1));
  CHECK(glm::distance(blend_point(Blend::Mixed, bones, influences, {3, 9, -2}), expected({3, 9, -2})) < 1e-10);
  std::vector<glm::dvec3> points = {{10, -4, 55}};
  blend_points(Blend::Mixed, bones, influences, std::vector<std::int64_t>{0, 2}, points, points);
  CHECK(glm::distance(points[0], expected({10, -4, 55})) < 1e-10);
}

TEST_CASE("skinning: blends have the names that commands give them") {
  CHECK(find_blend("lbs") == Blend::Linear);
  CHECK(find_blend("dqs") == Blend::DualQuaternion);
  CHECK(find_blend("mix") == Blend::Mixed);
  CHECK_FALSE(find_blend("fem").has_value());
}

TEST_CASE("skinning: every row of the table of blends has words of its own, and moves bones that agree as they move") {
  std::set<std::string> words;
  const RigidTransform motion = turn(70, {1, 2, 3}, {4, 5, 6});
  const std::vector<SkinTransform> bones = skin_transforms({motion, motion});
  const std::vector<BoneWeight> influences = {{0, 0.25}, {1, 0.75}};
  for (std::size_t i = 0; i < blend_rules().size(); ++i) {
    const BlendRule& rule = *blend_rules()[i];
    CAPTURE(rule.word);
    CHECK(words.insert(rule.word).second);
    CHECK(find_blend(rule.word) == static_cast<Blend>(i));
    CHECK(std::string(rule.description).ends_with("."));
    const glm::dvec3 p(7, -3, 2), expected = motion.rotation * p + motion.translation;
    CHECK(glm::distance(rule.point(bones, influences, p), expected) < 1e-12);
    CHECK(glm::distance(rule.stretched_point(bones, influences, p), expected) < 1e-12);
  }
}
