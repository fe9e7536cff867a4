// SPDX-License-Identifier: AGPL-3.0-or-later
// An arm from a real scan, bent at one joint. It is prepared by the steps that the commands take: the bone labels are
// guessed, the skin weights are computed by heat diffusion, and the joint is fitted to the bones beside it.
#pragma once

#include <memory>
#include <string>

#include "core/autorig/joint_axis_fit.h"
#include "core/binding/heat_diffusion.h"
#include "core/bones/guess_bone_labels.h"
#include "core/resample/fem_shape.h"
#include "core/resample/pose_path.h"
#include "core/resample/resample.h"
#include "core/rig/pose.h"
#include "core/rig_io/rig_io.h"
#include "core/volume_io/volume_io.h"

namespace limber::test {

class BentArm {
 public:
  BentArm(const std::string& volume_file, const std::string& rig_file, const std::string& bone = "Forearm")
      : file_(read_volume(volume_file)),
        tissues(merge_tissue_tables(file_.tissues, nullptr)),
        given_rig_(read_armature_file(rig_file).armature),
        bone_(bone) {
    if (const auto guess = guess_bone_tissue(volume, tissues, given_rig_))
      tissues = with_bones(tissues, {tissues.find(guess->label)->file_value});
    for (const Tissue& each : tissues.tissues) is_bone[each.label] = limber::is_bone(each.kind);
    parts_ = split_bones(volume, tissue, tissues, given_rig_);
    weights = diffuse_heat(volume, tissue, tissues, given_rig_, parts_);
    bend(0);
  }

  void bend(double degrees) {
    rig = given_rig_;
    pose = rest_pose(rig);
    flex(pose, rig, require_bone(rig, bone_), degrees);
    FittedPose fitted = fit_joints(volume, tissue, parts_, rig, pose);
    rig = std::move(fitted.armature);
    pose = std::move(fitted.pose);
  }

  std::vector<RigidTransform> motions(double t) const {
    return bone_motions(weights.bones(), rig, part_of_pose(pose, t));
  }
  std::shared_ptr<const FemShape> solved(const Fem& fem) const {
    return solve_shape(volume, tissue, tissues, is_bone, weights, rig, pose, fem);
  }
  Posed posed(const Method& method) const { return resample(volume, tissues, rig, weights, pose, method); }

 private:
  VolumeFile file_;

 public:
  const LabelVolume& volume = file_.volume;
  TissueTable tissues;
  LabelSet is_bone = LabelSet(65536, 0);
  const TissueVoxels tissue{volume};
  SkinWeights weights;
  Armature rig;  // joints fitted to the bones of the volume
  Pose pose;

 private:
  Armature given_rig_;
  BoneParts parts_;
  std::string bone_;
};

}  // namespace limber::test
