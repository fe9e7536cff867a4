// SPDX-License-Identifier: AGPL-3.0-or-later
// The shapes that a baked joint is compared with are solved here, on meshes of their own.
#include "core/bake/bake_joint.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <tuple>

#include <doctest/doctest.h>

#include "core/bake/baked_joint_io.h"
#include "core/base/parallel.h"
#include "core/body/pose_body.h"
#include "core/deform/bake_source.h"
#include "core/deform/baked_flesh.h"
#include "core/phantom/phantom.h"
#include "core/resample/fem_shape.h"
#include "core/resample/posed_points.h"
#include "core/resample/posed_voxels.h"

using namespace limber;

namespace {

Body phantom_arm() {
  Phantom arm = make_arm_phantom(5);
  VolumeFile file{std::move(arm.volume), arm.tissues, {"NRRD", "uint8", false}, {}};
  return make_body(std::move(file), &arm.tissues, arm.armature, {}, {}, "arm.nrrd");
}

struct BakedElbow {
  Body body = phantom_arm();
  BoundBody bound = bind_body(body, Binding::Heat, {}, no_progress());
  int bone = require_bone(body.rig, "Forearm");
  BakeSettings settings{.low = -15, .high = 75, .angles = 6, .quality = FemQuality::Draft, .glide = "off"};
  JointBake bake = bake_joint(body, bound, bone, settings, no_progress());
  std::shared_ptr<const BakedJoint> joint = std::make_shared<const BakedJoint>(bake.joint);

  Pose bent(double degrees) const {
    Pose pose = rest_pose(body.rig);
    flex(pose, body.rig, bone, degrees);
    return pose;
  }
  std::vector<glm::dvec3> soft_voxels() const {
    const LabelSets labels(body.tissues);
    const AffineTransform world = world_from_voxel(body.file.volume.grid);
    std::vector<glm::dvec3> points;
    bound.tissue.for_each([&](std::int64_t, const glm::ivec3& v) {
      if (!labels.bone[body.file.volume.at(v)]) points.push_back(world * glm::dvec3(v));
    });
    return points;
  }
  // Distances of the soft voxels from where finite elements pose them, ascending, mm; voxels that neither moves from
  // the blended place are left out.
  std::vector<double> distances(double degrees, bool is_corrected) const {
    const LabelVolume& volume = body.file.volume;
    const std::vector<glm::dvec3> rest = soft_voxels();
    const Pose pose = bent(degrees);
    const LabelSets labels(body.tissues);
    const auto shape = solve_shape(volume, bound.tissue, body.tissues, labels.bone, bound.weights, body.rig, pose,
                                   {.contact = true, .quality = FemQuality::Draft});
    REQUIRE(shape);
    REQUIRE(shape->solve.converged);
    const auto points = [&](const FemShape* solved) {
      return posed_points(volume, bound.tissue, body.tissues, bound.weights, body.rig, pose, Blend::DualQuaternion,
                          solved, rest);
    };
    const auto blended = points(nullptr), solved = points(shape.get());
    const BakedFlesh flesh(bound.tissue, volume.grid, joints_in_pose({joint}, body.rig, pose));
    const AffineTransform voxel = voxel_from_world(volume.grid), world = world_from_voxel(volume.grid);
    std::vector<double> found;
    for (std::size_t i = 0; i < rest.size(); ++i) {
      const glm::dvec3 shift = world.linear * glm::dvec3(flesh.shift_at(voxel * rest[i] + 0.5));
      if (glm::length(shift) < 0.1 && glm::distance(blended[i], solved[i]) < 0.1) continue;
      found.push_back(glm::distance(blended[i] + (is_corrected ? shift : glm::dvec3(0)), solved[i]));
    }
    std::sort(found.begin(), found.end());
    REQUIRE(found.size() > 1000);
    return found;
  }
};

const BakedElbow& elbow() {
  static const BakedElbow elbow;
  return elbow;
}

double part_of(const std::vector<double>& ascending, double share) {
  return ascending[static_cast<std::size_t>(share * double(ascending.size() - 1))];
}

}  // namespace

TEST_CASE("bake joint: rest is a baked angle without shifts, and both ends of the range are baked") {
  const BakedJoint& joint = *elbow().joint;
  CHECK(elbow().bake.all_reached);
  REQUIRE(joint.degrees.size() == 7);
  CHECK(joint.degrees.front() == -15);
  CHECK(joint.degrees.back() == doctest::Approx(75));
  for (std::size_t a = 0; a < joint.degrees.size(); ++a)
    CHECK(joint.shifts[a].size() == (joint.degrees[a] == 0 ? 0 : joint.nodes.size()));
  CHECK(joint.at_baked.size() == 6);
  CHECK(joint.between.size() == 6);
}

TEST_CASE("bake joint: at a baked angle and between two, flesh lies where a solve of that angle alone has it") {
  for (const double degrees : {45.0, 37.5, 67.5, -7.5}) {
    CAPTURE(degrees);
    const std::vector<double> blended = elbow().distances(degrees, false), baked = elbow().distances(degrees, true);
    CHECK(part_of(baked, 0.95) < 1.0);
    CHECK(part_of(baked, 0.5) < 0.25 * part_of(blended, 0.5));
  }
}

