// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/cmd/info_rig.h"

#include <algorithm>

#include <nlohmann/json.hpp>

#include "core/base/error.h"
#include "core/base/json_text.h"
#include "core/cmd/command.h"
#include "core/motion/bvh.h"
#include "core/rig_io/gltf_rig.h"
#include "core/rig_io/obj_summary.h"
#include "core/rig_io/rig_io.h"

namespace limber::cmd {

namespace {
using Json = nlohmann::ordered_json;

std::string extension_of(const Path& path) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return std::tolower(c); });
  return extension;
}

Json json_of(const glm::dvec3& v) { return {v.x, v.y, v.z}; }

const char* type_name(JointLimits::Type type) {
  constexpr const char* kNames[] = {"free", "fixed", "hinge", "ball"};
  return kNames[static_cast<int>(type)];
}

Json json_of(const Armature& armature) {
  Json bones = Json::array();
  for (const Bone& bone : armature.bones) {
    Json one = {{"name", bone.name}, {"parent", nullptr}, {"head", json_of(bone.head)}, {"tail", json_of(bone.tail)}};
    if (bone.parent >= 0) one["parent"] = armature.bones[bone.parent].name;
    if (bone.roll != 0) one["roll"] = bone.roll;
    if (bone.limits.type != JointLimits::Type::Free) one["limits"] = type_name(bone.limits.type);
    bones.push_back(std::move(one));
  }
  return bones;
}

Json json_of(const Motion& motion) {
  constexpr const char* kChannels[] = {"Xposition", "Yposition", "Zposition", "Xrotation", "Yrotation", "Zrotation"};
  Json joints = Json::array();
  for (const BvhJoint& joint : motion.joints) {
    Json one = {
        {"name", joint.name}, {"parent", nullptr}, {"offset", json_of(joint.offset)}, {"channels", Json::array()}};
    if (joint.parent >= 0) one["parent"] = motion.joints[joint.parent].name;
    for (BvhChannel channel : joint.channels) one["channels"].push_back(kChannels[static_cast<int>(channel)]);
    if (joint.end_site) one["end_site"] = json_of(*joint.end_site);
    joints.push_back(std::move(one));
  }
  return joints;
}

Json describe_rig(const Armature& armature, const std::string& format) {
  return {{"kind", "rig"}, {"format", format}, {"bones", json_of(armature)}};
}

Json describe_motion(const Path& file) {
  const Motion motion = read_bvh(file);
  warn(motion.warnings);
  if (motion.frame_count == 0) return describe_rig(armature_of(motion), "BVH");
  return {{"kind", "motion"},
          {"format", "BVH"},
          {"joints", json_of(motion)},
          {"channels", motion.channel_count},
          {"frames", motion.frame_count},
          {"frame_time", motion.frame_time}};
}

Json describe_gltf(const Path& file) {
  const GltfSummary gltf = parse_gltf(read_file(file), extension_of(file) == ".glb", file.string());
  warn(gltf.warnings);
  const bool is_rig = !gltf.armature.bones.empty();
  Json json = {{"kind", is_rig ? "rig" : "mesh"},
               {"format", "glTF"},
               {"nodes", gltf.nodes},
               {"meshes", gltf.meshes},
               {"vertices", gltf.vertices},
               {"triangles", gltf.triangles},
               {"skins", gltf.skins},
               {"joints", gltf.armature.bones.size()},
               {"animations", gltf.animations}};
  if (is_rig) json["bones"] = json_of(gltf.armature);
  return json;
}

Json describe_obj(const Path& file) {
  const ObjSummary obj = read_obj_summary(file);
  return {{"kind", "mesh"},
          {"format", "OBJ"},
          {"vertices", obj.vertices},
          {"faces", obj.faces},
          {"groups", obj.groups},
          {"lower", json_of(obj.lower)},
          {"upper", json_of(obj.upper)}};
}

// The kind of a JSON file, found from its key "bones": a list in a rig, an object of rotations in a pose. In a file of
// another program, "bones" may be an object without rotations.
enum class JsonFile { Rig, Pose, Other };

bool is_rotation(const nlohmann::json& json) {
  return json.is_object() && (json.contains("rotation_wxyz") || json.contains("axis"));
}

JsonFile kind_of_json(const Path& file) {
  const auto json = nlohmann::json::parse(checked_json(read_file(file), file.string()), nullptr, false);
  if (!json.is_object() || !json.contains("bones")) return JsonFile::Other;
  const auto& bones = json["bones"];
  if (bones.is_object()) return std::all_of(bones.begin(), bones.end(), is_rotation) ? JsonFile::Pose : JsonFile::Other;
  return JsonFile::Rig;
}

Json describe_pose(const Path& file) {
  const auto json = nlohmann::json::parse(checked_json(read_file(file), file.string()), nullptr, false);
  Json names = Json::array();
  for (const auto& [name, value] : json["bones"].items()) names.push_back(name);
  return {{"kind", "pose"}, {"bones", names}};
}

Json describe(const Path& file) {
  const std::string extension = extension_of(file);
  if (extension == ".bvh") return describe_motion(file);
  if (extension == ".gltf" || extension == ".glb") return describe_gltf(file);
  if (extension == ".obj") return describe_obj(file);
  if (extension == ".json" && kind_of_json(file) == JsonFile::Pose) return describe_pose(file);
  const ArmatureFile rig = read_armature_file(file);
  warn(rig.warnings);
  return describe_rig(rig.armature, rig.format);
}
}  // namespace

bool is_rig_or_motion(const Path& file) {
  const std::string extension = extension_of(file);
  for (const char* own : {".bvh", ".vtk", ".arm", ".gltf", ".glb", ".obj"})
    if (extension == own) return true;
  std::error_code unreadable;
  return extension == ".json" && std::filesystem::is_regular_file(file, unreadable) &&
         kind_of_json(file) != JsonFile::Other;
}

std::string describe_rig_or_motion(const Path& file) {
  return describe(file).dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace limber::cmd
