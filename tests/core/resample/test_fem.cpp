// SPDX-License-Identifier: AGPL-3.0-or-later
// Tests posing by finite elements from volume to volume.
#include "core/resample/fem_shape.h"

#include <map>

#include <doctest/doctest.h>

#include "core/base/parallel.h"
#include "core/binding/heat_diffusion.h"
#include "core/phantom/phantom.h"
#include "core/report/metrics.h"
#include "core/resample/resample.h"
#include "tests/support/bent_tube.h"

using namespace limber;

namespace {

struct Arm {
  Phantom phantom = make_arm_phantom(4);
  SkinWeights weights = diffuse_heat(phantom.volume, phantom.tissues, phantom.armature);

  Pose flexed(double degrees) const {
    Pose pose = rest_pose(phantom.armature);
    flex(pose, phantom.armature, require_bone(phantom.armature, "Forearm"), degrees);
    return pose;
  }
  Posed posed(const Pose& pose, const Method& method, const ResampleSettings& settings = {}) const {
    return resample(phantom.volume, phantom.tissues, phantom.armature, weights, pose, method, settings);
  }
};

// Returns the sum of |volume change| in %, over soft tissues of at least `voxels` voxels.
double summed_change(const VolumeMetrics& metrics, const TissueTable& tissues, std::int64_t voxels) {
  double sum = 0;
  for (const TissueChange& change : metrics.tissues)
    if (change.voxels_before >= voxels && !is_bone(tissues.find(change.label)->kind))
      sum += std::abs(change.volume_change_percent);
  return sum;
}

}  // namespace

TEST_CASE(
    "fem: where nothing bends the volume comes back bit for bit, and a body that turns as a whole turns rigidly") {
  for (const Grid& grid : {Grid{}, test::oblique_grid()}) {
    const test::BentTube tube = test::bent_tube(grid);
    const Posed rest =
        resample(tube.volume, tube.tissues, tube.rig, tube.weights, rest_pose(tube.rig), Fem{.contact = true});
    CHECK(rest.volume.grid == tube.volume.grid);
    CHECK(rest.volume.voxels == tube.volume.voxels);
    CHECK(rest.shape == nullptr);
    CHECK_FALSE(rest.report.mesh);
    CHECK_FALSE(rest.report.solve);
    Pose turned = rest_pose(tube.rig);
    turned.rotation[0] = glm::angleAxis(0.5, glm::normalize(glm::dvec3(1, 2, 3)));
    const Posed by_fem = resample(tube.volume, tube.tissues, tube.rig, tube.weights, turned, Fem{});
    CHECK(by_fem.volume.voxels ==
          resample(tube.volume, tube.tissues, tube.rig, tube.weights, turned, Blend::Linear).volume.voxels);
    CHECK_FALSE(by_fem.report.mesh);
  }
}

TEST_CASE(
    "fem: the bent arm keeps the volume of its tissues where dual quaternions lose it, its tets upright and its bones "
    "rigid") {
  const Arm arm;
  const Pose pose = arm.flexed(40);
  const Posed by_fem = arm.posed(pose, Fem{.spacing_mm = 10}), by_dqs = arm.posed(pose, Blend::DualQuaternion);
  const DeformReport& report = by_fem.report;
  REQUIRE(report.mesh);
  REQUIRE(report.solve);
  CHECK(report.solve->converged);
  CHECK(report.solve->reached == 1);
  CHECK(report.mesh->inverted == 0);
  CHECK(report.mesh->min_det_f > 0);
  CHECK(report.new_hole_voxels == 0);
  CHECK(report.dropped_voxels == 0);
  for (const auto& bone : report.bones) CHECK(bone.rigid_residual_mm < 0.01);

  // Measures all soft tissue by the mesh. Volume is kept for each patch of about eight tets of 10 mm, which spans
  // several muscles.
  double voxels = 0, gained = 0;
  for (const Tissue& tissue : arm.phantom.tissues.tissues) {
    const auto change = report.mesh->volume_change_percent.find(tissue.label);
    if (is_bone(tissue.kind) || change == report.mesh->volume_change_percent.end()) continue;
    const double count =
        double(std::count(arm.phantom.volume.voxels.begin(), arm.phantom.volume.voxels.end(), tissue.label));
    voxels += count;
    gained += count * change->second;
  }
  CHECK(std::abs(gained / voxels) < 0.5);

  // Measures the volume change of each tissue by voxels.
  const double fem =
      summed_change(compare(arm.phantom.volume, by_fem.volume, arm.phantom.tissues), arm.phantom.tissues, 1000);
  const double dqs =
      summed_change(compare(arm.phantom.volume, by_dqs.volume, arm.phantom.tissues), arm.phantom.tissues, 1000);
  INFO("summed change of volume, percent: fem ", fem, ", dual quaternions ", dqs);
  CHECK(fem < 0.3 * dqs);
}

