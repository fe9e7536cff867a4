// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/rig_io/rig_io.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include <nlohmann/json.hpp>

#include "core/base/error.h"
#include "core/base/json_text.h"
#include "core/motion/bvh.h"
#include "core/rig_io/bender_rig.h"
#include "core/rig_io/gltf_rig.h"

namespace limber {

namespace {
using Json = nlohmann::json;

// A rig file with more bytes (64 MiB) is refused. A rig with 4096 bones, the largest allowed, needs far less.
constexpr std::uint64_t kMostBytes = 64 << 20;

std::string extension_of(const Path& path) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return std::tolower(c); });
  return extension;
}

// ---- Reading and writing numbers.

double number(const Json& value, const std::string& key, const std::string& where) {
  if (!value.is_number()) throw Error("\"" + key + "\" is not a number", where, "give a finite number");
  return value.get<double>();
}

double number_at(const Json& object, const char* key, const std::string& where) {
  if (!object.contains(key)) throw Error("\"" + std::string(key) + "\" is missing", where, "add it");
  return number(object[key], key, where);
}

glm::dvec3 vector_at(const Json& object, const char* key, const std::string& where) {
  if (!object.contains(key)) throw Error("\"" + std::string(key) + "\" is missing", where, "add it as three numbers");
  const Json& value = object[key];
  if (!value.is_array() || value.size() != 3)
    throw Error("\"" + std::string(key) + "\" is not three numbers", where, "write it as [x, y, z]");
  return {number(value[0], key, where), number(value[1], key, where), number(value[2], key, where)};
}

glm::dvec3 unit_axis(const glm::dvec3& axis, const std::string& where) {
  const double length = glm::length(axis);
  if (!(length > 1e-9) || !std::isfinite(length))
    throw Error("an axis has no direction", where, "give three finite numbers, not all zero");
  // Does not normalize an axis of unit length, so that a rig that was written reads back bit for bit.
  return std::abs(length - 1) < 1e-15 ? axis : axis / length;
}

constexpr double kRadiansPerDegree = std::numbers::pi / 180;
double radians(double degrees) { return degrees * kRadiansPerDegree; }

// Converts radians to degrees. If possible, returns a number that converts back to exactly the same radians, so that a
// rig that was written reads back unchanged.
double degrees_of(double angle) {
  const double middle = angle / kRadiansPerDegree;
  double below = middle, above = middle;
  for (int i = 0; i < 4; ++i) {
    if (radians(below) == angle) return below;
    if (radians(above) == angle) return above;
    below = std::nextafter(below, -HUGE_VAL);
    above = std::nextafter(above, HUGE_VAL);
  }
  return middle;
}

// ---- Joint limits.

JointLimits limits_of(const Json& value, const std::string& where) {
  if (!value.is_object() || !value.contains("type") || !value["type"].is_string())
    throw Error("the limits have no type", where, "write {\"type\": \"free\", \"fixed\", \"hinge\" or \"ball\", ...}");
  const std::string type = value["type"];
  JointLimits limits;
  if (type == "free") return limits;
  if (type == "fixed") {
    limits.type = JointLimits::Type::Fixed;
  } else if (type == "hinge") {
    limits.type = JointLimits::Type::Hinge;
    limits.axis = unit_axis(vector_at(value, "axis", where), where);
    limits.minimum = radians(number_at(value, "minimum_degrees", where));
    limits.maximum = radians(number_at(value, "maximum_degrees", where));
    if (limits.minimum > limits.maximum)
      throw Error("the hinge's minimum is above its maximum", where, "exchange the two angles");
  } else if (type == "ball") {
    limits.type = JointLimits::Type::Ball;
    if (value.contains("axis")) limits.axis = unit_axis(vector_at(value, "axis", where), where);
    limits.cone = radians(number_at(value, "cone_degrees", where));
    limits.twist_minimum = radians(number_at(value, "twist_minimum_degrees", where));
    limits.twist_maximum = radians(number_at(value, "twist_maximum_degrees", where));
    if (limits.cone < 0 || limits.twist_minimum > limits.twist_maximum)
      throw Error("the ball joint's ranges are reversed", where,
                  "give a cone of 0 or more, and twist minimum before maximum");
  } else {
    throw Error("unknown kind of limits \"" + type.substr(0, 40) + "\"", where, "use free, fixed, hinge or ball");
  }
  return limits;
}

