// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/body/glide_poses.h"

#include <charconv>
#include <cstdio>

#include "core/base/error.h"
#include "core/platform/large_blocks.h"
#include "core/resample/posed_voxels.h"
#include "core/resample/rigid_weights.h"

namespace limber {

namespace {
constexpr double kLongest = 50;  // mm; a request for a longer shift is refused
// With the word `voxel`, a bone may move by at most this share of a voxel's edge. It is below 1 because of rounding
// errors.
constexpr double kOfAVoxel = 0.99;
}  // namespace

std::optional<GlideSettings> glide_settings(const std::string& word, double voxel, const std::string& where) {
  GlideSettings settings;
  if (word == "off") return std::nullopt;
  if (word == "voxel") settings.whole_mm = kOfAVoxel * voxel;
  if (word == "voxel" || word == "joint") return settings;
  double most = 0;
  const auto [stop, error] = std::from_chars(word.data(), word.data() + word.size(), most);
  if (error != std::errc() || stop != word.data() + word.size() || !(most > 0 && most <= kLongest))
    throw Error("this is not a value of --glide", where,
                "write off, voxel, joint, or a length of at most 50 mm, as in 20");
  settings.most_mm = most;
  return settings;
}

std::vector<std::vector<GlidedJoint>> glide_poses(std::vector<Pose>& poses, const GlideSettings& settings,
                                                  const Body& body, const Armature& rig, const TissueVoxels& tissue,
                                                  SkinWeights& weights, Progress& progress) {
  const LabelSets labels(body.tissues);
  weights = with_rigid_bones(weights, body.file.volume, tissue, body.tissues, labels.bone, rig, progress);
  std::vector<std::vector<GlidedJoint>> joints;
  for (Pose& pose : poses) {
    GlidedPose glided = glide_joints(body.file.volume, tissue, labels.bone, weights, rig, pose, settings, progress);
    pose = std::move(glided.pose);
    joints.push_back(std::move(glided.joints));
  }
  // Releases the lists of all bone voxels, whose memory would else stay allocated while the body is posed.
  return_free_memory();
  return joints;
}

std::string overlap_warning(const std::optional<std::vector<GlidedJoint>>& joints, std::int64_t claimed_twice) {
  std::string stuck;
  for (const GlidedJoint& joint : joints.value_or(std::vector<GlidedJoint>())) {
    if (joint.free) continue;
    char how[96];
    std::snprintf(how, sizeof how, " by %.1f mm after a shift of %.1f mm", joint.depth_after, glm::length(joint.shift));
    stuck += (stuck.empty() ? "" : ", ") + joint.bone + " still overlaps " + joint.against + how;
  }
  if (stuck.empty() && claimed_twice == 0) return "";
  const std::string claimed =
      claimed_twice == 0 ? ""
                         : std::to_string(claimed_twice) + (claimed_twice == 1 ? " voxel is covered by two bones: "
                                                                               : " voxels are covered by two bones: ");
  if (joints && stuck.empty())
    return claimed + "no bones of a joint overlap by more than half a voxel; other bones may overlap";
  return claimed + (joints ? stuck + ": --glide MM allows longer shifts" : "joints are not shifted") +
         "; the command limber fit-joint moves the axis of a joint";
}

}  // namespace limber
