// SPDX-License-Identifier: AGPL-3.0-or-later
// Judges a repair by the voxels of resampled bodies, also at angles that the repair has not used, never by its own
// prediction.
#include "core/prepare/prepare.h"
#include "core/repair/repair_joint.h"

#include <cmath>

#include <doctest/doctest.h>

#include "core/base/error.h"
#include "core/base/parallel.h"
#include "core/binding/heat_diffusion.h"
#include "core/bones/bone_parts.h"
#include "core/phantom/phantom.h"
#include "core/resample/resample.h"
#include "core/rig_io/rig_io.h"
#include "core/volume_io/volume_io.h"
#include "tests/support/shared_data.h"

using namespace limber;
using namespace limber::test;

namespace {

struct Limb {
  LabelVolume volume;
  TissueTable tissues;
  Armature rig;
  TissueVoxels tissue;
  SkinWeights heat;
  int bone = -1;

  Limb(LabelVolume given, TissueTable table, Armature armature, const std::string& name)
      : volume(std::move(given)),
        tissues(std::move(table)),
        rig(std::move(armature)),
        tissue(volume) {
    bone = require_bone(rig, name);
    heat = diffuse_heat(volume, tissue, tissues, rig, split_bones(volume, tissue, tissues, rig));
  }
  WeightedBody body() const { return {volume, tissue, tissues, rig}; }
};

Limb phantom_arm(double spacing) {
  Phantom phantom = make_arm_phantom(spacing);
  return {std::move(phantom.volume), std::move(phantom.tissues), std::move(phantom.armature), "Forearm"};
}

// Reads a limb from shared files.
//   tissues  a tissue table, or empty: the tissues of the volume's file
//   bone     the rig bone at whose head the repaired joint is
//   spacing  resamples the volume to this spacing, mm; none: keeps the file's spacing
Limb shared_limb(const std::string& volume, const std::string& rig, const std::string& tissues, const std::string& bone,
                 std::optional<double> spacing = {}) {
  VolumeFile file = read_volume(shared_path(volume));
  if (spacing) file.volume = regrid(file.volume, glm::dvec3(*spacing));
  std::optional<TissueTable> table;
  if (!tissues.empty()) table = read_tissue_table(shared_path(tissues));
  TissueTable merged = merge_tissue_tables(file.tissues, table ? &*table : nullptr);
  return {std::move(file.volume), std::move(merged), read_armature(shared_path(rig)), bone};
}

struct Counted {
  double sum = 0;  // |skin| + |fat| + |muscle| volume change in %, by counts of voxels
  std::int64_t overlap = 0, muscle_overlap = 0;
};

Counted counted(const Limb& limb, const SkinWeights& weights, const Pose& pose, Blend blend) {
  const Posed posed = resample(limb.volume, limb.tissues, limb.rig, weights, pose, blend);
  Counted out{.overlap = posed.report.overlap_voxels};
  for (const TissueKind kind : {TissueKind::Skin, TissueKind::Fat, TissueKind::Muscle}) {
    double before = 0, after = 0;
    const std::vector<TissueKind> kinds = limb.tissues.kinds();
    for (const Label label : limb.volume.voxels) before += kinds[label] == kind;
    for (const Label label : posed.volume.voxels) after += kinds[label] == kind;
    if (before > 0) out.sum += 100 * std::abs(after / before - 1);
  }
  for (const Tissue& tissue : limb.tissues.tissues)
    if (tissue.kind == TissueKind::Muscle) out.muscle_overlap += posed.report.overlap_by_label[tissue.label];
  return out;
}

Counted counted(const Limb& limb, const SkinWeights& weights, double degrees, Blend blend) {
  Pose pose = rest_pose(limb.rig);
  flex(pose, limb.rig, limb.bone, degrees);
  return counted(limb, weights, pose, blend);
}

// Returns the means over the turns that joint_motion gives for this joint.
Counted mean_counted(const Limb& limb, const SkinWeights& weights, Blend blend) {
  const JointMotion motion = joint_motion(limb.rig, limb.bone, {});
  Counted mean;
  for (const JointTurn& turn : motion.turns) {
    const Counted one = counted(limb, weights, turned(limb.rig, motion, turn), blend);
    mean.sum += one.sum / std::ssize(motion.turns);
    mean.overlap += one.overlap;
  }
  return mean;
}

bool bones_are_equal(const Limb& limb, const SkinWeights& a, const SkinWeights& b) {
  const std::vector<TissueKind> kinds = limb.tissues.kinds();
  bool equal = true;
  for (std::int64_t brick = 0; brick < a.chunk_count(); ++brick) {
    const std::int64_t first = limb.tissue.bricks()[brick].first;
    limb.tissue.for_each(brick, brick + 1, [&](std::int64_t index, const glm::ivec3& voxel) {
      if (is_bone(kinds[limb.volume.at(voxel)]))
        equal = equal && a.chunk(brick)[index - first] == b.chunk(brick)[index - first];
    });
  }
  return equal;
}

}  // namespace

