// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/bones/input_doubts.h"

#include <random>

#include <doctest/doctest.h>

#include "core/rig_io/rig_io.h"
#include "core/volume_io/volume_io.h"
#include "tests/core/skin/small_body.h"
#include "tests/support/shared_data.h"

using namespace limber;
using namespace limber::test;

namespace {
// Two thighs and shanks in a slab of muscle. The body's left has larger x. The slab reaches further out on the left
// than on the right.
SmallBody legs() {
  SmallBody body;
  body.volume.grid.size = {60, 12, 84};
  body.volume.grid.origin = {10, 0, 0};
  body.volume.voxels.assign(body.volume.grid.voxel_count(), 0);
  const auto fill = [&](int x_low, int x_high, int z_low, int z_high, Label label, int margin) {
    for (int z = z_low; z < z_high; ++z)
      for (int y = margin; y < 12 - margin; ++y)
        for (int x = x_low; x < x_high; ++x) body.volume.at({x, y, z}) = label;
  };
  fill(4, 26, 2, 82, kMuscle, 1);
  fill(34, 56, 2, 82, kMuscle, 1);
  const auto tissue = [&](Label label, const char* name, TissueKind kind) {
    Tissue made;
    made.label = label, made.file_value = label, made.name = name, made.kind = kind;
    body.tissues.tissues.push_back(made);
  };
  tissue(kMuscle, "muscle", TissueKind::Muscle);
  tissue(2, "Left femur", TissueKind::Bone);
  tissue(3, "Right femur", TissueKind::Bone);
  tissue(4, "Left tibia", TissueKind::Bone);
  tissue(5, "Right tibia", TissueKind::Bone);
  fill(43, 47, 44, 80, 2, 4);
  fill(13, 17, 44, 80, 3, 4);
  fill(43, 47, 4, 40, 4, 4);
  fill(13, 17, 4, 40, 5, 4);
  body.armature.bones = {
      bone_between("LeftThigh", -1, {55, 6, 80}, {55, 6, 42}), bone_between("LeftShank", 0, {55, 6, 42}, {55, 6, 4}),
      bone_between("RightThigh", -1, {25, 6, 80}, {25, 6, 42}), bone_between("RightShank", 2, {25, 6, 42}, {25, 6, 4})};
  return body;
}

bool doubts(const SmallBody& body, const char* words) {
  for (const std::string& doubt : input_doubts(body.volume, body.tissues, body.armature))
    if (doubt.find(words) != std::string::npos) return true;
  return false;
}
}  // namespace

TEST_CASE("input doubts: a rig in its own body raises none") {
  const SmallBody body = legs();
  CHECK(input_doubts(body.volume, body.tissues, body.armature).empty());
  CHECK(share_in_tissue(body.volume, body.armature) == doctest::Approx(1));
}

TEST_CASE("input doubts: a rig beside the body, in RAS axes or mirrored is told apart") {
  SmallBody aside = legs(), ras = legs(), mirrored = legs();
  for (int k = 0; k < 4; ++k)
    for (glm::dvec3 Bone::*end : {&Bone::head, &Bone::tail}) {
      (aside.armature.bones[k].*end).z += 500;
      (ras.armature.bones[k].*end) *= glm::dvec3(-1, -1, 1);
      (mirrored.armature.bones[k].*end).x *= -1;
    }
  CHECK(doubts(aside, "outside the body"));
  CHECK(doubts(aside, "fit-rig"));
  CHECK(doubts(ras, "RAS"));
  CHECK(doubts(mirrored, "mirror the rig along x"));
}

TEST_CASE("input doubts: a rig that reaches beyond a scan which cuts its body raises none") {
  // Cuts the volume so that only the upper quarter of the thighs remains.
  SmallBody cut = legs();
  const LabelVolume whole = cut.volume;
  cut.volume.grid.size.z = 20;
  cut.volume.grid.origin.z += 62;
  cut.volume.voxels.assign(cut.volume.grid.voxel_count(), 0);
  for (int z = 0; z < 20; ++z)
    for (int y = 0; y < 12; ++y)
      for (int x = 0; x < 60; ++x) cut.volume.at({x, y, z}) = whole.at({x, y, z + 62});
  CHECK(share_in_tissue(cut.volume, cut.armature) < 0.3);
  CHECK_FALSE(doubts(cut, "outside the body"));
  // The warning comes when the same rig lies beside the legs or below them.
  for (const glm::dvec3& shift : {glm::dvec3(15, 0, 0), glm::dvec3(0, 0, -60), glm::dvec3(0, 9, 0)}) {
    SmallBody aside = cut;
    for (Bone& bone : aside.armature.bones) bone.head += shift, bone.tail += shift;
    CHECK(doubts(aside, "outside the body"));
  }
}

TEST_CASE("input doubts: a rig whose left is the labels' right is told") {
  SmallBody body = legs();
  CHECK_FALSE(doubts(body, "swapped"));
  std::swap(body.armature.bones[0].name, body.armature.bones[2].name);
  std::swap(body.armature.bones[1].name, body.armature.bones[3].name);
  CHECK(doubts(body, "swapped"));
}

TEST_CASE("input doubts: a rig of another limb is told") {
  SmallBody body = legs();
  body.armature.bones = {bone_between("LeftUpperArm", -1, {55, 6, 80}, {55, 6, 42}),
                         bone_between("LeftForearm", 0, {55, 6, 42}, {55, 6, 4})};
  CHECK(doubts(body, "rig of the arm"));
}

TEST_CASE("input doubts: a grey image is told from an atlas of as many labels") {
  SmallBody body = legs();
  std::mt19937 random(7);
  body.tissues.tissues.clear();
  for (int value = 1; value <= 600; ++value) {
    Tissue tissue;
    tissue.label = static_cast<Label>(value);
    tissue.file_value = value;
    body.tissues.tissues.push_back(tissue);
  }
  SmallBody atlas = body;
  for (std::int64_t at = 0; at < std::ssize(body.volume.voxels); ++at)
    if (body.volume.voxels[at]) {
      body.volume.voxels[at] = static_cast<Label>(1 + random() % 600);
      atlas.volume.voxels[at] = static_cast<Label>(1 + at / 97 % 600);
    }
  CHECK(doubts(body, "grey image"));
  CHECK_FALSE(doubts(atlas, "grey image"));
}

TEST_CASE("input doubts: real bodies with their own rigs raise none" * doctest::test_suite("slow")) {
  NEEDS_SHARED("data/bp3d/body_2mm_tissue.mha");
  const struct {
    const char *volume, *rig;
  } kBodies[] = {{"bender/man-arm-2mm.mha", "bender/man-arm-2mm-armature.vtk"},
                 {"bp3d/body_3mm_structures.nii.gz", "bp3d/body.armature.json"},
                 {"bp3d/body_2mm_tissue.mha", "bp3d/body.armature.json"},
                 {"bp3d/arm_shoulder_1mm.nrrd", "bp3d/arm_shoulder.armature.json"},
                 {"makehuman/body_4mm.nrrd", "makehuman/body.armature.json"}};
  for (const auto& body : kBodies) {
    CAPTURE(body.volume);
    const VolumeFile file = read_volume(shared_path("data") / body.volume);
    const auto found = input_doubts(file.volume, file.tissues, read_armature(shared_path("data") / body.rig));
    CHECK_MESSAGE(found.empty(), (found.empty() ? "" : found[0]));
  }
}