TEST_CASE("fem: the arm's tendons, thousands of times stiffer than its flesh, do not keep the elbow from bending" *
          doctest::test_suite("slow")) {
  const Arm arm;
  CHECK(std::any_of(arm.phantom.tissues.tissues.begin(), arm.phantom.tissues.tissues.end(), [](const Tissue& tissue) {
    return tissue.kind == TissueKind::Tendon && tissue.young_modulus > 1e6;
  }));
  const Posed posed = arm.posed(arm.flexed(60), Fem{.contact = true, .quality = FemQuality::Draft});
  REQUIRE(posed.report.solve);
  INFO(posed.report.solve->blocked_by);
  CHECK(posed.report.solve->converged);
  CHECK(posed.report.mesh->inverted == 0);
  CHECK(posed.report.mesh->min_det_f > 0.04);
}

TEST_CASE("fem: the result is the same for 1 and 2 threads, bit for bit, of one joint and of several with contact" *
          doctest::test_suite("slow")) {
  const Arm arm;
  Pose several = arm.flexed(35);
  for (const char* bone : {"Hand", "MiddleProximal"})
    several.rotation[require_bone(arm.phantom.armature, bone)] = glm::angleAxis(0.4, glm::dvec3(1, 0, 0));
  for (const auto& [pose, contact] : {std::pair{arm.flexed(20), false}, {several, true}}) {
    CAPTURE(contact);
    std::vector<Posed> results;
    for (int threads : {1, 2}) {
      ThreadCount limit(threads);
      results.push_back(arm.posed(pose, Fem{.contact = contact, .quality = FemQuality::Draft}, {.displacement = true}));
    }
    REQUIRE(results[0].shape);
    CHECK(results[0].report.solve->steps > 0);
    CHECK(results[0].shape->V == results[1].shape->V);
    CHECK(results[0].volume.voxels == results[1].volume.voxels);
    CHECK(results[0].displacement == results[1].displacement);
  }
}

namespace {

// Bends a tube of 1 mm voxels that is long enough to fold onto itself.
Posed folded(double degrees, const Fem& fem) {
  const test::BentTube tube = test::bent_tube({}, 84);
  return resample(tube.volume, tube.tissues, tube.rig, tube.weights, tube.pose(degrees), fem);
}

}  // namespace

TEST_CASE(
    "fem: with contact two parts of a limb that meet share no voxels, without it they do, and each says how much") {
  const Posed through = folded(120, {.spacing_mm = 4}), touching = folded(120, {.contact = true, .spacing_mm = 4});
  for (const Posed* result : {&through, &touching}) {
    CHECK(result->report.solve->converged);
    CHECK(result->report.mesh->inverted == 0);
    CHECK(result->report.new_hole_voxels == 0);
    REQUIRE(result->report.mesh->self_intersections);
  }
  CHECK(through.report.overlap_voxels > 50);
  CHECK(*through.report.mesh->self_intersections > 0);
  CHECK(touching.report.overlap_voxels < 0.05 * through.report.overlap_voxels);
  CHECK(*touching.report.mesh->self_intersections == 0);
  REQUIRE(touching.report.mesh->min_gap_mm);
  CHECK(*touching.report.mesh->min_gap_mm > 0);
}