TEST_CASE("repair joint: a phantom's elbow keeps more of its volume, also between the turns, and overlaps no more" *
          doctest::test_suite("slow")) {
  const Limb arm = phantom_arm(5);
  for (const Blend blend : {Blend::DualQuaternion, Blend::Linear, Blend::Mixed}) {
    const JointRepair repair =
        repair_joint(arm.body(), arm.heat, arm.bone, {.range = TurnRange{0, 90}, .blend = blend});
    CHECK(repair.is_better);
    CHECK(repair.changed > 0);
    CHECK(bones_are_equal(arm, arm.heat, repair.weights));
    double before = 0, after = 0;
    std::int64_t overlap_before = 0, overlap_after = 0;
    for (const double degrees : {33.0, 56.0, 80.0}) {
      const Counted heat = counted(arm, arm.heat, degrees, blend),
                    repaired = counted(arm, repair.weights, degrees, blend);
      MESSAGE(degrees, " degrees: ", heat.sum, " -> ", repaired.sum, " %, ", heat.overlap, " -> ", repaired.overlap);
      before += heat.sum, after += repaired.sum;
      overlap_before += heat.overlap, overlap_after += repaired.overlap;
    }
    // The mixed blend preserves the volume of flesh by itself, so a repair gains little.
    CHECK(after < (blend == Blend::Mixed ? 1.0 : blend == Blend::Linear ? 0.8 : 0.6) * before);
    CHECK(overlap_after <= overlap_before);
  }
}

TEST_CASE("repair joint: the figures that it tells are those of the resampled body") {
  const Limb arm = phantom_arm(6);
  const JointRepair repair =
      repair_joint(arm.body(), arm.heat, arm.bone, {.range = TurnRange{0, 60}, .blend = Blend::DualQuaternion});
  REQUIRE(repair.is_better);
  for (const bool is_after : {false, true})
    for (const TurnFigures& figures : is_after ? repair.after : repair.before) {
      const Counted one =
          counted(arm, is_after ? repair.weights : arm.heat, glm::degrees(figures.turn.angle), Blend::DualQuaternion);
      CHECK(figures.sum() == doctest::Approx(one.sum).epsilon(1e-6));
      CHECK(figures.overlap_voxels == one.overlap);
    }
  CHECK(mean_sum(repair.after) < mean_sum(repair.before));
}

TEST_CASE("repair joint: one thread gives what two give, bit for bit") {
  const Limb arm = phantom_arm(6);
  std::vector<SkinWeights> found;
  for (const int threads : {1, 2}) {
    const ThreadCount count(threads);
    found.push_back(
        repair_joint(arm.body(), arm.heat, arm.bone, {.range = TurnRange{0, 45}, .blend = Blend::DualQuaternion})
            .weights);
  }
  CHECK(found[0] == found[1]);
}

TEST_CASE("repair joint: where nothing may change the weights come back as they were, and the sentence says so") {
  const Limb arm = phantom_arm(8);
  BoneSet others(arm.rig.bones.size(), 1);
  others[arm.bone] = 0;  // only the joint's bone is not locked: no other can exchange weight with it
  const JointRepair repair =
      repair_joint(arm.body(), arm.heat, arm.bone, {.range = TurnRange{0, 45}, .locked = others});
  CHECK_FALSE(repair.is_better);
  CHECK(repair.changed == 0);
  CHECK(repair.weights == arm.heat);
  CHECK(repair.before[0].overlap_voxels == repair.after[0].overlap_voxels);
  CHECK(describe(repair, arm.rig, arm.bone).find("is not changed") != std::string::npos);
}

TEST_CASE("repair joint: a body whose tissues have no kinds is refused with what to do") {
  Limb arm = phantom_arm(8);
  for (Tissue& tissue : arm.tissues.tissues)
    if (!is_bone(tissue.kind)) tissue.kind = TissueKind::Unknown;
  CHECK_THROWS_WITH_AS(repair_joint(arm.body(), arm.heat, arm.bone), doctest::Contains("in a tissue table"), Error);
}

TEST_CASE("repair joint: a locked bone keeps every bit of its weights") {
  const Limb arm = phantom_arm(5);
  BoneSet locked(arm.rig.bones.size(), 0);
  const int hand = require_bone(arm.rig, "Hand");
  locked[hand] = 1;
  const JointRepair repair = repair_joint(
      arm.body(), arm.heat, arm.bone, {.range = TurnRange{0, 60}, .blend = Blend::DualQuaternion, .locked = locked});
  std::int64_t differ = 0;
  for (std::int64_t brick = 0; brick < arm.heat.chunk_count(); ++brick)
    for (std::size_t i = 0; i < arm.heat.chunk(brick).size(); ++i) {
      const Influence before = arm.heat.chunk(brick)[i], after = repair.weights.chunk(brick)[i];
      differ += before.of(hand) != after.of(hand);
    }
  CHECK(repair.is_better);
  CHECK(differ == 0);
}

