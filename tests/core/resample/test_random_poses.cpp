// SPDX-License-Identifier: AGPL-3.0-or-later
// Solves random poses of random bodies. Nothing may crash, hang, invert or yield numbers that are not finite, and a
// pose that is not reached must state a reason. LIMBER_RANDOM_POSES=300 runs 300 poses, LIMBER_RANDOM_POSE=7 runs pose
// 7 only, and with both the run starts at 7.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <ctime>
#include <set>

#include <doctest/doctest.h>

#include "core/base/error.h"
#include "core/binding/heat_diffusion.h"
#include "core/phantom/phantom.h"
#include "core/resample/fem_shape.h"
#include "core/resample/resample.h"
#include "core/rig/joint_limits.h"
#include "tests/support/random_limbs.h"

using namespace limber;
using namespace limber::test;

namespace {

double cpu_seconds() { return double(std::clock()) / CLOCKS_PER_SEC; }

struct Body {
  LabelVolume volume;
  TissueTable tissues;
  Armature rig;
  SkinWeights weights;
};

Body body_of(Phantom phantom) {
  SkinWeights weights = diffuse_heat(phantom.volume, phantom.tissues, phantom.armature);
  return {std::move(phantom.volume), std::move(phantom.tissues), std::move(phantom.armature), std::move(weights)};
}

struct Case {
  std::string name;
  const Body* body;
  Pose pose;
  Fem fem;
};

// Of ten cases, six are trees of tubes, two the procedural arm with its hand, two the whole body.
class Cases {
 public:
  Case at(unsigned seed) {
    RandomNumbers random(1000 + seed);
    Case one;
    one.fem.contact = !random.one_in(3);
    const bool allowed = random.one_in(2);
    if (seed % 10 < 6) {
      RandomLimbs limbs = random_limbs(seed);
      SkinWeights weights = diffuse_heat(limbs.volume, limbs.tissues, limbs.rig);
      tubes_ = {std::move(limbs.volume), std::move(limbs.tissues), std::move(limbs.rig), std::move(weights)};
      one.name = "tubes";
      one.body = &tubes_;
      one.pose = std::move(limbs.pose);
      one.fem.spacing_mm = random.any(5, 9);
      return one;
    }
    const bool arm = seed % 10 < 8;
    if (arm && arm_.volume.voxels.empty()) arm_ = body_of(make_arm_phantom(5));
    if (!arm && whole_.volume.voxels.empty()) whole_ = body_of(make_body_phantom(10));
    one.body = arm ? &arm_ : &whole_;
    one.name = std::string(arm ? "arm" : "body") + (allowed ? ", within limits" : ", beyond limits");
    one.fem.spacing_mm = arm ? random.any(10, 14) : random.any(40, 60);
    one.pose = rest_pose(one.body->rig);
    turn_joints(one.pose, random, 120);
    if (allowed)
      for (size_t b = 0; b < one.pose.rotation.size(); ++b)
        one.pose.rotation[b] = within_limits(one.body->rig.bones[b], one.pose.rotation[b]);
    return one;
  }

 private:
  Body tubes_, arm_, whole_;
};

void check_shape(const FemShape& shape, const Fem& fem) {
  const SolveReport& solve = shape.solve;
  CHECK(shape.V.allFinite());
  std::int64_t flat = 0;
  for (const double ratio : volume_ratios(shape.model.fem.mesh, shape.V)) flat += !(ratio > 0);
  CHECK(flat == 0);
  CHECK(shape.mesh.inverted == 0);
  CHECK(std::isfinite(shape.mesh.min_det_f));
  CHECK(solve.reached >= 0);
  CHECK((!solve.converged || solve.reached == 1));
  CHECK(solve.converged == solve.blocked_by.empty());
  CHECK(solve.bone_drift_mm <= std::max(2.0, *fem.spacing_mm / 2) + 1e-9);
  if (solve.converged)
    CHECK(solve.residual_mm < 0.9);  // mm; only of the few nodes that still move: all others are below 0.3
}

void check_volume(const Posed& posed, const Body& body) {
  const std::set<Label> known(body.volume.voxels.begin(), body.volume.voxels.end()),
      there(posed.volume.voxels.begin(), posed.volume.voxels.end());
  CHECK(std::includes(known.begin(), known.end(), there.begin(), there.end()));
  CHECK(posed.report.new_hole_voxels == 0);
  CHECK(posed.report.dropped_voxels == 0);
  for (const auto& bone : posed.report.bones) CHECK(bone.rigid_residual_mm < 0.01);
  const auto all = [](const LabelVolume& volume) {
    return double(std::count_if(volume.voxels.begin(), volume.voxels.end(), [](Label label) { return label != 0; }));
  };
  CHECK(all(posed.volume) > 0.5 * all(body.volume));
}

}  // namespace

TEST_CASE("random poses: finite elements never crash, hang or invert, and say what a pose is blocked by" *
          doctest::test_suite("slow")) {
  const char* asked = std::getenv("LIMBER_RANDOM_POSES");
  const char* one = std::getenv("LIMBER_RANDOM_POSE");
  const unsigned first = one ? unsigned(std::atoi(one)) : 0, end = one && !asked ? first + 1
                                                                   : asked       ? unsigned(std::atoi(asked))
                                                                                 : 10;
  Cases cases;
  int reached = 0, solved = 0, crossing = 0, refused = 0;
  double longest = 0;
  for (unsigned seed = first; seed < end; ++seed) {
    const Case random = cases.at(seed);
    CAPTURE(seed);
    CAPTURE(random.name);
    const double start = cpu_seconds();
    Posed posed;
    try {
      posed = resample(random.body->volume, random.body->tissues, random.body->rig, random.body->weights, random.pose,
                       random.fem);
    } catch (const Error& error) {
      // A pose is refused for one reason only: every moving bone is smaller than the tets.
      CHECK(std::string(error.what()).find("every moving bone is smaller") != std::string::npos);
      ++refused;
      continue;
    }
    const double seconds = cpu_seconds() - start;
    longest = std::max(longest, seconds);
    check_volume(posed, *random.body);
    if (!posed.shape) continue;
    check_shape(*posed.shape, random.fem);
    const SolveReport& solve = posed.shape->solve;
    ++solved;
    reached += solve.converged;
    const auto pairs = *posed.shape->mesh.self_intersections;
    crossing += random.fem.contact && pairs > 0;
    if (asked || one)
      MESSAGE(seed, " ", random.name, std::string(random.fem.contact ? ", contact: " : ": "), posed.shape->mesh.tets,
              " tets, ", seconds, " s, reached ", solve.reached, " ", solve.blocked_by, ", ", solve.iterations,
              " iterations, least det F ", posed.shape->mesh.min_det_f, ", crossing pairs ", pairs);
  }
  MESSAGE(solved, " solved: ", reached, " reached, ", crossing, " with contact cross themselves, ", refused,
          " refused; the longest took ", longest, " CPU seconds");
}
