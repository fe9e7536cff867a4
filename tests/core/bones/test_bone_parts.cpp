// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/bones/bone_parts.h"

#include <map>
#include <set>

#include <doctest/doctest.h>

#include "core/rig_io/rig_io.h"
#include "core/volume_io/volume_io.h"
#include "tests/core/skin/small_body.h"
#include "tests/support/shared_data.h"

using namespace limber;
using namespace limber::test;

namespace {
// Counts bone voxels by rig bone.
std::map<std::string, std::int64_t> voxels_by_bone(const BoneParts& parts, const Armature& armature) {
  std::map<std::string, std::int64_t> count;
  for (std::uint16_t part : parts.part_of)
    if (part) ++count[armature.bones[parts.parts[part - 1].bone].name];
  return count;
}

// Two bones, each a ball with a shaft, whose balls touch in a disc. The rig's joint lies in the disc.
SmallBody two_touching_bones() {
  SmallBody body;
  body.volume.grid.size = {32, 32, 92};
  body.volume.voxels.assign(body.volume.grid.voxel_count(), kMuscle);
  for (int z = 2; z < 90; ++z)
    for (int y = 0; y < 32; ++y)
      for (int x = 0; x < 32; ++x) {
        const double r = glm::length(glm::dvec2(x, y) - 15.5);
        const double to_ball = std::min(std::abs(z - 37.0), std::abs(z - 54.0));
        if (r < 4.5 || r * r + to_ball * to_ball < 90) body.volume.at({x, y, z}) = kBone;
      }
  // Cuts the bone between the balls down to the disc in which they touch.
  for (int z = 45; z < 47; ++z)
    for (int y = 0; y < 32; ++y)
      for (int x = 0; x < 32; ++x)
        if (glm::length(glm::dvec2(x, y) - 15.5) > 3.0) body.volume.at({x, y, z}) = kMuscle;
  body.tissues = muscle_and_bone();
  body.armature.bones = {bone_between("Upper", -1, {15, 15, 0}, {15, 15, 45.5}),
                         bone_between("Lower", 0, {15, 15, 45.5}, {15, 15, 91})};
  return body;
}

// Makes a block of muscle, into which tests draw tubes of bone.
SmallBody muscle_block(const glm::ivec3& size) {
  SmallBody body;
  body.volume.grid.size = size;
  body.volume.voxels.assign(body.volume.grid.voxel_count(), kMuscle);
  body.tissues = muscle_and_bone();
  return body;
}
// Draws a tube of bone with a pointed start, which touches a neighbouring bone by its point only.
void draw_tube(SmallBody& body, const glm::dvec3& from, const glm::dvec3& to, double radius) {
  const glm::dvec3 along = glm::normalize(to - from);
  const glm::ivec3 size = body.volume.grid.size;
  for (int z = 0; z < size.z; ++z)
    for (int y = 0; y < size.y; ++y)
      for (int x = 0; x < size.x; ++x) {
        const glm::dvec3 off = glm::dvec3(x, y, z) - from;
        const double t = glm::dot(off, along);
        if (t < -0.5 || t > glm::length(to - from)) continue;
        if (glm::length(off - t * along) <= (t < 2.5 ? 1.0 : radius)) body.volume.at({x, y, z}) = kBone;
      }
}
std::string bone_at(const SmallBody& body, const BoneParts& parts, const TissueVoxels& tissue,
                    const glm::ivec3& voxel) {
  return body.armature.bones[parts.parts[parts.part_of[tissue.index_of(voxel)] - 1].bone].name;
}
}  // namespace

TEST_CASE("bone parts: a rib beside the arm that hangs on the collarbone follows that, not the arm") {
  SmallBody body = muscle_block({56, 24, 72});
  draw_tube(body, {4, 12, 60}, {36, 12, 60}, 4);       // collarbone
  draw_tube(body, {42, 12, 62}, {42, 12, 2}, 4);       // arm
  draw_tube(body, {28, 12, 55.5}, {28, 12, 24}, 2.5);  // a rib that is nearer to the arm's bone
  body.armature.bones = {bone_between("Collarbone", -1, {4, 12, 60}, {40, 12, 60}),
                         bone_between("Arm", 0, {40, 12, 60}, {42, 12, 0})};
  const TissueVoxels tissue(body.volume);
  const BoneParts parts = split_bones(body.volume, tissue, body.tissues, body.armature);
  CHECK(bone_at(body, parts, tissue, {42, 12, 30}) == "Arm");
  CHECK(bone_at(body, parts, tissue, {20, 12, 60}) == "Collarbone");
  CHECK(bone_at(body, parts, tissue, {28, 12, 30}) == "Collarbone");
}