TEST_CASE(
    "repair joint: a locked bone that holds half of the moving share leaves room, and its own bone may not be locked") {
  // Gives the hand half of the forearm's weight everywhere, so the weight that moves with the joint does not change.
  Limb arm = phantom_arm(6);
  const JointRepairSettings settings{.range = TurnRange{0, 60}, .blend = Blend::DualQuaternion};
  const int hand = require_bone(arm.rig, "Hand");
  SkinWeights shared = arm.heat;
  for (std::int64_t brick = 0; brick < shared.chunk_count(); ++brick) {
    std::vector<Influence> chunk(shared.chunk(brick).begin(), shared.chunk(brick).end());
    for (Influence& influence : chunk) {
      std::vector<std::pair<int, double>> weights;
      for (int i = 0; i < 4; ++i)
        if (influence.weight[i] > 0 && influence.bone[i] != arm.bone && influence.bone[i] != hand)
          weights.emplace_back(influence.bone[i], influence.weight[i]);
      const double moving = influence.of(arm.bone) + influence.of(hand);
      if (moving == 0 || weights.size() > 2) continue;
      for (const int bone : {arm.bone, hand}) weights.emplace_back(bone, moving * kFullWeight / 2);
      influence = quantize(weights);
    }
    shared.set_chunk(brick, chunk);
  }
  JointRepairSettings locked = settings;
  locked.locked.assign(arm.rig.bones.size(), 0);
  locked.locked[hand] = 1;
  const JointRepair free = repair_joint(arm.body(), shared, arm.bone, settings);
  const JointRepair held = repair_joint(arm.body(), shared, arm.bone, locked);
  CHECK(free.is_better);
  CHECK(held.is_better);
  CHECK(mean_sum(held.after) < mean_sum(held.before));
  locked.locked[arm.bone] = 1;
  CHECK_THROWS_WITH_AS(repair_joint(arm.body(), shared, arm.bone, locked), doctest::Contains("is locked"), Error);
}

TEST_CASE("repair joint: the real elbow keeps its tissues within 8 % at 45 degrees and within 37 % at 90" *
          doctest::test_suite("slow")) {
  NEEDS_SHARED("data/bender/man-arm-2mm.mha");
  const Limb arm = shared_limb("data/bender/man-arm-2mm.mha", "data/bender/man-arm-2mm-armature.vtk", "", "Forearm");
  const JointRepair repair =
      repair_joint(arm.body(), arm.heat, arm.bone, {.range = TurnRange{0, 90}, .blend = Blend::DualQuaternion});
  REQUIRE(repair.is_better);
  CHECK(bones_are_equal(arm, arm.heat, repair.weights));
  for (const double degrees : {33.0, 45.0, 56.0, 80.0, 90.0}) {
    const Counted heat = counted(arm, arm.heat, degrees, Blend::DualQuaternion),
                  repaired = counted(arm, repair.weights, degrees, Blend::DualQuaternion);
    MESSAGE(degrees, " degrees: ", heat.sum, " -> ", repaired.sum, " %, overlap ", heat.overlap, " -> ",
            repaired.overlap, ", muscle ", heat.muscle_overlap, " -> ", repaired.muscle_overlap);
    CHECK(repaired.sum < (degrees > 60 ? 0.4 : 0.3) * heat.sum);
    CHECK(repaired.overlap <= heat.overlap);
    CHECK(repaired.muscle_overlap <= heat.muscle_overlap);
    if (degrees == 45) CHECK(repaired.sum <= 8);
    if (degrees == 90) CHECK(repaired.sum <= 37);
  }
}

TEST_CASE("repair joint: knee, hip and shoulder of a whole body change less and overlap no more" *
          doctest::test_suite("slow")) {
  NEEDS_SHARED("data/bp3d/body_3mm_tissue.nrrd");
  Limb body = shared_limb("data/bp3d/body_3mm_tissue.nrrd", "data/bp3d/body.armature.json",
                          "data/bp3d/tissue.labels.json", "LeftShank", 4);
  for (const auto& [name, share] : {std::pair{"LeftShank", 0.5}, {"LeftThigh", 0.5}, {"LeftUpperArm", 0.8}}) {
    const std::string bone = name;
    body.bone = require_bone(body.rig, bone);
    const JointRepair repair = repair_joint(body.body(), body.heat, body.bone, {.blend = Blend::DualQuaternion});
    REQUIRE(repair.is_better);
    const Counted heat = mean_counted(body, body.heat, Blend::DualQuaternion),
                  repaired = mean_counted(body, repair.weights, Blend::DualQuaternion);
    MESSAGE(bone, ": ", heat.sum, " -> ", repaired.sum, " %, overlap ", heat.overlap, " -> ", repaired.overlap);
    CHECK(repaired.sum < share * heat.sum);
    CHECK(repaired.overlap <= heat.overlap);
  }
}