TEST_CASE("fem: a pose out of reach ends at the last good place on the way, and says what stands in the way" *
          doctest::test_suite("slow")) {
  const Posed result = folded(179, {.contact = true, .spacing_mm = 4});
  REQUIRE(result.report.solve);
  CHECK_FALSE(result.report.solve->converged);
  CHECK(result.report.solve->reached > 0.3);
  CHECK(result.report.solve->reached < 1);
  CHECK_FALSE(result.report.solve->blocked_by.empty());
  CHECK(result.report.mesh->inverted == 0);
  CHECK(result.report.new_hole_voxels == 0);
  CHECK(result.shape->reached == result.report.solve->reached);
  for (const auto& bone : result.report.bones) CHECK(bone.rigid_residual_mm < 0.01);
}

TEST_CASE("fem: the gap between skins and the tolerance follow the tets, also where a finger asks for finer tets" *
          doctest::test_suite("slow")) {
  const Arm arm;
  const auto parameters = [&](const Pose& pose) {
    const Posed posed = arm.posed(pose, Fem{.contact = true, .quality = FemQuality::Draft});
    REQUIRE(posed.report.solve);
    CHECK(posed.report.solve->reached == 1);
    return posed.report.solve->parameters;
  };
  Pose both = arm.flexed(5);
  flex(both, arm.phantom.armature, require_bone(arm.phantom.armature, "IndexMiddle"), 5);
  const SolveParameters of_elbow = parameters(arm.flexed(5)), of_both = parameters(both);
  REQUIRE(of_elbow.contact_mm);
  REQUIRE(of_both.contact_mm);
  CHECK(of_both.tet_mm < 0.9 * of_elbow.tet_mm);
  // The gap at which contact begins follows the size of the tets. Counted in tets, it may shrink to 0.7 of its width
  // where the finger asks for finer tets, but may not grow.
  const double share = (*of_both.contact_mm / of_both.tet_mm) / (*of_elbow.contact_mm / of_elbow.tet_mm);
  CHECK(share > 0.7);
  CHECK(share <= 1 + 1e-9);
  CHECK(of_both.tolerance_mm / of_both.tet_mm == doctest::Approx(of_elbow.tolerance_mm / of_elbow.tet_mm));
}

TEST_CASE("fem: fingers close onto each other and the palm, and pass through neither" * doctest::test_suite("slow")) {
  const Phantom phantom = make_arm_phantom(3);
  const SkinWeights weights = diffuse_heat(phantom.volume, phantom.tissues, phantom.armature);
  Pose pose = rest_pose(phantom.armature);
  const auto bend = [&](const char* bone, double degrees) {
    flex(pose, phantom.armature, require_bone(phantom.armature, bone), degrees);
  };
  for (const std::string finger : {"Ring", "Little"}) {
    bend((finger + "Proximal").c_str(), 70);
    bend((finger + "Middle").c_str(), 80);
    bend((finger + "Distal").c_str(), 45);
  }
  const Posed posed = resample(phantom.volume, phantom.tissues, phantom.armature, weights, pose,
                               Fem{.contact = true, .quality = FemQuality::Fine});
  REQUIRE(posed.report.solve);
  INFO(posed.report.solve->blocked_by);
  CHECK(posed.report.solve->converged);
  CHECK(posed.report.mesh->inverted == 0);
  CHECK(posed.report.mesh->min_det_f > 0.02);
  REQUIRE(posed.report.mesh->self_intersections);
  CHECK(*posed.report.mesh->self_intersections == 0);
  REQUIRE(posed.report.mesh->min_gap_mm);  // set only if parts touch
  CHECK(*posed.report.mesh->min_gap_mm < 2);
  CHECK(posed.report.new_hole_voxels == 0);
  const auto all = [](const LabelVolume& volume) {
    return double(std::count_if(volume.voxels.begin(), volume.voxels.end(), [](Label label) { return label != 0; }));
  };
  CHECK(std::abs(all(posed.volume) / all(phantom.volume) - 1) < 0.005);
  MESSAGE("closed in ", posed.report.solve->iterations, " iterations, ", posed.report.mesh->tets, " tets, overlap ",
          posed.report.overlap_voxels);
}