TEST_CASE("bone parts: breastbone and rib are the trunk's, whatever lies nearer, and a shoulder blade its shoulder's") {
  SmallBody body = muscle_block({140, 60, 90});
  body.armature.bones = {bone_between("Thorax", -1, {20, 50, 5}, {20, 50, 85}),
                         bone_between("LeftClavicle", 0, {30, 10, 78}, {120, 22, 74}),
                         bone_between("LeftUpperArm", 1, {120, 22, 74}, {126, 22, 2})};
  draw_tube(body, {20, 50, 5}, {20, 50, 85}, 4);     // spine
  draw_tube(body, {34, 10, 78}, {112, 21, 74}, 3);   // collarbone
  draw_tube(body, {124, 22, 66}, {126, 22, 2}, 4);   // upper arm
  draw_tube(body, {18, 8, 40}, {18, 8, 80}, 4);      // breastbone
  draw_tube(body, {40, 48, 62}, {70, 24, 58}, 2);    // rib
  draw_tube(body, {100, 44, 50}, {116, 28, 74}, 3);  // shoulder blade
  const TissueVoxels tissue(body.volume);
  const BoneParts parts = split_bones(body.volume, tissue, body.tissues, body.armature);
  CHECK(bone_at(body, parts, tissue, {20, 50, 40}) == "Thorax");
  CHECK(bone_at(body, parts, tissue, {72, 15, 76}) == "LeftClavicle");
  CHECK(bone_at(body, parts, tissue, {125, 22, 30}) == "LeftUpperArm");
  CHECK(bone_at(body, parts, tissue, {18, 8, 60}) == "Thorax");
  CHECK(bone_at(body, parts, tissue, {55, 36, 60}) == "Thorax");
  CHECK(bone_at(body, parts, tissue, {108, 36, 62}) == "LeftClavicle");
}

TEST_CASE(
    "bone parts: a breastbone grown to a collarbone is the trunk's also where the rig's collarbones begin at the "
    "spine") {
  SmallBody body = muscle_block({200, 60, 90});
  body.armature.bones = {bone_between("Thorax", -1, {100, 50, 5}, {100, 50, 85}),
                         bone_between("LeftClavicle", 0, {100, 46, 80}, {180, 22, 74}),
                         bone_between("LeftUpperArm", 1, {180, 22, 74}, {186, 22, 2}),
                         bone_between("RightClavicle", 0, {100, 46, 80}, {20, 22, 74}),
                         bone_between("RightUpperArm", 3, {20, 22, 74}, {14, 22, 2})};
  draw_tube(body, {100, 50, 5}, {100, 50, 85}, 4);  // spine
  draw_tube(body, {112, 12, 78}, {172, 21, 74},
            4);  // collarbones; the left one is connected by a thin neck to the breastbone
  draw_tube(body, {98, 12, 78}, {118, 13, 78}, 2.5);
  draw_tube(body, {88, 12, 78}, {28, 21, 74}, 3);
  draw_tube(body, {184, 22, 66}, {186, 22, 2}, 4);  // upper arms
  draw_tube(body, {16, 22, 66}, {14, 22, 2}, 4);
  draw_tube(body, {100, 12, 40}, {100, 12, 84}, 5);  // breastbone
  const TissueVoxels tissue(body.volume);
  const BoneParts parts = split_bones(body.volume, tissue, body.tissues, body.armature);
  CHECK(bone_at(body, parts, tissue, {100, 12, 60}) == "Thorax");
  CHECK(bone_at(body, parts, tissue, {150, 18, 75}) == "LeftClavicle");
  CHECK(bone_at(body, parts, tissue, {50, 18, 75}) == "RightClavicle");
  CHECK(bone_at(body, parts, tissue, {100, 50, 40}) == "Thorax");
}

