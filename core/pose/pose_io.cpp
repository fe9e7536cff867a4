// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/pose/pose_io.h"

#include <cmath>
#include <numbers>

#include <nlohmann/json.hpp>

#include "core/base/error.h"
#include "core/base/json_text.h"
#include "core/pose/anatomical_pose.h"

namespace limber {

namespace {
using Json = nlohmann::json;

// A pose file of more bytes is refused. Even a file with rotations of 4096 bones is far smaller.
constexpr std::uint64_t kMostBytes = 64 << 20;
// A pose file with a larger number, mm or degrees, is refused. No body moves by 1000 km.
constexpr double kLargest = 1e9;

std::vector<double> numbers(const Json& value, size_t count, const char* key, const std::string& where) {
  const std::string what =
      "\"" + std::string(key) + "\" is not " + std::to_string(count) + " finite number" + (count > 1 ? "s" : "");
  const Json list = count == 1 ? Json::array({value}) : value;
  if (!list.is_array() || list.size() != count) throw Error(what, where, "write the numbers as a list");
  std::vector<double> read;
  for (const Json& one : list) {
    if (!one.is_number() || !(std::abs(one.get<double>()) <= kLargest))
      throw Error(what, where, "write numbers up to 1e9");
    read.push_back(one.get<double>());
  }
  return read;
}

glm::dquat unit(const glm::dquat& q, const std::string& where) {
  const double length = glm::length(q);
  if (!(length > 1e-9) || !std::isfinite(length))
    throw Error("the quaternion cannot be normalised", where, "give w, x, y, z, not all zero");
  // Keeps a quaternion of unit length bit for bit, so that a file that was written reads back unchanged.
  return std::abs(length - 1) < 1e-15 ? q : q / length;
}

glm::dquat rotation_of(const Json& value, const std::string& where) {
  if (value.is_object() && value.contains("rotation_wxyz")) {
    const auto q = numbers(value["rotation_wxyz"], 4, "rotation_wxyz", where);
    return unit(glm::dquat(q[0], q[1], q[2], q[3]), where);
  }
  if (value.is_object() && value.contains("axis") && value.contains("degrees")) {
    const auto axis = numbers(value["axis"], 3, "axis", where);
    const double degrees = numbers(value["degrees"], 1, "degrees", where)[0];
    const glm::dvec3 direction(axis[0], axis[1], axis[2]);
    const double length = glm::length(direction);
    if (!(length > 1e-9) || !std::isfinite(length))
      throw Error("the axis has no direction", where, "give three numbers, not all zero");
    return glm::angleAxis(degrees * std::numbers::pi / 180, direction / length);
  }
  throw Error("the bone has no rotation", where, "write {\"rotation_wxyz\": [4]} or {\"axis\": [3], \"degrees\": d}");
}

// Applies {"left hip": {"flexion": 90}} to a pose.
Pose with_angles(const Json& table, const std::string& where, const Armature& armature, const Pose& pose) {
  if (!table.is_object())
    throw Error("\"angles\" is not a table of joints", where, "write {\"left hip\": {\"flexion\": 90}}");
  const BodyFrames frames = body_frames(armature);
  JointAngles angles;
  for (const auto& [joint, motions] : table.items()) {
    const std::string here = where + ", joint " + joint.substr(0, 60);
    if (!motions.is_object()) throw Error("the joint has no table of angles", here, "write {\"flexion\": 90}");
    JointAngles asked;
    for (const auto& [motion, degrees] : motions.items())
      add_joint_angle(asked, joint + " " + motion, numbers(degrees, 1, motion.c_str(), here)[0], here);
    for (const auto& [one, given] : with_sides(frames, asked, here))
      for (std::size_t i = 0; i < given.size(); ++i)
        if (given[i]) angles[one][i] = given[i];
  }
  return with_joint_angles(armature, frames, pose, angles);
}

void set_bones(const Json& table, const std::string& where, const Armature& armature, Pose& pose) {
  for (const auto& [name, value] : table.items()) {
    const std::string here = where + ", bone " + name.substr(0, 60);
    const auto bone = armature.find(name);
    if (!bone) throw Error("the rig has no such bone", here, "use the rig's names (limber info RIG lists them)");
    pose.rotation[*bone] = rotation_of(value, here);
  }
}
}  // namespace

Pose parse_pose(const std::string& text, const std::string& where, const Armature& armature) {
  try {
    const Json json = Json::parse(checked_json(text, where));
    const bool bones = json.is_object() && json.contains("bones"), angles = json.is_object() && json.contains("angles");
    if ((!bones && !angles) || (bones && !json["bones"].is_object()))
      throw Error(
          "there is no table of bones", where,
          "give {\"bones\": {name: {\"axis\": [3], \"degrees\": d}}} or {\"angles\": {joint: {motion: degrees}}}");
    Pose pose = rest_pose(armature);
    if (bones) set_bones(json["bones"], where, armature, pose);
    if (angles) pose = with_angles(json["angles"], where, armature, pose);
    if (json.contains("root_translation")) {
      const auto t = numbers(json["root_translation"], 3, "root_translation", where);
      pose.root_translation = {t[0], t[1], t[2]};
    }
    return pose;
  } catch (const Json::exception& error) {
    throw Error("this is not valid JSON (" + std::string(error.what()).substr(0, 160) + ")", where, "correct the file");
  }
}

Pose read_pose(const Path& path, const Armature& armature) {
  return parse_pose(read_file(path, kMostBytes), path.string(), armature);
}

void write_pose(const Pose& pose, const Armature& armature, const Path& path) {
  nlohmann::ordered_json bones = nlohmann::ordered_json::object();
  for (size_t i = 0; i < armature.bones.size(); ++i) {
    const glm::dquat& q = pose.rotation[i];
    if (q != glm::dquat(1, 0, 0, 0)) bones[armature.bones[i].name]["rotation_wxyz"] = {q.w, q.x, q.y, q.z};
  }
  nlohmann::ordered_json json;
  json["bones"] = bones;
  const glm::dvec3& t = pose.root_translation;
  if (t != glm::dvec3(0)) json["root_translation"] = {t.x, t.y, t.z};
  write_file_atomically(path, json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n");
}

}  // namespace limber