TEST_CASE("bake joint: the stated error between baked angles is that of a solve there") {
  for (const BakeError& stated : elbow().joint->between) {
    if (stated.degrees < 20) continue;
    CAPTURE(stated.degrees);
    const double found = part_of(elbow().distances(stated.degrees, true), 0.95);
    CHECK(std::abs(found - stated.flesh_mm) < 0.5);
  }
}

TEST_CASE("bake joint: 1 thread and 2 threads bake the same bytes") {
  const BakedElbow& arm = elbow();
  BakeSettings settings = arm.settings;
  settings.low = 0, settings.high = 40, settings.angles = 1;
  std::string bytes[2];
  for (int threads : {1, 2}) {
    const ThreadCount limit(threads);
    bytes[threads - 1] = encode(bake_joint(arm.body, arm.bound, arm.bone, settings, no_progress()).joint);
  }
  CHECK(bytes[0] == bytes[1]);
}

TEST_CASE("bake joint: a baked pose keeps more volume than blending, and the rest pose is the body bit for bit") {
  const BakedElbow& arm = elbow();
  BoundBody bound = arm.bound;
  const LabelVolume& volume = arm.body.file.volume;
  const auto posed_with = [&](const BakedJoints& baked, double degrees) {
    PosingSettings settings{.method = "dqs", .glide = "off"};
    settings.resample.baked = baked;
    std::optional<Posed> result;
    pose_body(
        arm.body, bound, {arm.bent(degrees)}, settings, {}, {},
        [&](BodyInPose& posed) { result = std::move(posed.posed); }, no_progress());
    return std::move(*result);
  };
  CHECK(posed_with({arm.joint}, 0).volume.voxels == volume.voxels);
  const auto tissue = [](const LabelVolume& labels) {
    return std::count_if(labels.voxels.begin(), labels.voxels.end(), [](Label label) { return label != 0; });
  };
  const double before = double(tissue(volume));
  const Posed blended = posed_with({}, 67.5), baked = posed_with({arm.joint}, 67.5);
  CHECK(std::abs(tissue(baked.volume) / before - 1) < 0.005);
  CHECK(std::abs(tissue(baked.volume) / before - 1) < 0.3 * std::abs(tissue(blended.volume) / before - 1));
  CHECK(baked.report.overlap_voxels < 0.1 * double(blended.report.overlap_voxels));
  REQUIRE(baked.report.baked.size() == 1);
  CHECK(baked.report.baked[0].degrees == doctest::Approx(67.5));
}

TEST_CASE("bake joint: what cannot be baked is said in one line") {
  const BakedElbow& arm = elbow();
  const auto refused = [&](int bone, BakeSettings settings) {
    CHECK_THROWS_AS(bake_joint(arm.body, arm.bound, bone, settings, no_progress()), Error);
  };
  refused(0, arm.settings);
  for (const auto& [low, high, angles] :
       {std::tuple{10.0, 50.0, 3}, {-1.0, 2.0, 3}, {-171.0, 0.0, 3}, {0.0, 90.0, 0}, {0.0, 90.0, 31}, {0.0, NAN, 3}}) {
    BakeSettings settings = arm.settings;
    settings.low = low, settings.high = high, settings.angles = angles;
    refused(arm.bone, settings);
  }
}

TEST_CASE("bake joint: another volume, rig, weights or bones are refused, each by its name") {
  const BakedElbow& arm = elbow();
  const LabelVolume& volume = arm.body.file.volume;
  const LabelSet is_bone = LabelSets(arm.body.tissues).bone;
  const auto refusal = [&](const LabelVolume& labels, const LabelSet& bones, const Armature& rig,
                           const SkinWeights& weights) -> std::string {
    try {
      check_source(*arm.joint, bake_source(labels, TissueVoxels(labels), bones, rig, weights));
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  };
  CHECK(refusal(volume, is_bone, arm.body.rig, arm.bound.weights) == "");
  LabelVolume other = volume;
  const auto changed = std::find_if(other.voxels.begin(), other.voxels.end(), [](Label label) { return label > 1; });
  *changed = 1;
  CHECK(refusal(other, is_bone, arm.body.rig, arm.bound.weights).find("another volume") != std::string::npos);
  LabelVolume moved = volume;
  moved.grid.origin.x += 1;
  CHECK(refusal(moved, is_bone, arm.body.rig, arm.bound.weights).find("another volume") != std::string::npos);
  Armature rig = arm.body.rig;
  rig.bones[1].head.x += 0.5;
  CHECK(refusal(volume, is_bone, rig, arm.bound.weights).find("another rig") != std::string::npos);
  const SkinWeights weights(arm.bound.weights.bones(), arm.bound.tissue);
  CHECK(refusal(volume, is_bone, arm.body.rig, weights).find("other weights") != std::string::npos);
  CHECK(refusal(volume, LabelSet(65536, 0), arm.body.rig, arm.bound.weights).find("other labels of bone") !=
        std::string::npos);
}
