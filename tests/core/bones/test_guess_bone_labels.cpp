// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/bones/guess_bone_labels.h"

#include <doctest/doctest.h>

using namespace limber;

namespace {

// A bar of flesh (1) along z with a thin core (2) in two pieces, and a rig of two bones along the core.
struct Bar {
  LabelVolume volume;
  TissueTable tissues;
  Armature rig;

  Bar() {
    volume.grid.size = {21, 21, 160};
    volume.grid.spacing = {2, 2, 1};
    volume.voxels.assign(volume.grid.voxel_count(), 0);
    for (int z = 2; z < 158; ++z)
      for (int y = 2; y < 19; ++y)
        for (int x = 2; x < 19; ++x) {
          const bool core = std::abs(x - 10) <= 1 && std::abs(y - 10) <= 1 && std::abs(z - 80) > 1;
          volume.at({x, y, z}) = core ? 2 : 1;
        }
    for (Label label : {1, 2}) {
      Tissue tissue;
      tissue.label = label;
      tissue.file_value = label;
      tissues.tissues.push_back(tissue);
    }
    rig.bones = {{"lower", -1, {20, 20, 3}, {20, 20, 80}}, {"upper", 0, {20, 20, 80}, {20, 20, 157}}};
  }
};

}  // namespace

TEST_CASE("bone tissue: the thin label that the rig runs through is taken for bone") {
  const Bar bar;
  const auto guess = guess_bone_tissue(bar.volume, bar.tissues, bar.rig);
  REQUIRE(guess);
  CHECK(guess->label == 2);
  CHECK(guess->share_of_rig > 0.95);
}

TEST_CASE(
    "bone tissue: bones are told where the rig runs between two of them, and muscle beside one bone of the rig is "
    "none") {
  Bar forearm;
  for (int z = 2; z < 158; ++z)
    for (int y = 2; y < 19; ++y)
      for (int x = 2; x < 19; ++x)
        forearm.volume.at({x, y, z}) = x != 10 && std::abs(x - 10) < 3 && std::abs(y - 10) <= 1 ? 2
                                       : z < 50 && std::abs(y - 10) <= 1                        ? 3
                                                                                                : 1;
  const auto guess = guess_bone_tissue(forearm.volume, forearm.tissues, forearm.rig);
  REQUIRE(guess);
  CHECK(guess->label == 2);
}

TEST_CASE(
    "bone tissue: nothing is guessed where a table knows a tissue, the rig runs elsewhere, or the label is most of the "
    "body") {
  Bar bar;
  bar.tissues.tissues[0].kind = TissueKind::Muscle;
  CHECK_FALSE(guess_bone_tissue(bar.volume, bar.tissues, bar.rig));

  Bar beside;
  for (Bone& bone : beside.rig.bones) bone.head.x = bone.tail.x = 30;
  CHECK_FALSE(guess_bone_tissue(beside.volume, beside.tissues, beside.rig));

  Bar solid;
  for (Label& label : solid.volume.voxels) label = label ? 1 : 0;
  CHECK_FALSE(guess_bone_tissue(solid.volume, solid.tissues, solid.rig));

  Bar outside;
  for (Bone& bone : outside.rig.bones) bone.head.x = bone.tail.x = 1e9;
  CHECK_FALSE(guess_bone_tissue(outside.volume, outside.tissues, outside.rig));
}
