// SPDX-License-Identifier: AGPL-3.0-or-later
// limber fk RIG|BVH [--frame N | --all-frames] [POSE-OPTIONS] [--json] [--angles]: prints the position of every joint,
// or its clinical angles.
//
// For a BVH without a pose, the command prints, in the file's own axes and units, the joints' global rotations and the
// positions of the End Sites too. For a rig (or a BVH with a pose) it prints posed heads and tails in world LPS mm, and
// each bone's rotation from rest to posed, which is the identity for a bone that does not move.
#include <cstdio>
#include <functional>
#include <memory>

#include <nlohmann/json.hpp>

#include "core/base/error.h"
#include "core/cmd/command.h"
#include "core/cmd/pose_options.h"
#include "core/motion/bvh.h"
#include "core/pose/clinical_angles.h"
#include "core/pose/joint_turns.h"
#include "core/rig_io/rig_io.h"

namespace limber::cmd {

namespace {
using Json = nlohmann::ordered_json;

struct FkOptions {
  std::string file;
  bool json = false, all_frames = false, angles = false;
  PoseOptions pose;
};

Json json_of(const glm::dvec3& v) { return {v.x, v.y, v.z}; }

template <class Joint>
Json joint_json(const std::vector<Joint>& joints, size_t i, const RigidTransform& world, const glm::dvec3& position) {
  const glm::dquat q = world.rotation.w < 0 ? -world.rotation : world.rotation;
  Json one = {{"name", joints[i].name},
              {"parent", nullptr},
              {"position", json_of(position)},
              {"rotation_wxyz", {q.w, q.x, q.y, q.z}}};
  if (joints[i].parent >= 0) one["parent"] = joints[joints[i].parent].name;
  return one;
}

Json fk_of_motion(const Motion& motion, std::optional<int> frame, const std::string& where) {
  const int wanted = frame.value_or(motion.frame_count > 0 ? 0 : -1);
  if (frame && wanted >= motion.frame_count)
    throw Error("there is no frame " + std::to_string(wanted), where,
                motion.frame_count > 0 ? "choose a frame from 0 to " + std::to_string(motion.frame_count - 1)
                                       : "leave --frame out: this is a rig");
  const auto world = forward_kinematics(motion, wanted);
  Json joints = Json::array();
  for (size_t j = 0; j < world.size(); ++j) {
    joints.push_back(joint_json(motion.joints, j, world[j], world[j].translation));
    if (motion.joints[j].end_site) joints.back()["end_site"] = json_of(world[j] * *motion.joints[j].end_site);
  }
  return joints;
}

Json fk_of_rig(const Armature& armature, const Pose& pose) {
  const auto posed = posed_from_rest(armature, pose);
  Json joints = Json::array();
  for (size_t b = 0; b < posed.size(); ++b) {
    joints.push_back(joint_json(armature.bones, b, posed[b], posed[b] * armature.bones[b].head));
    joints.back()["tail"] = json_of(posed[b] * armature.bones[b].tail);
  }
  return joints;
}

void print_table(const Json& joints) {
  print("%-28s %30s   %s\n", "joint", "position", "rotation (w x y z)");
  for (const Json& joint : joints) {
    const std::string name = joint["name"];
    const std::vector<double> p = joint["position"], q = joint["rotation_wxyz"];
    print("%-28s %10.3f%10.3f%10.3f   %8.5f %8.5f %8.5f %8.5f\n", one_line(name).c_str(), p[0], p[1], p[2], q[0], q[1],
          q[2], q[3]);
  }
}

// Returns the anatomical frames from which joint angles are measured. Throws Error if no bone of the rig is recognised
// by its name.
BodyFrames frames_for_angles(const Armature& armature, const std::string& file) {
  BodyFrames frames = body_frames(armature);
  if (joints_known_by_name(frames).empty())
    throw Error("no bone name of the rig is recognised, so no joint has clinical angles", file,
                "name its bones as in \"LeftThigh\", or leave --angles out");
  return frames;
}

// Returns {"left hip": {"flexion": 90.0, ...}, ...}, the form of "angles" in a pose file.
Json json_of(const JointAngles& angles) {
  Json joints = Json::object();
  for (const auto& [joint, motions] : angles)
    for (std::size_t i = 0; i < motions.size(); ++i)
      // Adding 0.0 turns -0 into 0.
      if (motions[i]) joints[name_of(joint)][std::string(motion_name(joint.joint, i))] = *motions[i] + 0.0;
  return joints;
}

void print_angles(const Armature& armature, const BodyFrames& frames, const JointAngles& angles) {
  print("%-22s %-22s %9s   %s\n", "joint", "motion", "degrees", "range");
  for (const auto& [joint, motions] : angles) {
    for (std::size_t i = 0; i < motions.size(); ++i) {
      if (!motions[i]) continue;
      const AngleRange range = range_of_motion(armature, frames, joint, i);
      const double shown = std::abs(*motions[i]) < 0.05 ? 0 : *motions[i];  // avoids printing "-0.0"
      const bool beyond = shown < range.low - 0.05 || shown > range.high + 0.05;
      print("%-22s %-22s %9.1f   %.0f to %.0f%s\n", name_of(joint).c_str(),
            std::string(motion_name(joint.joint, i)).c_str(), shown, std::round(range.low) + 0.0,
            std::round(range.high) + 0.0, beyond ? ", beyond" : "");
    }
    if (!at_gimbal_lock(joint.joint, motions)) continue;
    const bool is_first = joint.joint == BodyJoint::Wrist || joint.joint == BodyJoint::Girdle;
    print("%-22s gimbal lock: at 90 degrees of %s, %s turn about the same axis\n", "",
          std::string(motion_name(joint.joint, is_first ? 0 : 1)).c_str(),
          joint.joint == BodyJoint::Wrist ? "its other motion and the forearm's pronation" : "its other motions");
  }
}

std::string text_of(const Json& json) { return json.dump(-1, ' ', false, Json::error_handler_t::replace); }

void print_joints(const FkOptions& options, const Json& joints) {
  if (!options.json) return print_table(joints);
  print_json(text_of({{"joints", joints}}) + "\n");
}

// Prints {"frames": [{"joints": [...]}, ...]} with one line for each frame.
void print_frames(int count, const std::function<Json(int)>& frame_at) {
  print("{\"frames\":[");
  for (int frame = 0; frame < count; ++frame) print_json(text_of(frame_at(frame)) + (frame + 1 < count ? ",\n" : ""));
  print("]}\n");
}

void run_fk_of_motion(const FkOptions& options) {
  const Motion motion = read_bvh(Path(options.file));
  warn(motion.warnings);
  if (options.all_frames)
    return print_frames(motion.frame_count, [&](int frame) -> Json {
      return {{"joints", fk_of_motion(motion, frame, options.file)}};
    });
  print_joints(options, fk_of_motion(motion, options.pose.frame, options.file));
}

void run_fk(const FkOptions& options) {
  const Path path = options.file;
  std::string extension = path.extension().string();
  for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  if (extension == ".bvh" && !wants_pose(options.pose) && !options.angles) return run_fk_of_motion(options);
  const ArmatureFile rig = read_armature_file(path);
  warn(rig.warnings);
  const BodyFrames frames = options.angles ? frames_for_angles(rig.armature, options.file) : BodyFrames();
  const auto angles_in = [&](const Pose& pose) { return clinical_angles(rig.armature, frames, pose); };
  if (options.all_frames) {
    const auto poses = read_all_poses(options.pose, rig.armature);
    return print_frames(static_cast<int>(poses.size()), [&](int frame) -> Json {
      if (options.angles) return {{"angles", json_of(angles_in(poses[frame]))}};
      return {{"joints", fk_of_rig(rig.armature, poses[frame])}};
    });
  }
  const Pose pose = read_pose_options(options.pose, rig.armature);
  if (!options.angles) return print_joints(options, fk_of_rig(rig.armature, pose));
  if (!options.json) return print_angles(rig.armature, frames, angles_in(pose));
  print_json(text_of({{"angles", json_of(angles_in(pose))}}) + "\n");
}
}  // namespace

void add_fk(CLI::App& app) {
  auto* command = app.add_subcommand(
      "fk", "prints the world positions and rotations of every joint of a rig or a motion (forward kinematics)");
  auto options = std::make_shared<FkOptions>();
  command
      ->add_option(
          "FILE", options->file,
          "a rig (prints posed positions in LPS mm and rotations from rest) or a BVH file (prints in its own axes and "
          "units)")
      ->required();
  auto* json =
      command->add_flag("--json", options->json, "print {\"joints\": [{name, parent, position, rotation_wxyz}]}");
  command->add_flag(
      "--angles", options->angles,
      "print the clinical angles of every joint, measured from the anatomical position; with --json as a pose "
      "file: {\"angles\": {joint: {motion: degrees}}}");
  add_pose_options(*command, options->pose);
  command
      ->add_flag("--all-frames", options->all_frames,
                 "print every frame of the motion: {\"frames\": [{\"joints\": ...}]}")
      ->needs(json)
      ->excludes("--frame");
  command->callback([options] { run_fk(*options); });
}

}  // namespace limber::cmd
