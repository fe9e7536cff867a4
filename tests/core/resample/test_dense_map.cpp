// SPDX-License-Identifier: AGPL-3.0-or-later
// Checks that the editor's preview agrees with the program's output: labels read through the dense map equal those that
// `limber resample` writes.
#include <algorithm>

#include <doctest/doctest.h>

#include "core/binding/heat_diffusion.h"
#include "core/deform/inverse_map.h"
#include "core/phantom/phantom.h"
#include "core/pose/pose_io.h"
#include "core/resample/output_grid.h"
#include "core/resample/resample.h"
#include "core/rig_io/rig_io.h"
#include "core/skin/weights_io.h"
#include "tests/support/program.h"

using namespace limber;
using limber::test::TemporaryFolder;

namespace {

// The phantom arm with its weights, in memory and in files.
struct Arm {
  Phantom phantom = make_arm_phantom(3);
  TissueVoxels tissue{phantom.volume};
  SkinWeights weights = diffuse_heat(phantom.volume, phantom.tissues, phantom.armature);
  TemporaryFolder folder;

  Arm() {
    write_volume(phantom.volume, folder / "volume.nrrd", phantom.tissues);
    write_tissue_table(phantom.tissues, folder / "tissues.json");
    write_armature(phantom.armature, folder / "rig.json");
    write_weights(weights, phantom.volume, tissue, folder / "weights.nrrd");
  }

  Pose bent() const {
    Pose pose = rest_pose(phantom.armature);
    flex(pose, phantom.armature, require_bone(phantom.armature, "Forearm"), 75);
    const int hand = require_bone(phantom.armature, "Hand");
    pose.rotation[hand] = glm::angleAxis(0.7, glm::normalize(glm::dvec3(0.3, -0.2, 1)));
    return pose;
  }

  // Returns the volume that `limber resample` writes.
  LabelVolume resampled_by_program(const Pose& pose, const std::string& method, bool nearest) const {
    write_pose(pose, phantom.armature, folder / "pose.json");
    std::vector<std::string> words{"resample", folder / "volume.nrrd", "--tissues", folder / "tissues.json",
                                   "--rig",    folder / "rig.json",    "--weights", folder / "weights.nrrd",
                                   "--pose",   folder / "pose.json",   "--method",  method,
                                   "-o",       folder / "posed.nrrd"};
    if (nearest) words.push_back("--nearest");
    const auto run = test::run_limber(words);
    INFO(run.err);
    REQUIRE(run.exit_code == 0);
    VolumeFile file = read_volume(folder / "posed.nrrd");
    const FileValueIndex ours(phantom.tissues);
    std::vector<Label> label_of(65536, 0);
    for (const Tissue& tissue : file.tissues.tissues) label_of[tissue.label] = ours.find(tissue.file_value)->label;
    for (Label& label : file.volume.voxels) label = label_of[label];
    return std::move(file.volume);
  }

  // Counts the voxels of `posed` whose label differs from the label at the rest point that the dense map gives.
  std::int64_t differing(const LabelVolume& posed, const Pose& pose, Blend blend, bool nearest) const {
    LabelSet bone(65536, 0), soft(65536, 1);
    std::vector<int> priority(65536, 0);
    for (const Tissue& tissue : phantom.tissues.tissues) {
      priority[tissue.label] = tissue.priority;
      bone[tissue.label] = is_bone(tissue.kind);
      soft[tissue.label] = !is_bone(tissue.kind);
    }
    const auto motions = posed_from_rest(phantom.armature, pose);
    const PosedLattice lattice(phantom.volume, tissue, weights, motions, blend, glm::dvec3(1));
    const RigidBones bones(lattice, weights, bone, motions);
    const OutputGrid output = output_grid(lattice, bones);
    CHECK(output.grid == posed.grid);
    const TissueDepth depth(tissue, phantom.volume.grid.spacing);
    const LabelSampler sampler(phantom.volume);
    std::vector<std::int64_t> bricks(tissue.bricks().size()), pieces(bones.pieces().size());
    for (size_t i = 0; i < bricks.size(); ++i) bricks[i] = std::int64_t(i);
    for (size_t i = 0; i < pieces.size(); ++i) pieces[i] = std::int64_t(i);
    InverseMap map;
    map.reset(output.range);
    rasterize_cells(map, lattice, bricks, priority, &depth);
    bones.paint(map, pieces, sampler, nearest, &depth);

    std::int64_t count = 0;
    for (std::int64_t i = 0; i < map.count(); ++i) {
      Label read = 0;
      const glm::dvec3 rest = map.rest[i];
      if (map.bone[i] != InverseMap::kNoBone) {
        read = nearest ? sampler.nearest(rest) : sampler.tissue(rest, bone);
        if (!bone[read]) read = sampler.nearest_of(rest, bone, 8);
      } else if (map.cell[i] != InverseMap::kNoCell) {
        const Label own = phantom.volume.voxels[map.cell[i]];
        read = nearest ? own : sampler.tissue(rest);
        if (read == 0) read = own;
        if (bone[read]) {
          Label around = nearest ? Label{0} : sampler.tissue(rest, soft);
          if (around == 0) around = sampler.prevailing(rest, soft, 8);
          if (around) read = around;
        }
      }
      count += read != posed.voxels[i];
    }
    return count;
  }
};

}  // namespace

TEST_CASE(
    "dense map: the labels read through it are those that `limber resample` writes, bit for bit, but for the voxels "
    "that it says it mended" *
    doctest::test_suite("slow")) {
  const Arm arm;
  const Pose pose = arm.bent();
  for (const auto& [method, name, blend] : {std::tuple{Method(Blend::Linear), "lbs", Blend::Linear},
                                            {Method(Blend::DualQuaternion), "dqs", Blend::DualQuaternion}})
    for (const bool nearest : {true, false}) {
      INFO(name, nearest ? ", nearest" : "");
      const Posed live = resample(arm.phantom.volume, arm.phantom.tissues, arm.phantom.armature, arm.weights, pose,
                                  method, {.nearest = nearest});
      const LabelVolume written = arm.resampled_by_program(pose, name, nearest);
      CHECK(live.volume.grid.size == written.grid.size);
      CHECK(live.volume.voxels == written.voxels);
      const std::int64_t differing = arm.differing(live.volume, pose, blend, nearest);
      if (nearest) CHECK(live.report.mended_voxels == 0);
      CHECK(differing <= live.report.mended_voxels + live.report.new_skin_voxels + live.report.filled_air_voxels);
      CHECK(live.report.mended_voxels * 100 < live.report.tissue_voxels);
    }
}
