// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/seams/find_seams.h"

#include <filesystem>
#include <tuple>
#include <utility>

#include <doctest/doctest.h>

#include "core/base/error.h"
#include "core/base/parallel.h"
#include "core/binding/heat_diffusion.h"
#include "core/report/metrics.h"
#include "core/resample/resample.h"
#include "core/seams/limbs.h"
#include "core/seams/seams_io.h"
#include "tests/core/skin/small_body.h"
#include "tests/support/glued_arm.h"

using namespace limber;

namespace {

struct Agreement {
  // Numbers of faces below the shoulder: of seams that were found, of glued parts, and of seams at most one voxel from
  // a glued face.
  std::int64_t found = 0, glued = 0, near_glued = 0;
};

// Counts the faces of the seams that were found, and those among them that lie at most one voxel from a glued face.
Agreement agreement(const test::GluedArm& body, const Seams& seams) {
  const auto height = [&](const glm::ivec3& v) { return (world_from_voxel(body.volume.grid) * glm::dvec3(v)).z; };
  std::vector<bool> is_near(body.volume.grid.voxel_count(), false);
  Agreement all;
  body.for_each_glued_face([&](const glm::ivec3& v, int) {
    all.glued += height(v) < 320;
    for (int z = -1; z <= 1; ++z)
      for (int y = -1; y <= 1; ++y)
        for (int x = -1; x <= 1; ++x)
          if (const glm::ivec3 w = v + glm::ivec3(x, y, z); body.volume.grid.contains(w))
            is_near[body.volume.grid.index(w)] = true;
  });
  seams.for_each([&](const glm::ivec3& v, int) {
    ++all.found;
    all.near_glued += is_near[body.volume.grid.index(v)];
  });
  return all;
}

Pose arm_raised(const Armature& rig, double degrees) {
  Pose pose = rest_pose(rig);
  pose.rotation[1] = glm::angleAxis(glm::radians(-degrees), glm::dvec3(0, 1, 0));
  return pose;
}

struct Raised {
  Posed posed;
  // Numbers of posed voxels that come from below the joined shoulder: of the trunk and of the arm, and of those among
  // them that are more than 8 mm from where the trunk should stay and the arm should be.
  std::int64_t trunk_moved = 0, trunk = 0, arm_left = 0, arm = 0;
};

Raised raise(const test::GluedArm& body, std::shared_ptr<const Seams> seams, double degrees) {
  TissueVoxels tissue(body.volume);
  tissue.set_seams(seams);
  const BoneParts parts = split_bones(body.volume, tissue, body.tissues, body.rig);
  const SkinWeights weights = diffuse_heat(body.volume, tissue, body.tissues, body.rig, parts);
  Raised raised{resample(body.volume, body.tissues, body.rig, weights, arm_raised(body.rig, degrees),
                         Blend::DualQuaternion, {.displacement = true, .seams = seams})};
  const Grid& grid = raised.posed.volume.grid;
  const glm::dmat3 half = glm::mat3_cast(arm_raised(body.rig, degrees).rotation[1]);
  glm::ivec3 v;
  for (v.z = 0; v.z < grid.size.z; ++v.z)
    for (v.y = 0; v.y < grid.size.y; ++v.y)
      for (v.x = 0; v.x < grid.size.x; ++v.x) {
        if (raised.posed.volume.at(v) == 0) continue;
        const glm::dvec3 at = world_from_voxel(grid) * glm::dvec3(v), moved(raised.posed.displacement[grid.index(v)]),
                         rest = at - moved;
        const glm::ivec3 from(glm::floor(voxel_from_world(body.volume.grid) * rest + 0.5));
        if (rest.z > 250 || !body.volume.grid.contains(from)) continue;
        const glm::dvec3 head = body.rig.bones[1].head, asked = half * (rest - head) + head - rest;
        if (body.is_arm[body.volume.grid.index(from)]) {
          ++raised.arm;
          raised.arm_left += glm::length(moved - asked) > 8;
        } else {
          ++raised.trunk;
          raised.trunk_moved += glm::length(moved) > 8;
        }
      }
  return raised;
}

// Two fingers along z, of bone, fat and skin, with a palm above. Flesh four voxels wide joins their skins from z = 12
// to 17. One of the skins is a voxel thicker.
struct WebbedFingers {
  static constexpr int kFirst = 16, kWide = 4;  // the bridge of flesh along x: first voxel and width
  enum : Label { Skin = 1, Fat = 2, Flesh = 3, BoneLabel = 4 };
  LabelVolume volume;
  TissueTable tissues;
  Armature rig;