Json json_of(const glm::dvec3& v) { return {v.x, v.y, v.z}; }

Json json_of(const JointLimits& limits) {
  switch (limits.type) {
    case JointLimits::Type::Fixed: return {{"type", "fixed"}};
    case JointLimits::Type::Hinge:
      return {{"type", "hinge"},
              {"axis", json_of(limits.axis)},
              {"minimum_degrees", degrees_of(limits.minimum)},
              {"maximum_degrees", degrees_of(limits.maximum)}};
    case JointLimits::Type::Ball: {
      Json ball = {{"type", "ball"},
                   {"cone_degrees", degrees_of(limits.cone)},
                   {"twist_minimum_degrees", degrees_of(limits.twist_minimum)},
                   {"twist_maximum_degrees", degrees_of(limits.twist_maximum)}};
      if (limits.axis != glm::dvec3(0)) ball["axis"] = json_of(limits.axis);
      return ball;
    }
    case JointLimits::Type::Free: break;
  }
  return {{"type", "free"}};
}

// ---- Bones and coordinates.

// Returns, for each axis, the factor that converts coordinates of the file to LPS mm.
glm::dvec3 lps_mm_from_file(const Json& rig, const std::string& where) {
  auto word = [&](const char* key, const char* fallback) -> std::string {
    if (!rig.contains(key)) return fallback;
    if (!rig[key].is_string())
      throw Error("\"" + std::string(key) + "\" is not a word", where, std::string("write \"") + fallback + "\"");
    return rig[key];
  };
  const std::string space = word("space", "LPS"), unit = word("unit", "mm");
  const double mm = unit == "mm" ? 1 : unit == "cm" ? 10 : unit == "m" ? 1000 : 0;
  if (mm == 0) throw Error("unknown unit \"" + unit.substr(0, 40) + "\"", where, "use mm, cm or m");
  if (space != "LPS" && space != "RAS")
    throw Error("unknown space \"" + space.substr(0, 40) + "\"", where, "use LPS or RAS");
  return space == "LPS" ? glm::dvec3(mm) : glm::dvec3(-mm, -mm, mm);
}

Bone bone_of(const Json& value, const glm::dvec3& scale, const std::string& where) {
  if (!value.is_object() || !value.contains("name") || !value["name"].is_string())
    throw Error("a bone has no name", where, "write {\"name\", \"parent\", \"head\", \"tail\"}");
  Bone bone;
  bone.name = value["name"];
  const std::string here = where + " (" + bone.name.substr(0, 60) + ")";
  bone.head = vector_at(value, "head", here) * scale;
  bone.tail = vector_at(value, "tail", here) * scale;
  if (value.contains("roll")) bone.roll = number(value["roll"], "roll", here);
  if (value.contains("limits")) {
    bone.limits = limits_of(value["limits"], here);
    if (scale.x < 0) bone.limits.axis *= glm::dvec3(-1, -1, 1);
  }
  return bone;
}

std::string armature_json_text(const Armature& armature) {
  // Writes each bone on its own line, since people read rigs too.
  std::string text = "{\"space\": \"LPS\", \"unit\": \"mm\", \"bones\": [";
  for (size_t i = 0; i < armature.bones.size(); ++i) {
    const Bone& bone = armature.bones[i];
    nlohmann::ordered_json value;
    value["name"] = bone.name;
    value["parent"] = bone.parent < 0 ? Json(nullptr) : Json(armature.bones[bone.parent].name);
    value["head"] = json_of(bone.head);
    value["tail"] = json_of(bone.tail);
    if (bone.roll != 0) value["roll"] = bone.roll;
    if (bone.limits.type != JointLimits::Type::Free) value["limits"] = json_of(bone.limits);
    text += (i ? ",\n  " : "\n  ") + value.dump(-1, ' ', false, Json::error_handler_t::replace);
  }
  return text + "\n]}\n";
}
}  // namespace

