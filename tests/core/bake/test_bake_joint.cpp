// SPDX-License-Identifier: AGPL-3.0-or-later
// Compares a baked joint with poses that are solved here one by one, each in its own steps from rest to its angle.
// Which tissue is meshed, and which tissue belongs to the joint, depends on the range that is baked; therefore each of
// these solves is given the end of that range.
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
#include "core/deform/preview_map.h"
#include "core/phantom/phantom.h"
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
  Posed posed(double degrees, const Method& method, const BakedJoints& baked) const {
    ResampleSettings resampling;
    resampling.displacement = true;
    resampling.baked = baked;
    const double end = degrees < 0 ? settings.low : settings.high;
    std::optional<Posed> first;
    resample_sequence(body.file.volume, body.tissues, body.rig, bound.weights, {bent(degrees), bent(end)}, method,
                      resampling, [&](std::size_t place, Posed posed) {
                        if (place == 0) first = std::move(posed);
                      });
    return std::move(*first);
  }
  // Compares the posed volume with the solved volume of this angle. For each voxel of soft tissue, takes the distance
  // in mm between the two rest positions that the volumes show there. Returns the distances in ascending order. Leaves
  // out voxels where blending without the baked joint already agrees with the solve.
  //   is_corrected  true: the posed volume uses the baked joint; false: dual quaternions alone
  std::vector<double> distances(double degrees, bool is_corrected) const {
    const Posed solved = posed(degrees, Fem{.contact = true, .quality = FemQuality::Draft, .is_exact = true}, {}),
                blended = posed(degrees, Blend::DualQuaternion, {}),
                corrected = posed(degrees, Blend::DualQuaternion, {joint});
    REQUIRE(solved.report.solve->converged);
    const LabelSets labels(body.tissues);
    // Returns the displacement that the posed volume `other` has at the world position of a voxel of the solved volume;
    // nothing if `other` has bone or air there.
    const auto at = [&](const Posed& other, const glm::ivec3& voxel) -> std::optional<glm::vec3> {
      const Grid& grid = other.volume.grid;
      const glm::dvec3 world = world_from_voxel(solved.volume.grid) * glm::dvec3(voxel);
      const glm::ivec3 there(glm::round(voxel_from_world(grid) * world));
      if (!grid.contains(there) || !labels.soft[other.volume.at(there)] || other.volume.at(there) == 0) return {};
      return other.displacement[grid.index(there)];
    };
    std::vector<double> found;
    glm::ivec3 v;
    for (v.z = 0; v.z < solved.volume.grid.size.z; ++v.z)
      for (v.y = 0; v.y < solved.volume.grid.size.y; ++v.y)
        for (v.x = 0; v.x < solved.volume.grid.size.x; ++v.x) {
          const auto here = at(solved, v), plain = at(blended, v), baked = at(corrected, v);
          if (!here || !plain || !baked || glm::distance(*here, *plain) < 0.1) continue;
          found.push_back(glm::distance(is_corrected ? *baked : *plain, *here));
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

TEST_CASE("bake joint: rest is a baked angle without shifts, and both ends of the range are baked" *
          doctest::test_suite("slow")) {
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

TEST_CASE("bake joint: at a baked angle and between two, flesh lies where a solve of that angle has it" *
          doctest::test_suite("slow")) {
  for (const double degrees : {45.0, 37.5, 67.5, -7.5}) {
    CAPTURE(degrees);
    const std::vector<double> blended = elbow().distances(degrees, false), baked = elbow().distances(degrees, true);
    CHECK(part_of(baked, 0.95) < 1.0);
    CHECK(part_of(baked, 0.5) < 0.25 * part_of(blended, 0.5));
  }
}

TEST_CASE("bake joint: the stated error between baked angles is that of a solve there" * doctest::test_suite("slow")) {
  for (const BakeError& stated : elbow().joint->between) {
    if (stated.degrees < 20) continue;
    CAPTURE(stated.degrees);
    const double found = part_of(elbow().distances(stated.degrees, true), 0.95);
    CHECK(std::abs(found - stated.flesh_mm) < 0.5);
  }
}

TEST_CASE("bake joint: 1 thread and 2 threads bake the same bytes" * doctest::test_suite("slow")) {
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

TEST_CASE("bake joint: a baked pose keeps more volume than blending, and the rest pose is the body bit for bit" *
          doctest::test_suite("slow")) {
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

TEST_CASE("bake joint: the live preview shows the baked shape, skin included, with small and with large cells" *
          doctest::test_suite("slow")) {
  const BakedElbow& arm = elbow();
  const Pose pose = arm.bent(60);
  const auto motions = posed_from_rest(arm.body.rig, pose);
  const auto bent = joints_in_pose({arm.joint}, arm.body.rig, pose);
  const Posed posed = arm.posed(60, Blend::DualQuaternion, {arm.joint});
  const LabelSets labels(arm.body.tissues);
  const glm::dvec3 shift = glm::round(voxel_from_world(arm.body.file.volume.grid) * posed.volume.grid.origin);
  const BakedFlesh flesh(arm.bound.tissue, arm.body.file.volume.grid, bent);
  const AffineTransform voxel = voxel_from_world(arm.body.file.volume.grid);
  // Compares the rest positions that the map gives with those of the posed volume, in skin that the baked joint moves.
  // Returns the median and the 90th percentile of their distances, mm.
  const auto off = [&](const PreviewMap& map) {
    std::vector<double> found;
    std::int64_t i = 0;
    glm::ivec3 v;
    for (v.z = 0; v.z < posed.volume.grid.size.z; ++v.z)
      for (v.y = 0; v.y < posed.volume.grid.size.y; ++v.y)
        for (v.x = 0; v.x < posed.volume.grid.size.x; ++v.x, ++i) {
          const Label label = posed.volume.voxels[i];
          const glm::dvec3 at = glm::dvec3(v) + shift;
          const glm::dvec3 from = at - voxel.linear * glm::dvec3(posed.displacement[i]);
          if (!labels.skin[label] || glm::length(flesh.shift_at(from + 0.5)) < 0.2) continue;
          const auto rest = map.rest_at(at);
          if (!rest) continue;
          const AffineTransform world = world_from_voxel(arm.body.file.volume.grid);
          found.push_back(glm::distance(world.linear * (at - *rest), glm::dvec3(posed.displacement[i])));
        }
    REQUIRE(found.size() > 300);
    std::sort(found.begin(), found.end());
    return std::pair(part_of(found, 0.5), part_of(found, 0.9));
  };
  for (const int step : {2, 4}) {
    CAPTURE(step);
    LivePreview preview(std::make_shared<const LabelVolume>(arm.body.file.volume), arm.body.tissues, arm.bound.tissue,
                        arm.bound.weights, step);
    const auto plain = off(*preview.update(motions, Blend::DualQuaternion));
    const auto baked = off(*preview.update(motions, Blend::DualQuaternion, {}, bent));
    CHECK(baked.first < (step == 2 ? 0.4 : 0.7) * plain.first);
    CHECK(baked.second < (step == 2 ? 0.3 : 0.7) * plain.second);
    // An update without the baked joint gives the same map as if no joint had been baked. An update with the baked
    // joint does not depend on the poses that were shown before.
    const auto without = preview.update(motions, Blend::DualQuaternion);
    CHECK(off(*without) == plain);
    preview.update(posed_from_rest(arm.body.rig, arm.bent(20)), Blend::DualQuaternion, {},
                   joints_in_pose({arm.joint}, arm.body.rig, arm.bent(20)));
    CHECK(off(*preview.update(motions, Blend::DualQuaternion, {}, bent)) == baked);
  }
}

TEST_CASE("bake joint: what cannot be baked is said in one line" * doctest::test_suite("slow")) {
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

TEST_CASE("bake joint: another volume, rig, weights or bones are refused, each by its name" *
          doctest::test_suite("slow")) {
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
  CHECK(refusal(volume, LabelSet(65536, 0), arm.body.rig, arm.bound.weights).find("other bone labels") !=
        std::string::npos);
}