  WebbedFingers() {
    volume.grid.size = {40, 18, 90};
    volume.voxels.assign(volume.grid.voxel_count(), 0);
    fill({4, 3, 2}, {kFirst, 15, 90}, Skin);
    fill({kFirst + kWide, 3, 2}, {34, 15, 90}, Skin);
    fill({4, 3, 60}, {34, 15, 90}, Skin);
    fill({7, 5, 4}, {13, 13, 90}, Fat);
    fill({22, 5, 4}, {31, 13, 90}, Fat);
    fill({7, 5, 62}, {31, 13, 90}, Fat);
    fill({8, 7, 6}, {12, 11, 88}, BoneLabel);
    fill({24, 7, 6}, {28, 11, 88}, BoneLabel);
    fill({8, 7, 80}, {28, 11, 88}, BoneLabel);
    fill({kFirst, 6, 12}, {kFirst + kWide, 10, 18}, Flesh);
    for (const auto& [label, kind] : {std::pair{Skin, TissueKind::Skin},
                                      {Fat, TissueKind::Fat},
                                      {Flesh, TissueKind::Connective},
                                      {BoneLabel, TissueKind::Bone}}) {
      Tissue tissue;
      tissue.label = label;
      tissue.file_value = label;
      tissue.kind = kind;
      tissues.tissues.push_back(tissue);
    }
    rig.bones.push_back(test::bone_between("RightHand", -1, {18, 9, 88}, {18, 9, 70}));
    for (const auto& [name, x] : {std::pair{"RightIndex", 9.5}, {"RightMiddle", 25.5}}) {
      int parent = 0;
      for (const auto& [part, from, to] :
           {std::tuple{"Proximal", 70., 45.}, {"Middle", 45., 25.}, {"Distal", 25., 4.}}) {
        rig.bones.push_back(test::bone_between((std::string(name) + part).c_str(), parent, {x, 9, from}, {x, 9, to}));
        parent = static_cast<int>(rig.bones.size()) - 1;
      }
    }
  }
  void fill(const glm::ivec3& from, const glm::ivec3& to, Label label) {
    for (int z = from.z; z < to.z; ++z)
      for (int y = from.y; y < to.y; ++y)
        for (int x = from.x; x < to.x; ++x) volume.at({x, y, z}) = label;
  }
};

// A trunk and an arm along z that touch below a shoulder. Each has bone in muscle, with fat and skin around. Where they
// touch, one of the two has no skin and fat, as in a scan that is too coarse for both.
struct PressedArm {
  static constexpr int kBetween = 24;  // the arm's lowest voxel along x
  enum : Label { Skin = 1, Fat = 2, Muscle = 3, Spine = 4, Humerus = 5, Ulna = 6 };
  LabelVolume volume;
  TissueTable tissues;
  Armature rig;