Armature parse_armature_json(const std::string& text, const std::string& where) {
  try {
    const Json rig = Json::parse(checked_json(text, where));
    if (!rig.is_object() || !rig.contains("bones") || !rig["bones"].is_array())
      throw Error("there is no list of bones", where, "give {\"space\": \"LPS\", \"unit\": \"mm\", \"bones\": [...]}");
    const glm::dvec3 scale = lps_mm_from_file(rig, where);

    std::vector<Bone> bones;
    std::map<std::string, int> place;
    for (const Json& value : rig["bones"]) {
      bones.push_back(bone_of(value, scale, where + ", bone " + std::to_string(bones.size())));
      if (!place.emplace(bones.back().name, static_cast<int>(bones.size()) - 1).second)
        throw Error("two bones share the name \"" + bones.back().name.substr(0, 60) + "\"", where,
                    "give every bone a name of its own");
    }

    for (size_t i = 0; i < bones.size(); ++i) {
      const Json& value = rig["bones"][i];
      if (!value.contains("parent") || value["parent"].is_null()) continue;
      const std::string here = where + ", bone " + std::to_string(i) + " (" + bones[i].name.substr(0, 60) + ")";
      if (!value["parent"].is_string())
        throw Error("\"parent\" is not a name", here, "name a bone, or null for a root");
      const auto parent = place.find(value["parent"]);
      if (parent == place.end())
        throw Error("the parent is not a bone of the rig", here, "name a bone of this rig, or null for a root");
      bones[i].parent = parent->second;
    }
    Armature armature = parents_first(std::move(bones), where);
    check_armature(armature, where);
    return armature;
  } catch (const Json::exception& error) {
    throw Error("this is not valid JSON (" + std::string(error.what()).substr(0, 160) + ")", where, "correct the file");
  }
}

ArmatureFile read_armature_file(const Path& path) {
  const std::string extension = extension_of(path);
  const std::string text = read_file(path, kMostBytes);
  if (extension == ".json") return {parse_armature_json(text, path.string()), "Limber JSON", {}};
  if (extension == ".vtk") return {parse_bender_vtk(text, path.string()), "Bender VTK", {}};
  if (extension == ".arm") return {parse_bender_arm(text, path.string()), "Bender ARM", {}};
  if (extension == ".bvh") {
    const Motion motion = parse_bvh(text, path.string());
    return {armature_of(motion), "BVH", motion.warnings};
  }
  if (extension == ".gltf" || extension == ".glb") {
    GltfSummary gltf = parse_gltf(text, extension == ".glb", path.string());
    if (gltf.armature.bones.empty())
      throw Error("the model has no skin, so it is not a rig", path.string(), "use a rigged model");
    return {std::move(gltf.armature), "glTF", gltf.warnings};
  }
  throw Error("this is not a rig file that can be read", path.string(), "use .json, .vtk, .arm, .bvh, .gltf or .glb");
}

void check_armature_writable(const Path& path) {
  const std::string extension = extension_of(path);
  if (extension != ".json" && extension != ".vtk" && extension != ".bvh")
    throw Error("rigs cannot be written with this extension", path.string(), "use .json, .vtk or .bvh");
  check_place(path);
}

void write_armature(const Armature& armature, const Path& path) {
  check_armature_writable(path);
  check_armature(armature, path.string());
  const std::string extension = extension_of(path);
  if (extension == ".json") return write_file_atomically(path, armature_json_text(armature));
  if (extension == ".vtk") return write_file_atomically(path, bender_vtk_text(armature));
  write_bvh(motion_of(armature), path);
}

}  // namespace limber