TEST_CASE(
    "bone parts: in a whole body with one bone label the chest is whole, and shoulder blades go with their shoulders" *
    doctest::test_suite("slow")) {
  NEEDS_SHARED("data/bp3d/body_3mm_tissue.nrrd");
  const VolumeFile file = read_volume(shared_path("data/bp3d/body_3mm_tissue.nrrd")),
                   named = read_volume(shared_path("data/bp3d/body_3mm_structures.nii.gz"));
  const TissueTable user = read_tissue_table(shared_path("data/bp3d/tissue.labels.json")),
                    names = read_tissue_table(shared_path("data/bp3d/body_structures.labels.json"));
  const TissueTable tissues = merge_tissue_tables(file.tissues, &user);
  const Armature armature = read_armature(shared_path("data/bp3d/body.armature.json"));
  const TissueVoxels tissue(file.volume);
  const BoneParts parts = split_bones(file.volume, tissue, tissues, armature);
  const AffineTransform to_named = voxel_from_world(named.volume.grid), to_world = world_from_voxel(file.volume.grid);
  std::map<std::string, std::map<std::string, std::int64_t>> voxels;  // number of voxels, by structure and rig bone
  tissue.for_each([&](std::int64_t place, const glm::ivec3& v) {
    if (!parts.part_of[place]) return;
    const Label label = named.volume.at_or_air(glm::ivec3(glm::floor(to_named * (to_world * glm::dvec3(v)) + 0.5)));
    if (const double value = label; const Tissue* structure = names.find_file_value(value))
      ++voxels[structure->name][armature.bones[parts.parts[parts.part_of[place] - 1].bone].name];
  });
  const auto share = [&](const std::string& structure, const std::string& start) {
    std::int64_t there = 0, all = 0;
    for (const auto& [bone, count] : voxels[structure]) {
      all += count;
      there += bone.starts_with(start) ? count : 0;
    }
    REQUIRE(all > 0);
    return double(there) / double(all);
  };
  for (const char* chest : {"Body of sternum", "Manubrium", "Left second rib", "Right second rib", "Left third rib",
                            "Right fifth rib", "Second thoracic vertebra"}) {
    CAPTURE(chest);
    CHECK(share(chest, "Thorax") > 0.99);
  }
  CHECK(share("Left scapula", "LeftClavicle") > 0.99);
  CHECK(share("Right scapula", "RightClavicle") > 0.99);
  CHECK(share("Left clavicle", "LeftClavicle") > 0.95);
  CHECK(share("Right clavicle", "RightClavicle") > 0.95);
}

TEST_CASE("bone parts: a toe beside the toe that the rig bone runs along is a toe") {
  SmallBody body = muscle_block({64, 44, 24});
  draw_tube(body, {2, 12, 12}, {36, 12, 12}, 4);  // the foot, with two bones side by side
  draw_tube(body, {2, 32, 12}, {36, 32, 12}, 4);
  draw_tube(body, {18, 15, 12}, {18, 29, 12}, 4);
  draw_tube(body, {37, 12, 12}, {58, 12, 12}, 3);  // toes
  draw_tube(body, {37, 32, 12}, {58, 32, 12}, 3);
  body.armature.bones = {bone_between("Foot", -1, {2, 12, 12}, {38, 12, 12}),
                         bone_between("Toes", 0, {38, 12, 12}, {60, 12, 12})};
  const TissueVoxels tissue(body.volume);
  const BoneParts parts = split_bones(body.volume, tissue, body.tissues, body.armature);
  CHECK(bone_at(body, parts, tissue, {10, 32, 12}) == "Foot");
  CHECK(bone_at(body, parts, tissue, {50, 12, 12}) == "Toes");
  CHECK(bone_at(body, parts, tissue, {50, 32, 12}) == "Toes");
}

TEST_CASE("bone parts: two bones that touch part where they touch, shafts stay with their balls") {
  const SmallBody body = two_touching_bones();
  const TissueVoxels tissue(body.volume);
  const BoneParts parts = split_bones(body.volume, tissue, body.tissues, body.armature);
  REQUIRE(parts.parts.size() == 2);
  std::int64_t wrong = 0;
  tissue.for_each([&](std::int64_t place, const glm::ivec3& v) {
    CHECK((parts.part_of[place] > 0) == (body.volume.at(v) == kBone));
    if (parts.part_of[place]) wrong += (parts.parts[parts.part_of[place] - 1].bone == 0) != (v.z < 46);
  });
  CHECK(wrong <= 40);  // at most the voxels of the disc in which the bones touch
}

TEST_CASE("bone parts: one tube drawn along several rig bones is cut at their joints") {
  SmallBody body = two_bone_bar(12, 40, 0);
  const TissueVoxels tissue(body.volume);
  const BoneParts parts = split_bones(body.volume, tissue, body.tissues, body.armature);
  REQUIRE(parts.parts.size() == 2);
  CHECK(parts.parts[0].voxel_count == parts.parts[1].voxel_count);
}