  explicit PressedArm(bool arm_keeps_its_skin) {
    volume.grid.size = {44, 28, 104};
    volume.grid.spacing = glm::dvec3(3);
    volume.voxels.assign(volume.grid.voxel_count(), 0);
    layered({2, 2, 2}, {kBetween, 26, 102}, 0, arm_keeps_its_skin ? 2 : 0);
    layered({kBetween, 6, 2}, {42, 22, 102}, arm_keeps_its_skin ? 0 : 2, 0);
    fill({12, 8, 84}, {36, 20, 98}, Muscle);
    fill({8, 12, 6}, {14, 18, 98}, Spine);
    fill({31, 12, 56}, {35, 16, 98}, Humerus);
    fill({31, 12, 6}, {35, 16, 52}, Ulna);
    for (const auto& [label, name, kind] : {std::tuple{Skin, "skin", TissueKind::Skin},
                                            {Fat, "fat", TissueKind::Fat},
                                            {Muscle, "muscle", TissueKind::Muscle},
                                            {Spine, "thoracic vertebrae", TissueKind::Bone},
                                            {Humerus, "left humerus", TissueKind::Bone},
                                            {Ulna, "left ulna", TissueKind::Bone}}) {
      Tissue tissue;
      tissue.label = label;
      tissue.file_value = label;
      tissue.name = name;
      tissue.kind = kind;
      tissues.tissues.push_back(tissue);
    }
    const glm::dvec3 trunk(33, 45, 0), arm(99, 42, 0);
    const auto at = [](const glm::dvec3& foot, double z) { return foot + glm::dvec3(0, 0, z); };
    rig.bones = {{"Spine", -1, at(trunk, 18), at(trunk, 294)},
                 {"LeftUpperArm", 0, at(arm, 288), at(arm, 162)},
                 {"LeftForearm", 1, at(arm, 162), at(arm, 18)}};
  }

 private:
  void fill(const glm::ivec3& from, const glm::ivec3& to, Label label) {
    for (int z = from.z; z < to.z; ++z)
      for (int y = from.y; y < to.y; ++y)
        for (int x = from.x; x < to.x; ++x) volume.at({x, y, z}) = label;
  }
  // Fills a box with layers of skin, fat and muscle.
  //   low, high  how many of the outer two layers are missing on the side of lower x and of higher x
  void layered(glm::ivec3 from, glm::ivec3 to, int low, int high) {
    for (const Label label : {Skin, Fat, Muscle}) {
      fill(from, to, label);
      from += glm::ivec3(low-- > 0 ? 0 : 1, 1, 1);
      to -= glm::ivec3(high-- > 0 ? 0 : 1, 1, 1);
    }
  }
};

}  // namespace

TEST_CASE("seams: a bridge of flesh between the skins of two fingers is cut in its middle") {
  const WebbedFingers body;
  const TissueVoxels tissue(body.volume);
  const BoneParts parts = split_bones(body.volume, tissue, body.tissues, body.rig);
  const Seams seams = find_seams(body.volume, tissue, body.tissues, body.rig, parts);
  std::int64_t found = 0, in_the_middle = 0;
  seams.for_each([&](const glm::ivec3& v, int axis) {
    ++found;
    in_the_middle += axis == 0 && v.x == WebbedFingers::kFirst + WebbedFingers::kWide / 2 - 1;
  });
  CHECK(found == 4 * 6);
  CHECK(in_the_middle == found);
}

TEST_CASE("seams: skin that only one of two limbs has left goes with the one on whose fat it lies") {
  for (const bool arm_keeps_its_skin : {true, false}) {
    INFO("the skin is the arm's: ", arm_keeps_its_skin);
    const PressedArm body(arm_keeps_its_skin);
    const TissueVoxels tissue(body.volume);
    const BoneParts parts = split_bones(body.volume, tissue, body.tissues, body.rig);
    const Seams seams = find_seams(body.volume, tissue, body.tissues, body.rig, parts);
    std::int64_t found = 0, between = 0;  // counts without the crease, where the arm's skin turns inwards
    seams.for_each([&](const glm::ivec3& v, int axis) {
      if (v.y < 8 || v.y >= 20) return;
      ++found;
      between += axis == 0 && v.x == PressedArm::kBetween - 1;
    });
    CHECK(found > 700);
    CHECK(between == found);
  }
}

