// SPDX-License-Identifier: AGPL-3.0-or-later
// Measures the memory of `limber resample`. The body is a plate across the rows of a wide grid that is mostly air.
// Stored by rows, its few voxels would touch every page of a volume; stored by tiles, hardly more pages than it fills.
#include <algorithm>

#include <doctest/doctest.h>

#include "core/pose/pose_io.h"
#include "core/rig_io/rig_io.h"
#include "core/skin/weights_io.h"
#include "core/volume_io/volume_io.h"
#include "tests/support/bent_tube.h"
#include "tests/support/program.h"
#include "tests/support/sanitizer.h"

using namespace limber;
using limber::test::TemporaryFolder;

namespace {

constexpr glm::ivec3 kSize{1600, 150, 150};
constexpr int kJoint = kSize.z / 2;

// Makes a plate of flesh in skin around a core of bone that is interrupted at the joint.
LabelVolume plate() {
  LabelVolume volume{{.size = kSize}, ZeroedVector<Label>(std::size_t(kSize.x) * kSize.y * kSize.z)};
  constexpr int kMiddle = kSize.x / 2, kHalf = 12, kHalfBone = 4;
  for (int z = 2; z < kSize.z - 2; ++z)
    for (int y = 2; y < kSize.y - 2; ++y)
      for (int x = kMiddle - kHalf; x <= kMiddle + kHalf; ++x) {
        const bool at_edge = y < 4 || y > kSize.y - 5 || z < 4 || z > kSize.z - 5;
        const bool is_skin = at_edge || std::abs(x - kMiddle) > kHalf - 2;
        const bool is_bone = !at_edge && std::abs(x - kMiddle) <= kHalfBone && std::abs(z - kJoint) > 6;
        volume.at({x, y, z}) = is_bone ? test::kBone : is_skin ? test::kSkin : test::kFat;
      }
  return volume;
}

Armature two_bones() {
  Armature rig;
  const double x = kSize.x / 2, y = kSize.y / 2;
  rig.bones = {{.name = "Lower", .parent = -1, .head = {x, y, 4}, .tail = {x, y, kJoint}},
               {.name = "Upper", .parent = 0, .head = {x, y, kJoint}, .tail = {x, y, kSize.z - 4}}};
  return rig;
}

// Returns weights that change from one bone to the other within some voxels of the joint.
SkinWeights weights_of(const TissueVoxels& tissue) {
  SkinWeights weights({"Lower", "Upper"}, tissue);
  for (std::int64_t brick = 0; brick < std::ssize(tissue.bricks()); ++brick) {
    SkinWeights::Influences influences;
    tissue.for_each(brick, brick + 1, [&](std::int64_t, const glm::ivec3& v) {
      const double upper = std::clamp((v.z - kJoint) / 12.0 + 0.5, 0.0, 1.0);
      influences.push_back(quantize({{0, 1 - upper}, {1, upper}}));
    });
    weights.set_chunk(brick, influences);
  }
  return weights;
}

}  // namespace

TEST_CASE("resample: of a volume's size, only the rest volume and the posed volume are in memory" *
          doctest::test_suite("slow")) {
#ifdef LIMBER_ADDRESS_SANITIZER
  return;
#endif
  const TemporaryFolder folder;
  const LabelVolume volume = plate();
  const Armature rig = two_bones();
  TissueTable tissues = test::tube_tissues();
  for (Tissue& each : tissues.tissues) each.file_value = each.label;
  write_volume(volume, folder / "volume.nrrd", tissues);
  write_tissue_table(tissues, folder / "tissues.json");
  write_armature(rig, folder / "rig.json");
  const TissueVoxels tissue(volume);
  write_weights(weights_of(tissue), volume, tissue, folder / "weights.nrrd", SeamsOfWeights::OfTissue);
  Pose pose = rest_pose(rig);
  pose.rotation[1] = glm::angleAxis(0.3, glm::dvec3(1, 0, 0));
  write_pose(pose, rig, folder / "pose.json");

  const auto run = test::run_limber({"resample", folder / "volume.nrrd", "--tissues", folder / "tissues.json", "--rig",
                                     folder / "rig.json", "--weights", folder / "weights.nrrd", "--pose",
                                     folder / "pose.json", "--method", "dqs", "-o", folder / "posed.nrrd"});
  INFO(run.err);
  REQUIRE(run.exit_code == 0);
  const LabelVolume posed = read_volume(folder / "posed.nrrd").volume;
  const auto voxels = double(volume.grid.voxel_count() + posed.grid.voxel_count());
  // The labels of both volumes take two bytes a voxel, all other memory at most 0.6 bytes.
  CHECK(run.peak_mb * 1048576 / voxels < 2.6);
}