TEST_CASE(
    "fem: frames of a sequence share one mesh and start from the one before, in fewer iterations than from rest") {
  const test::BentTube tube = test::bent_tube({}, 84);
  const std::vector<Pose> poses = {tube.pose(40), tube.pose(50), tube.pose(50), tube.pose(60)};
  const Fem fem{.contact = true, .spacing_mm = 4};
  std::vector<Posed> frames;
  resample_sequence(tube.volume, tube.tissues, tube.rig, tube.weights, poses, fem, {},
                    [&](std::size_t place, Posed posed) {
                      CHECK(place == frames.size());
                      frames.push_back(std::move(posed));
                    });
  REQUIRE(frames.size() == poses.size());
  for (const Posed& frame : frames) {
    REQUIRE(frame.shape);
    CHECK(frame.report.solve->converged);
    CHECK(frame.report.mesh->inverted == 0);
    CHECK(frame.report.mesh->self_intersections == 0);
    CHECK(frame.shape->model.fem.mesh.V == frames[0].shape->model.fem.mesh.V);
  }
  // The limit in mm is twice the solver's tolerance.
  CHECK((frames[2].shape->V - frames[1].shape->V).rowwise().norm().maxCoeff() < 0.6);
  CHECK(frames[2].report.solve->iterations <= 3);

  // Solves the last pose from rest, for comparison.
  const Posed direct = resample(tube.volume, tube.tissues, tube.rig, tube.weights, poses[3], fem);
  CHECK(frames[3].report.solve->iterations < direct.report.solve->iterations);
  const auto soft = [](const LabelVolume& volume) {
    return std::count_if(volume.voxels.begin(), volume.voxels.end(),
                         [](Label label) { return label == test::kFat || label == test::kSkin; });
  };
  CHECK(double(std::abs(soft(direct.volume) - soft(frames[3].volume))) < 0.003 * double(soft(direct.volume)));
}

TEST_CASE("fem: what a later frame of a sequence presses waits for it") {
  const test::BentTube tube = test::bent_tube({}, 120);
  const TissueVoxels tissue(tube.volume);
  LabelSet is_bone(65536, 0);
  is_bone[test::kBone] = 1;
  FemSequence sequence(tube.volume, tissue, tube.tissues, is_bone, tube.weights, tube.rig,
                       {tube.pose(55), tube.pose(110), tube.pose(165)}, {.contact = true, .spacing_mm = 6});
  // For each pose: node that moves with a bone at first -> position on the path until which it does so.
  std::vector<std::map<int, double>> waiting;
  for (int leg = 0; leg < 3; ++leg) {
    const auto shape = sequence.next();
    REQUIRE(shape);
    waiting.emplace_back();
    for (const auto& each : shape->model.fem.waiting) waiting.back()[each.node] = each.until;
  }
  REQUIRE(!waiting[1].empty());
  for (int leg = 1; leg < 3; ++leg)
    for (const auto& [node, until] : waiting[0]) {
      CHECK(waiting[leg].count(node) == std::size_t(until > leg));
      if (until > leg) CHECK(waiting[leg][node] == doctest::Approx(until - leg));
    }
}

TEST_CASE("resample: a sequence is its poses one by one, with blends") {
  const test::BentTube tube = test::bent_tube();
  const std::vector<Pose> poses = {tube.pose(30), rest_pose(tube.rig), tube.pose(-20, 15)};
  std::size_t count = 0;
  resample_sequence(tube.volume, tube.tissues, tube.rig, tube.weights, poses, Blend::DualQuaternion, {},
                    [&](std::size_t place, Posed posed) {
                      CHECK(posed.volume.voxels == resample(tube.volume, tube.tissues, tube.rig, tube.weights,
                                                            poses[place], Blend::DualQuaternion)
                                                       .volume.voxels);
                      ++count;
                    });
  CHECK(count == poses.size());
}