TEST_CASE("bone parts: labels that name different bones are never joined, a shell and its core are") {
  SmallBody body = two_touching_bones();
  for (int z = 0; z < 92; ++z)
    for (int y = 0; y < 32; ++y)
      for (int x = 0; x < 32; ++x)
        // The labels meet at z = 43, which is not where the bones touch.
        if (Label& label = body.volume.at({x, y, z}); label == kBone && z >= 43) label = 3;
  for (Label label : {Label{3}, Label{4}}) {
    Tissue tissue = body.tissues.tissues.back();
    tissue.label = label;
    body.tissues.tissues.push_back(tissue);
  }
  for (int z = 10; z < 30; ++z) body.volume.at({15, 15, z}) = 4;  // a core of another label
  const TissueVoxels tissue(body.volume);
  const BoneParts parts = split_bones(body.volume, tissue, body.tissues, body.armature);
  tissue.for_each([&](std::int64_t place, const glm::ivec3& v) {
    if (parts.part_of[place]) CHECK(parts.parts[parts.part_of[place] - 1].bone == (body.volume.at(v) == 3 ? 1 : 0));
  });
}

TEST_CASE("bone parts: a volume that is all bone, or has none, is no trouble") {
  SmallBody body = two_bone_bar(6, 12, 2);
  for (Label& label : body.volume.voxels) label = kBone;
  CHECK(split_bones(body.volume, TissueVoxels(body.volume), body.tissues, body.armature).parts.size() >= 1);
  for (Label& label : body.volume.voxels) label = kMuscle;
  CHECK(split_bones(body.volume, TissueVoxels(body.volume), body.tissues, body.armature).parts.empty());
}

TEST_CASE("bone parts: on a whole arm with one bone label, every true bone lies on one rig bone" *
          doctest::test_suite("slow")) {
  NEEDS_SHARED("data/bp3d/arm_shoulder_1mm_tissue.mha");
  const VolumeFile file = read_volume(shared_path("data/bp3d/arm_shoulder_1mm_tissue.mha"));
  const VolumeFile truth = read_volume(shared_path("data/bp3d/arm_shoulder_1mm.nrrd"));
  const Armature armature = read_armature(shared_path("data/bp3d/arm_shoulder.armature.json"));
  const TissueTable tissues = with_bones(file.tissues, {7});
  const TissueVoxels tissue(file.volume);
  const BoneParts parts = split_bones(file.volume, tissue, tissues, armature);
  std::map<double, std::map<int, std::int64_t>> bones_of_structure;
  std::int64_t bone_voxels = 0;
  tissue.for_each([&](std::int64_t place, const glm::ivec3& v) {
    if (!parts.part_of[place]) return;
    ++bone_voxels;
    ++bones_of_structure[truth.tissues.find(truth.volume.at(v))->file_value]
                        [parts.parts[parts.part_of[place] - 1].bone];
  });
  std::int64_t astray = 0;
  for (const auto& [structure, bones] : bones_of_structure) {
    std::int64_t all = 0, most = 0;
    for (auto [bone, voxels] : bones) all += voxels, most = std::max(most, voxels);
    astray += all - most;
  }
  MESSAGE(astray, " of ", bone_voxels, " bone voxels lie on another rig bone than most of their structure");
  CHECK(astray < bone_voxels / 200);
}

TEST_CASE("bone parts: each of the arm's 21 rig bones finds its own bone, and no part is torn between two") {
  NEEDS_SHARED("data/bender/man-arm-2mm.mha");
  const VolumeFile file = read_volume(shared_path("data/bender/man-arm-2mm.mha"));
  const Armature armature = read_armature(shared_path("data/bender/man-arm-2mm-armature.vtk"));
  const TissueTable tissues = merge_tissue_tables(file.tissues, nullptr);
  const TissueVoxels tissue(file.volume);
  const BoneParts parts = split_bones(file.volume, tissue, tissues, armature);
  const auto count = voxels_by_bone(parts, armature);
  CHECK(count.size() == 21);
  // The humerus and the bones of the forearm touch in a few voxels only.
  std::int64_t touching = 0;
  tissue.for_each([&](std::int64_t place, const glm::ivec3& v) {
    if (!parts.part_of[place] || parts.parts[parts.part_of[place] - 1].bone != 0) return;
    for (int axis = 0; axis < 3; ++axis)
      for (int side = -1; side <= 1; side += 2) {
        glm::ivec3 w = v;
        w[axis] += side;
        if (file.volume.at_or_air(w) == 0) continue;
        const std::uint16_t part = parts.part_of[tissue.index_of(w)];
        touching += part && parts.parts[part - 1].bone == 1;
      }
  });
  MESSAGE(touching, " faces between humerus and forearm");
  CHECK(touching < 200);
}
