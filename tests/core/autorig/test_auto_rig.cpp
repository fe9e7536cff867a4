// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/autorig/auto_rig.h"

#include <algorithm>
#include <cmath>

#include <doctest/doctest.h>
#include <glm/gtc/quaternion.hpp>

#include "core/autorig/rig_check.h"
#include "core/base/error.h"
#include "core/base/parallel.h"
#include "core/binding/heat_diffusion.h"
#include "core/phantom/phantom.h"
#include "core/resample/resample.h"
#include "core/rig/joint_ranges.h"
#include "core/rig/pose.h"
#include "core/rig_io/rig_io.h"
#include "core/rig_io/rig_templates.h"
#include "core/volume/distance_transform.h"
#include "core/volume_io/volume_io.h"
#include "tests/support/shared_data.h"

namespace limber {

namespace {

// Returns the distances in mm between joints of the same name. If `truth` has no bone of a name, its bone "Right" +
// name is taken.
std::vector<std::pair<double, std::string>> errors(const Armature& found, const Armature& truth) {
  std::vector<std::pair<double, std::string>> result;
  for (const Bone& bone : found.bones) {
    auto same = truth.find(bone.name);
    if (!same) same = truth.find("Right" + bone.name);
    if (same) result.push_back({glm::distance(bone.head, truth.bones[*same].head), bone.name});
  }
  return result;
}

double largest(const std::vector<std::pair<double, std::string>>& of) {
  double most = 0;
  for (const auto& [error, name] : of) most = std::max(most, error);
  return most;
}

double median_of_main(const std::vector<std::pair<double, std::string>>& of) {
  std::vector<double> main;
  for (const auto& [error, name] : of)
    for (const char* part : {"UpperArm", "Forearm", "Hand", "Thigh", "Shank", "Foot", "Neck"})
      if (name == part || name == std::string("Left") + part || name == std::string("Right") + part)
        main.push_back(error);
  REQUIRE(!main.empty());
  std::sort(main.begin(), main.end());
  return main[main.size() / 2];
}

const Phantom& arm() {
  static const Phantom phantom = make_arm_phantom(5);
  return phantom;
}

// A phantom whose grid and joints are turned, scaled and shifted in the world.
struct Moved {
  LabelVolume volume;
  Armature truth;
};
Moved moved(const Phantom& phantom, const glm::dmat3& by, double scale, const glm::dvec3& shift) {
  Moved result{phantom.volume, phantom.armature};
  Grid& grid = result.volume.grid;
  grid.direction = by * grid.direction;
  grid.spacing *= scale;
  grid.origin = scale * (by * grid.origin) + shift;
  for (Bone& bone : result.truth.bones)
    bone.head = scale * (by * bone.head) + shift, bone.tail = scale * (by * bone.tail) + shift;
  return result;
}

}  // namespace

TEST_CASE(
    "auto-fit: every joint of the procedural arm lies within 8 mm of the truth, with bone labels and nearly so "
    "without" *
    doctest::test_suite("slow")) {
  const AutoFit with = auto_fit(arm().volume, arm().tissues, rig_template("arm"));
  CHECK(largest(errors(with.armature, arm().armature)) < 8);
  CHECK(with.check.whole == doctest::Approx(1).epsilon(0.01));
  for (const JointFit& joint : with.joints) CHECK(joint.how == JointFit::How::BoneSurface);

  LabelVolume flesh = arm().volume;
  for (Label& voxel : flesh.voxels) voxel = voxel != 0;
  const AutoFit without = auto_fit(flesh, {}, rig_template("arm"));
  CHECK(median_of_main(errors(without.armature, arm().armature)) < 8);
  CHECK(without.joints[0].how == JointFit::How::Skin);
}

TEST_CASE("auto-fit: an arm that is turned, mirrored, shifted and of another size is found as well" *
          doctest::test_suite("slow")) {
  const glm::dmat3 oblique = glm::mat3_cast(glm::angleAxis(2.2, glm::normalize(glm::dvec3(0.5, 1, -0.3))));
  const glm::dmat3 mirror(-1, 0, 0, 0, 1, 0, 0, 0, 1);
  for (const auto& [by, scale] : {std::pair(oblique, 0.8), std::pair(mirror, 1.2)}) {
    const Moved other = moved(arm(), by, scale, {300, -200, 50});
    const AutoFit fitted = auto_fit(other.volume, arm().tissues, rig_template("arm"));
    CHECK(largest(errors(fitted.armature, other.truth)) < 8);
  }
}

TEST_CASE("auto-fit: every joint of the procedural body lies within 8 mm of the truth" * doctest::test_suite("slow")) {
  const Phantom body = make_body_phantom(7);
  const AutoFit fitted = auto_fit(body.volume, body.tissues, rig_template("adult"));
  CHECK(largest(errors(fitted.armature, body.armature)) < 8);
  CHECK(median_of_main(errors(fitted.armature, body.armature)) < 3);
}

TEST_CASE("auto-fit: where bones are labelled, a thick layer of fat does not move the joints" *
          doctest::test_suite("slow")) {
  const Phantom body = make_body_phantom(5);
  const Grid& lean = body.volume.grid;
  constexpr int kPadding = 4;
  Grid grid = lean;
  grid.size += 2 * kPadding;
  grid.origin = world_from_voxel(lean) * glm::dvec3(-kPadding);
  LabelVolume fat{grid, ZeroedVector<Label>(grid.voxel_count(), 0)};
  for (int z = 0; z < lean.size.z; ++z)
    for (int y = 0; y < lean.size.y; ++y)
      for (int x = 0; x < lean.size.x; ++x) fat.at(glm::ivec3(x, y, z) + kPadding) = body.volume.at({x, y, z});
  std::vector<std::uint8_t> tissue(grid.voxel_count());
  for (std::int64_t i = 0; i < grid.voxel_count(); ++i) tissue[i] = fat.voxels[i] != 0;
  const std::vector<float> squared = squared_distance({glm::ivec3(0), grid.size}, tissue, grid.spacing);
  for (std::int64_t i = 0; i < grid.voxel_count(); ++i)
    if (!tissue[i] && squared[i] < 11 * 11) fat.voxels[i] = 3;
  REQUIRE(body.tissues.find(3)->name == "fat");
  const AutoFit fitted = auto_fit(fat, body.tissues, rig_template("adult"));
  for (const auto& [error, name] : errors(fitted.armature, body.armature)) {
    CAPTURE(name);
    for (const char* part : {"UpperArm", "Forearm", "Thigh", "Foot", "Neck"})
      if (name.ends_with(part)) CHECK(error < 8);
  }
}

TEST_CASE("auto-fit: the template that suits an arm is the arm, with a hand of five fingers too" *
          doctest::test_suite("slow")) {
  CHECK(suggest_template(arm().volume) == "arm");
}

TEST_CASE("auto-fit: the result does not depend on the number of threads" * doctest::test_suite("slow")) {
  std::vector<Armature> results;
  for (int threads : {1, 3}) {
    const ThreadCount count(threads);
    results.push_back(auto_fit(arm().volume, arm().tissues, rig_template("arm")).armature);
  }
  CHECK(results[0] == results[1]);
}

TEST_CASE("auto-fit: a rig whose names mean nothing is laid into the tissue's extents, and says so") {
  Armature snake;
  for (int b = 0; b < 4; ++b)
    snake.bones.push_back(
        {.name = "S" + std::to_string(b), .parent = b - 1, .head = {0, 0, 10.0 * b}, .tail = {0, 0, 10.0 * (b + 1)}});
  const AutoFit fitted = auto_fit(arm().volume, arm().tissues, snake);
  CHECK(fitted.joints[0].how == JointFit::How::Extents);
  CHECK(!fitted.warnings.empty());
  CHECK(glm::distance(fitted.armature.bones[0].head, fitted.armature.bones[3].tail) > 300);
}

TEST_CASE("auto-fit: strange volumes are refused or rigged, never fatal") {
  LabelVolume volume{{{6, 5, 4}, {1, 1, 1}, {0, 0, 0}, glm::dmat3(1)}, ZeroedVector<Label>(120, 0)};
  CHECK_THROWS_AS(auto_fit(volume, {}, rig_template("adult")), Error);
  for (const char* name : {"arm", "adult", "quadruped"}) {
    std::fill(volume.voxels.begin(), volume.voxels.end(), 0);
    volume.voxels[50] = 1;
    CHECK_NOTHROW(auto_fit(volume, {}, rig_template(name)));
    std::fill(volume.voxels.begin(), volume.voxels.end(), 1);
    CHECK_NOTHROW(auto_fit(volume, {}, rig_template(name)));
  }
}

namespace {

double share_in_tissue(const LabelVolume& volume, const Armature& rig) { return check_rig(volume, rig).whole; }

// Returns the errors of the main joints, by their names in MakeHuman's rig, mm.
std::vector<std::pair<double, std::string>> main_errors(const Armature& found, const Armature& truth) {
  std::vector<std::pair<double, std::string>> result;
  for (const char* part : {"Arm", "ForeArm", "Hand", "UpLeg", "Leg", "Foot"})
    for (const char* side : {"Left", "Right"}) {
      const std::string name = std::string(side) + part;
      result.push_back(
          {glm::distance(found.bones[require_bone(found, name)].head, truth.bones[require_bone(truth, name)].head),
           name});
    }
  result.push_back(
      {glm::distance(found.bones[require_bone(found, "Neck")].head, truth.bones[require_bone(truth, "Neck")].head),
       "Neck"});
  std::sort(result.begin(), result.end());
  return result;
}

}  // namespace

TEST_CASE("auto-fit: bones drawn as rods are followed along their axes, and found though no table names them" *
          doctest::test_suite("slow")) {
  NEEDS_SHARED("data/makehuman/body_4mm.nrrd");
  const VolumeFile file = read_volume(test::shared_path("data/makehuman/body_4mm.nrrd"));
  const Armature truth = read_armature(test::shared_path("data/makehuman/body.armature.json"));
  const AutoFit fitted = auto_fit(file.volume, merge_tissue_tables(file.tissues, nullptr), truth);
  const auto found = main_errors(fitted.armature, truth);
  for (const auto& [error, name] : found) {
    CAPTURE(name);
    CHECK(error < (name == "Neck" ? 26 : 16));
  }
  CHECK(found[found.size() / 2].first < 12);
  CHECK(fitted.joints[require_bone(truth, "LeftLeg")].how == JointFit::How::BoneAxis);
  CHECK(fitted.check.whole > share_in_tissue(file.volume, truth) - 0.005);
  CHECK(fitted.warnings[0].starts_with("no tissue table says which labels are bone: label 4"));
}

TEST_CASE(
    "auto-fit: by its skin alone another body is rigged within a median of 15 mm, and what it does not tell is said" *
    doctest::test_suite("slow")) {
  NEEDS_SHARED("data/makehuman/body_4mm.nrrd");
  LabelVolume volume = read_volume(test::shared_path("data/makehuman/body_4mm.nrrd")).volume;
  for (Label& voxel : volume.voxels) voxel = voxel != 0;
  const Armature truth = read_armature(test::shared_path("data/makehuman/body.armature.json"));
  const AutoFit fitted = auto_fit(volume, {}, truth);
  const auto found = main_errors(fitted.armature, truth);
  CHECK(found[found.size() / 2].first < 15);
  for (const auto& [error, name] : found) {
    CAPTURE(name);
    const JointFit& joint = fitted.joints[require_bone(truth, name)];
    CHECK(error < 1.5 * joint.error + 6);
    if (name.ends_with("Leg") && !name.ends_with("UpLeg")) CHECK(joint.how == JointFit::How::Girth);
    if (error > 25)
      CHECK(std::any_of(fitted.warnings.begin(), fitted.warnings.end(),
                        [&, named = name](const std::string& text) { return text.find(named) != std::string::npos; }));
  }
  CHECK(fitted.check.whole > share_in_tissue(volume, truth) - 0.005);
}

TEST_CASE("auto-fit: the joints of a real arm lie within 16 mm, its shoulder in the middle of its ball" *
          doctest::test_suite("slow")) {
  NEEDS_SHARED("data/bp3d/arm_shoulder_1mm_tissue.mha");
  const VolumeFile file = read_volume(test::shared_path("data/bp3d/arm_shoulder_1mm_tissue.mha"));
  const TissueTable tissues = with_bones(merge_tissue_tables(file.tissues, nullptr), {7});
  const Armature truth = read_armature(test::shared_path("data/bp3d/arm_shoulder.armature.json"));
  const AutoFit fitted = auto_fit(file.volume, tissues, rig_template("arm"));
  for (const auto& [error, name] : errors(fitted.armature, truth)) {
    CAPTURE(name);
    if (name == "Forearm" || name == "Hand") CHECK(error < 16);
    if (name == "UpperArm") CHECK(error < 10);
  }
  CHECK(fitted.joints[0].how == JointFit::How::Ball);
  CHECK(fitted.check.whole > 0.99);
  // However far the elbow is bent at rest, its range begins at the straight arm and ends at the template's 145 degrees.
  // Its axis is perpendicular to the plane of the bent arm.
  const Armature& rig = fitted.armature;
  const int forearm = *rig.find("Forearm"), upper_arm = rig.bones[forearm].parent;
  const auto along = [&](int b) { return glm::normalize(rig.bones[b].tail - rig.bones[b].head); };
  const glm::dvec3 across = glm::normalize(glm::cross(along(upper_arm), along(forearm)));
  CHECK(glm::dot(across, rig.bones[forearm].limits.axis) > 0.8);
  CHECK(limits_text(fitted.armature, *fitted.armature.find("Forearm")) == "hinge, 0 to 145 degrees");
}

TEST_CASE(
    "auto-fit: an arm that is cut off below the shoulder may be longer than it looks, and every joint says how far it "
    "may be off" *
    doctest::test_suite("slow")) {
  NEEDS_SHARED("data/bp3d/arm_shoulder_1mm_tissue.mha");
  const VolumeFile file = read_volume(test::shared_path("data/bp3d/arm_shoulder_1mm_tissue.mha"));
  Grid grid = file.volume.grid;
  grid.size = glm::ivec3(glm::dvec3(grid.size) * glm::dvec3(0.5, 0.5, 0.36));
  grid.spacing *= 2;
  LabelVolume below{grid, ZeroedVector<Label>(grid.voxel_count(), 0)};
  for (int z = 0; z < grid.size.z; ++z)
    for (int y = 0; y < grid.size.y; ++y)
      for (int x = 0; x < grid.size.x; ++x) below.at({x, y, z}) = file.volume.at({2 * x, 2 * y, 2 * z});
  const TissueTable tissues = with_bones(merge_tissue_tables(file.tissues, nullptr), {7});
  const Armature truth = read_armature(test::shared_path("data/bp3d/arm_shoulder.armature.json"));
  const AutoFit fitted = auto_fit(below, tissues, rig_template("arm"));
  const auto found = errors(fitted.armature, truth);
  REQUIRE(found.size() == fitted.joints.size());
  for (size_t b = 0; b < found.size(); ++b) {
    const auto& [error, name] = found[b];
    CAPTURE(name);
    if (name == "UpperArm" || name == "Forearm" || name == "Hand") CHECK(error < 1.1 * fitted.joints[b].error);
  }
}

TEST_CASE("auto-fit: the main joints of a real body lie within 18 mm, and within what they say" *
          doctest::test_suite("slow")) {
  NEEDS_SHARED("data/bp3d/body_3mm_tissue.nrrd");
  const VolumeFile file = read_volume(test::shared_path("data/bp3d/body_3mm_tissue.nrrd"));
  const TissueTable tissues = with_bones(merge_tissue_tables(file.tissues, nullptr), {7});
  const Armature truth = read_armature(test::shared_path("data/bp3d/body.armature.json"));
  const AutoFit fitted = auto_fit(file.volume, tissues, rig_template("adult"));
  const auto found = errors(fitted.armature, truth);
  CHECK(median_of_main(found) < 12);
  for (const auto& [error, name] : found) {
    CAPTURE(name);
    for (const char* part : {"UpperArm", "Forearm", "Hand", "Thigh", "Shank", "Foot", "Neck"})
      if (name.ends_with(part)) {
        CHECK(error < 18);
        CHECK(error < 1.25 * fitted.joints[require_bone(fitted.armature, name)].error);
      }
  }
  CHECK(fitted.check.whole > 0.99);
}

TEST_CASE("auto-fit: the legs of a body without its upper half lie where they are, each for itself" *
          doctest::test_suite("slow")) {
  const Phantom body = make_body_phantom(8);
  Pose stride = rest_pose(body.armature);
  flex(stride, body.armature, require_bone(body.armature, "LeftThigh"), 25);
  flex(stride, body.armature, require_bone(body.armature, "RightShank"), 20);
  const SkinWeights weights = diffuse_heat(body.volume, body.tissues, body.armature);
  LabelVolume posed = resample(body.volume, body.tissues, body.armature, weights, stride, Blend::DualQuaternion).volume;
  const std::vector<RigidTransform> moved = posed_from_rest(body.armature, stride);

  const AffineTransform to_world = world_from_voxel(posed.grid);
  const double hips = body.armature.bones[require_bone(body.armature, "LeftThigh")].head.z;
  const int kept = static_cast<int>((voxel_from_world(posed.grid) * glm::dvec3(0, 0, hips - 30)).z);
  posed.voxels.resize(std::int64_t{posed.grid.size.x} * posed.grid.size.y * kept);
  posed.grid.size.z = kept;
  REQUIRE((to_world * glm::dvec3(0, 0, kept)).z < hips);

  const AutoFit fitted = auto_fit(posed, body.tissues, rig_template("adult"));
  for (const char* name : {"LeftShank", "RightShank", "LeftFoot", "RightFoot"}) {
    const int b = require_bone(body.armature, name);
    CAPTURE(name);
    CHECK(glm::distance(fitted.armature.bones[require_bone(fitted.armature, name)].head,
                        moved[b] * body.armature.bones[b].head) < 15);
    CHECK(fitted.joints[require_bone(fitted.armature, name)].how != JointFit::How::Unseen);
  }
}

TEST_CASE(
    "auto-fit: of a body cut at the hips what is there lies within 8 mm, behind a padding of air too, and what is not "
    "is said" *
    doctest::test_suite("slow")) {
  Phantom body = make_body_phantom(8);
  Grid& grid = body.volume.grid;
  const int cut = static_cast<int>(0.46 * grid.size.z), padding = 3;
  std::fill_n(body.volume.voxels.begin(), std::int64_t{grid.size.x} * grid.size.y * cut, 0);
  ZeroedVector<Label> kept;
  kept.assign(body.volume.voxels.begin() + std::int64_t{grid.size.x} * grid.size.y * (cut - padding),
              body.volume.voxels.end());
  body.volume.voxels = std::move(kept);
  grid.origin = world_from_voxel(grid) * glm::dvec3(0, 0, cut - padding);
  grid.size.z -= cut - padding;
  const double height = (world_from_voxel(grid) * glm::dvec3(0, 0, padding - 0.5)).z;

  const AutoFit fitted = auto_fit(body.volume, body.tissues, rig_template("adult"));
  for (int b = 0; b < std::ssize(fitted.joints); ++b) {
    const std::string& name = fitted.armature.bones[b].name;
    CAPTURE(name);
    const glm::dvec3 truth = body.armature.bones[require_bone(body.armature, name)].head;
    const double off = glm::distance(fitted.armature.bones[b].head, truth);
    if (truth.z > height + 8) CHECK(off < 8);
    if (truth.z < height - 8) {
      CHECK(fitted.joints[b].how == JointFit::How::Unseen);
      CHECK(fitted.joints[b].confidence == 0);
      CHECK(off < fitted.joints[b].error);
    }
  }
  CHECK(std::any_of(fitted.warnings.begin(), fitted.warnings.end(), [](const std::string& text) {
    return text.find("by body proportions only") != std::string::npos && text.find("LeftFoot") != std::string::npos;
  }));
}

}  // namespace limber
