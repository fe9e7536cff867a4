// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/pose/body_poses.h"

#include <algorithm>

#include "core/base/error.h"
#include "core/pose/anatomical_pose.h"

namespace limber {

namespace {

constexpr BodyPose kPoses[] = {
    {"stand", "Standing, arms hanging, palms to the body.",
     "shoulders abduction=8; elbows flexion=5; forearms pronation=90"},
    {"sit", "Sitting upright: thighs level, shanks down, forearms forward.",
     "hips flexion=90; hips abduction=5; knees flexion=90;"
     "shoulders flexion=10; shoulders abduction=10; elbows flexion=80; forearms pronation=90"},
    {"walk", "In the middle of a stride: the right leg and the left arm are in front.",
     "right hip flexion=25; right knee flexion=5;"
     "left hip extension=12; left knee flexion=15; left ankle dorsiflexion=8; left toes extension=15;"
     "left shoulder flexion=25; left elbow flexion=30; right shoulder extension=20; right elbow flexion=15;"
     "shoulders abduction=8; forearms pronation=90"},
    {"phone", "Standing with a telephone: the right hand is at the ear.",
     "right shoulder flexion=85; right shoulder internal rotation=20;"
     "right elbow flexion=145; right forearm pronation=108;"
     "left shoulder abduction=8; left elbow flexion=5; left forearm pronation=90"},
    {"arms-up", "Standing with both arms raised beside the head.",
     "shoulders abduction=160; elbows flexion=10; forearms pronation=20"},
    {"squat", "Squatting deeply, arms forward for balance.",
     "hips flexion=110; hips abduction=15; knees flexion=120; ankles dorsiflexion=25;"
     "shoulders flexion=80; elbows flexion=10; forearms pronation=90"},
    {"drive", "Sitting in a car, both hands at the wheel.",
     "hips flexion=85; hips abduction=8; knees flexion=60; ankles plantarflexion=5;"
     "shoulders flexion=55; shoulders abduction=5; elbows flexion=45; forearms pronation=100; hands curl=50"},
    {"supine", "As on a scanner's table: straight, arms a little apart, palms forward. The body stays upright.",
     "shoulders abduction=15"},
    {"reach", "Standing, the right arm stretched forward and up.",
     "right shoulder flexion=135; right elbow flexion=5; right forearm "
     "pronation=90;"
     "left shoulder abduction=8; left elbow flexion=5; left forearm pronation=90"},
    {"T", "Arms straight to the sides, palms down.", "shoulders abduction=90; forearms pronation=90"},
    {"A", "Arms straight and half way down, thumbs forward.", "shoulders abduction=45; forearms pronation=90"},
    {"anatomical", "The anatomical position, from which clinical angles are counted: straight, palms forward.", ""},
    {"kneel", "Kneeling upright, arms hanging.",
     "knees flexion=90; ankles plantarflexion=40;"
     "shoulders abduction=8; elbows flexion=5; forearms pronation=90"},
    {"type", "Sitting at a keyboard, palms down.",
     "hips flexion=90; hips abduction=5; knees flexion=90;"
     "shoulders flexion=20; shoulders abduction=10; elbows flexion=80; forearms pronation=160; wrists extension=10;"
     "hands curl=25"},
    {"fists", "Both hands closed, thumbs over the fingers.", "hands curl=85; thumbs abduction=40", false},
    {"open-hands", "Both hands flat, fingers and thumbs spread.", "hands curl=0; hands spread=18; thumbs abduction=45",
     false},
};

// The joints that every named pose of the whole body sets. A pose that gives no angles for one of these joints puts it
// in the anatomical position.
constexpr BodyJoint kLimbs[] = {BodyJoint::Shoulder, BodyJoint::Elbow, BodyJoint::Forearm, BodyJoint::Wrist,
                                BodyJoint::Hip,      BodyJoint::Knee,  BodyJoint::Ankle};

std::string plain(std::string_view name) {
  std::string letters;
  for (const char c : name) {
    if (c == ' ' || c == '-' || c == '_') continue;
    letters += c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  }
  return letters;
}

}  // namespace

std::span<const BodyPose> body_poses() { return kPoses; }

const BodyPose& require_body_pose(const std::string& name, const std::string& where) {
  std::string known;
  for (const BodyPose& pose : kPoses) {
    if (plain(pose.name) == plain(name)) return pose;
    known += std::string(known.empty() ? "" : ", ") + std::string(pose.name);
  }
  throw Error("no pose has this name", where + " " + name.substr(0, 60), "write one of: " + known);
}

JointAngles angles_of(const BodyPose& pose) {
  JointAngles angles;
  if (pose.whole)
    for (const BodyJoint joint : kLimbs)
      for (const BodySide side : {BodySide::Left, BodySide::Right}) angles[{joint, side}] = {0.0};
  for (std::string_view rest = pose.joints; !rest.empty();) {
    const std::size_t end = std::min(rest.find(';'), rest.size());
    add_joint_request(angles, std::string(rest.substr(0, end)), std::string(pose.name));
    rest.remove_prefix(std::min(end + 1, rest.size()));
  }
  return angles;
}

Pose with_request(const Armature& armature, const Pose& pose, const PoseRequest& request,
                  std::vector<std::string>& warnings) {
  if (request.empty()) return pose;
  const BodyFrames frames = body_frames(armature);
  if (frames.feet_point_back)
    warnings.emplace_back(
        "the rig's feet point to its back: if left and right are exchanged in its bones' names, the pose is wrong: "
        "exchange the names, or mirror volume and rig");
  if (const std::string apart = limbs_apart(armature, frames); !apart.empty()) warnings.push_back(apart);
  JointAngles angles;
  if (!request.name.empty()) {
    const std::string where = "--pose-name " + request.name.substr(0, 60);
    const JointAngles whole = angles_of(require_body_pose(request.name, "--pose-name"));
    angles = known_to_rig(frames, whole);
    if (const std::string lacking = lacking_within_limbs(frames, whole); !lacking.empty())
      warnings.push_back("the pose leaves out joints whose bones are not known by their names: " + lacking);
    if (angles.empty())
      throw Error("no joint of the rig's limbs lies between bones that are known by their names", where,
                  "name its bones as in \"LeftThigh\", or give the pose by --pose FILE");
  }
  for (const std::string& one : request.joints) {
    JointAngles asked;
    add_joint_request(asked, one, "--joint");
    asked = with_sides(frames, asked, "--joint \"" + one.substr(0, 60) + "\"");
    for (const auto& [joint, motions] : asked)
      for (std::size_t i = 0; i < motions.size(); ++i)
        if (motions[i]) angles[joint][i] = motions[i];
    const std::vector<std::string> beyond = beyond_usual(asked);
    warnings.insert(warnings.end(), beyond.begin(), beyond.end());
  }
  const Pose posed = with_joint_angles(armature, frames, pose, angles);
  if (const std::string beyond = beyond_limits(armature, posed); !beyond.empty()) warnings.push_back(beyond);
  return posed;
}

PoseLibrary body_pose_library(const Armature& armature) {
  const BodyFrames frames = body_frames(armature);
  const Pose rest = rest_pose(armature);
  PoseLibrary library;
  for (const BodyPose& named : kPoses) {
    const JointAngles angles = known_to_rig(frames, angles_of(named));
    if (angles.empty()) continue;
    const Pose pose = with_joint_angles(armature, frames, rest, angles);
    std::vector<int> bones = bones_of_joints(frames, angles);
    for (std::size_t b = 0; b < armature.bones.size(); ++b)
      if (pose.rotation[b] != rest.rotation[b]) bones.push_back(static_cast<int>(b));
    NamedPose entry = named_pose({}, std::string(named.name), armature, pose, bones);
    entry.root_translation.reset();
    library.push_back(std::make_shared<const NamedPose>(std::move(entry)));
  }
  return library;
}

}  // namespace limber