TEST_CASE("seams: an arm grown to the trunk is cut from it where the two touch, and from nowhere else") {
  for (const bool names : {false, true}) {
    INFO("labels that name limbs: ", names);
    const test::GluedArm body(-3, names);
    const Agreement found = agreement(body, body.seams());
    CHECK(found.glued > 200);
    CHECK(found.found > 0.8 * found.glued);
    CHECK(found.near_glued > 0.95 * found.found);
  }
}

TEST_CASE("seams: limbs that do not touch have none, and neither has a rig whose names say nothing") {
  CHECK(test::GluedArm(10).seams().empty());
  test::GluedArm body(-3);
  for (size_t b = 0; b < body.rig.bones.size(); ++b) body.rig.bones[b].name = "b" + std::to_string(b);
  CHECK(body.seams().empty());
}

TEST_CASE("seams: the same with one, two and four threads") {
  const test::GluedArm body(-3);
  const Seams first = body.seams();
  for (int threads : {1, 2, 4}) {
    ThreadCount limit(threads);
    CHECK(body.seams() == first);
  }
}

TEST_CASE(
    "seams: a raised arm leaves the trunk where it is and takes all of itself along, and drags a web without them") {
  const test::GluedArm body(-3);
  const auto seams = std::make_shared<const Seams>(body.seams());
  const Raised cut = raise(body, seams, 60), grown = raise(body, nullptr, 60);
  MESSAGE("with seams ", cut.trunk_moved, " of ", cut.trunk, " and ", cut.arm_left, " of ", cut.arm,
          " voxels go astray, without ", grown.trunk_moved, " and ", grown.arm_left);
  CHECK(cut.trunk_moved < 0.01 * cut.trunk);
  CHECK(cut.arm_left < 0.03 * cut.arm);
  CHECK(grown.trunk_moved > 5 * cut.trunk_moved + 100);
  // Skin covers the faces that come apart, and each limb stays in one piece.
  const VolumeMetrics metrics = compare(body.volume, cut.posed.volume, body.tissues);
  CHECK(metrics.skin_share_after > 0.999);
  CHECK(cut.posed.report.new_skin_voxels > 100);
}

TEST_CASE("seams: at rest the volume stays as it is, bit for bit") {
  const test::GluedArm body(-3);
  const auto seams = std::make_shared<const Seams>(body.seams());
  TissueVoxels tissue(body.volume);
  tissue.set_seams(seams);
  const SkinWeights weights = diffuse_heat(body.volume, tissue, body.tissues, body.rig,
                                           split_bones(body.volume, tissue, body.tissues, body.rig));
  const Posed rest = resample(body.volume, body.tissues, body.rig, weights, rest_pose(body.rig), Blend::DualQuaternion,
                              {.seams = seams});
  CHECK(rest.volume.voxels == body.volume.voxels);
}

TEST_CASE("seams: files keep them, and what is no such file is refused") {
  const test::GluedArm body(-3);
  const Seams seams = body.seams();
  const auto folder = std::filesystem::temp_directory_path() / "limber-seams-test";
  std::filesystem::create_directories(folder);
  const Path path = folder / "seams.nrrd";
  write_seams(seams, body.volume.grid, path);
  CHECK(read_seams(path, body.volume) == seams);
  LabelVolume moved = body.volume;
  moved.grid.origin.x += 40;
  CHECK_THROWS_AS(read_seams(path, moved), Error);
  Seams nothing(body.volume.grid.size);
  write_seams(nothing, body.volume.grid, path);
  CHECK(read_seams(path, body.volume).empty());
  std::filesystem::remove_all(folder);
}

TEST_CASE("limbs: names of tissues that mean a limb, and heads that do not") {
  CHECK(limb_named("Muscle, arms") == LimbName::Arms);
  CHECK(limb_named("Residual tissue of the legs") == LimbName::Legs);
  CHECK(limb_named("Skin, head") == LimbName::Head);
  CHECK(limb_named("skin_trunk") == std::nullopt);
  CHECK(limb_named("biceps brachii, long head") == std::nullopt);
  CHECK(limb_named("neck of gallbladder") == std::nullopt);
  CHECK(limb_named("armpit") == std::nullopt);
}
