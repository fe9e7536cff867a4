// SPDX-License-Identifier: AGPL-3.0-or-later
// Compares the estimated error of a solve with the difference from a solve with tets of half the edge length.
#include "core/resample/fem_error.h"

#include <cmath>
#include <cstdlib>

#include <doctest/doctest.h>

#include "core/base/progress.h"
#include "core/resample/fem_shape.h"
#include "core/resample/resample.h"
#include "tests/support/bent_tube.h"

using namespace limber;

namespace {

struct Case {
  double gap;  // gap between the two bones at rest, voxels
  double degrees, twist, tet_mm;
};

// A limb along z, 48 mm across, with two bones of 18 mm and a gap between them at the joint. Tets have 4.1 mm at normal
// quality, 6.2 mm at draft quality.
struct Limb {
  static constexpr int kMiddle = 14, kJoint = 35, kLength = 70;
  LabelVolume volume;
  TissueTable tissues = test::tube_tissues();
  Armature rig;
  SkinWeights weights;

  explicit Limb(double gap) {
    volume.grid.size = {2 * kMiddle, 2 * kMiddle, kLength};
    volume.grid.spacing = glm::dvec3(2);
    volume.voxels.assign(volume.grid.voxel_count(), 0);
    for (int z = 1; z < kLength - 1; ++z)
      for (int y = 0; y < 2 * kMiddle; ++y)
        for (int x = 0; x < 2 * kMiddle; ++x) {
          const double away = std::hypot(x + 0.5 - kMiddle, y + 0.5 - kMiddle);
          const bool is_bone = away < 4.5 && std::abs(z - kJoint) > gap / 2 && z > 4 && z < kLength - 5;
          if (away < 12) volume.at({x, y, z}) = is_bone ? test::kBone : away > 11 ? test::kSkin : test::kFat;
        }
    const double ends[] = {2, 2 * kJoint, 2 * (kLength - 2)}, middle = 2 * kMiddle - 1;
    for (int b = 0; b < 2; ++b) {
      Bone bone;
      bone.name = b ? "far" : "near";
      bone.parent = b - 1;
      bone.head = {middle, middle, ends[b]};
      bone.tail = {middle, middle, ends[b + 1]};
      rig.bones.push_back(bone);
    }
    const TissueVoxels tissue(volume);
    weights = SkinWeights({"near", "far"}, tissue);
    for (std::int64_t brick = 0; brick < weights.chunk_count(); ++brick) {
      SkinWeights::Influences chunk;
      tissue.for_each(brick, brick + 1, [&](std::int64_t, const glm::ivec3& v) {
        const double far = glm::smoothstep(-10.0, 10.0, double(v.z - kJoint));
        chunk.push_back(volume.at(v) == test::kBone ? rigid_influence(v.z > kJoint)
                                                    : quantize({{0, 1 - far}, {1, far}}));
      });
      weights.set_chunk(brick, chunk);
    }
  }

  std::shared_ptr<const FemShape> solved(const Case& the, double tet_mm, bool estimate) const {
    Pose pose = rest_pose(rig);
    pose.rotation[1] = glm::angleAxis(glm::radians(the.degrees), glm::dvec3(1, 0, 0)) *
                       glm::angleAxis(glm::radians(the.twist), glm::dvec3(0, 0, 1));
    return resample(volume, tissues, rig, weights, pose,
                    Fem{.contact = the.degrees > 50,
                        .spacing_mm = tet_mm,
                        .reach_mm = the.tet_mm,
                        .estimates_error = estimate})
        .shape;
  }
};

// Returns the root mean square of the differences, weighted by the volume at rest, mm.
double rms(const FemShape& shape, const ShapeDifference& difference) {
  double squares = 0, whole = 0;
  for (std::size_t i = 0; i < difference.tet.size(); ++i) {
    const double volume = signed_volume(shape.model.fem.mesh.V, shape.model.fem.mesh.T.row(difference.tet[i]));
    squares += volume * difference.mm[i] * difference.mm[i];
    whole += volume;
  }
  return std::sqrt(squares / whole);
}

// Returns three cases, or all forty if LIMBER_ERROR_CASES is set.
std::vector<Case> cases() {
  if (!std::getenv("LIMBER_ERROR_CASES")) return {{3, 35, 0, 6.2}, {3, 60, 0, 6.2}, {6, 20, 30, 6.2}};
  std::vector<Case> all;
  for (const double gap : {3.0, 6.0})
    for (const double tet_mm : {6.2, 4.13})
      for (const double degrees : {15.0, 30.0, 45.0, 60.0, 75.0})
        for (const double twist : {0.0, 30.0}) all.push_back({gap, degrees, twist, tet_mm});
  return all;
}

}  // namespace

TEST_CASE("fem error: the estimate bounds the difference from tets of half the edge" * doctest::test_suite("slow")) {
  int bounded = 0, known = 0;
  double furthest = 0;
  for (const Case& the : cases()) {
    const Limb limb(the.gap);
    const auto shape = limb.solved(the, the.tet_mm, true), finer = limb.solved(the, the.tet_mm / 2, false);
    REQUIRE(shape);
    REQUIRE(finer);
    REQUIRE(shape->solve.error);
    const FemError& error = *shape->solve.error;
    if (!finer->solve.converged || !error.unknown.empty()) continue;
    ++known;
    const double truth = rms(*shape, difference_of(*shape, *finer, limb.volume.grid));
    INFO(the.gap, " ", the.degrees, " ", the.twist, " ", the.tet_mm, ": truth ", truth, " estimate ", error.rms_mm);
    CHECK(error.coarse_tet_mm == doctest::Approx(kCoarser * the.tet_mm));
    CHECK(error.rms_mm <= error.most_mm);
    CHECK(error.most_mm <= error.largest_mm);
    bounded += truth <= error.rms_mm;
    furthest = std::max(furthest, error.rms_mm / truth);
  }
  MESSAGE(bounded, " of ", known, " bounded, estimate at most ", furthest, " times the truth");
  CHECK(known >= 3);
  CHECK(bounded >= 0.9 * known);
  CHECK(furthest < 20);
}

TEST_CASE(
    "fem error: a second solve that fails leaves the result and is told, and one that is cancelled is cancelled") {
  class Failing : public Progress {
   public:
    explicit Failing(bool cancels) : cancels_(cancels) {}

   private:
    void on_update(std::string_view stage, double) override {
      if (stage != "error estimate") return;
      if (!cancels_) throw Error("no room", "the test", "make room");
      cancel();
    }
    bool cancels_;
  };
  const Limb limb(3);
  Pose pose = rest_pose(limb.rig);
  pose.rotation[1] = glm::angleAxis(glm::radians(20.0), glm::dvec3(1, 0, 0));
  const Fem fem{.spacing_mm = 12, .estimates_error = true};
  Failing fails(false), cancels(true);
  const Posed posed = resample(limb.volume, limb.tissues, limb.rig, limb.weights, pose, fem, {}, fails);
  REQUIRE(posed.report.solve);
  CHECK(posed.report.solve->converged);
  REQUIRE(posed.report.solve->error);
  CHECK(posed.report.solve->error->unknown.find("no room") != std::string::npos);
  const Posed without = resample(limb.volume, limb.tissues, limb.rig, limb.weights, pose, Fem{.spacing_mm = 12});
  CHECK(posed.volume.voxels == without.volume.voxels);
  CHECK_THROWS_AS(resample(limb.volume, limb.tissues, limb.rig, limb.weights, pose, fem, {}, cancels), Cancelled);
}
