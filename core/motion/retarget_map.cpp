// SPDX-License-Identifier: AGPL-3.0-or-later
#include <cmath>
#include <set>

#include <nlohmann/json.hpp>

#include "core/base/error.h"
#include "core/base/json_text.h"
#include "core/motion/retarget.h"

namespace limber {

namespace {
using Json = nlohmann::json;
constexpr std::uint64_t kMostBytes = 64 << 20;

glm::dquat rest_offset_of(const Json& value, const std::string& where) {
  glm::dquat q(0, 0, 0, 0);
  const bool numbers = value.is_array() && value.size() == 4 && value[0].is_number() && value[1].is_number() &&
                       value[2].is_number() && value[3].is_number();
  if (numbers)
    q = glm::dquat(value[0].get<double>(), value[1].get<double>(), value[2].get<double>(), value[3].get<double>());
  const double length = glm::length(q);
  if (!(length > 1e-9) || !std::isfinite(length))
    throw Error("\"rest_offset_wxyz\" is not a rotation", where, "give four numbers, not all zero");
  return std::abs(length - 1) < 1e-15 ? q : q / length;
}

// JSON key under which a retarget map stores the rest stances. If a joint has this name, the key means the joint.
constexpr const char* kRests = "@rests";

RestStances stances_of(const Json& value, const std::string& where) {
  RestStances stances;
  if (!value.is_object())
    throw Error("\"@rests\" is not an object", where, R"(write {"motion": "T", "rig": "anatomical"})");
  for (const auto& [whose, word] : value.items()) {
    if ((whose != "motion" && whose != "rig") || !word.is_string())
      throw Error("\"" + whose.substr(0, 60) + "\" does not name a rest pose", where + ", @rests",
                  R"(write {"motion": "T", "rig": "anatomical"})");
    (whose == "rig" ? stances.rig : stances.source) = stance_of_word(word.get<std::string>(), where + ", @rests");
  }
  return stances;
}
}  // namespace

RetargetMap parse_retarget_map(const std::string& text, const std::string& where, const Motion& motion,
                               const Armature& armature) {
  try {
    const Json json = Json::parse(checked_json(text, where));
    if (!json.is_object())
      throw Error("this is not a retarget map", where, "write {\"source joint\": \"rig bone\", ...}");
    std::set<std::string> joints;
    for (const BvhJoint& joint : motion.joints) joints.insert(joint.name);

    RetargetMap map;
    auto add = [&](const std::string& joint, const Json& bone, std::optional<glm::dquat> offset) {
      const std::string here = where + ", joint " + joint.substr(0, 60);
      if (!bone.is_string())
        throw Error("a bone is not given by its name", here,
                    "write \"rig bone\", a list of them, {\"bone\": name} or null");
      if (!armature.find(bone.get<std::string>()))
        throw Error("the rig has no bone \"" + bone.get<std::string>().substr(0, 60) + "\"", here,
                    "use the rig's names (limber info RIG lists them)");
      if (!map.sources.emplace(bone.get<std::string>(), RetargetMap::Source{joint, offset}).second)
        throw Error("bone \"" + bone.get<std::string>().substr(0, 60) + "\" is moved by two joints", here,
                    "keep one of the two joints");
    };
    for (const auto& [joint, value] : json.items()) {
      const std::string here = where + ", joint " + joint.substr(0, 60);
      if (joint == kRests && !joints.contains(joint)) {
        map.stances = stances_of(value, where);
        continue;
      }
      if (value.is_null()) continue;
      if (!joints.contains(joint))
        throw Error("the motion has no such joint", here, "use the motion's names (limber info BVH lists them)");
      if (value.is_array()) {
        for (const Json& bone : value) add(joint, bone, {});
      } else if (value.is_object()) {
        std::optional<glm::dquat> offset;
        if (value.contains("rest_offset_wxyz")) offset = rest_offset_of(value["rest_offset_wxyz"], here);
        add(joint, value.contains("bone") ? value["bone"] : Json(), offset);
      } else {
        add(joint, value, {});
      }
    }
    if (map.sources.empty())
      throw Error("the retarget map matches no bone", where, "name at least one joint and its bone");
    return map;
  } catch (const Json::exception& error) {
    throw Error("this is not valid JSON (" + std::string(error.what()).substr(0, 160) + ")", where, "correct the file");
  }
}

RetargetMap known_part(const RetargetMap& map, const Motion& motion, const Armature& armature) {
  std::set<std::string> joints, bones;
  for (const BvhJoint& joint : motion.joints) joints.insert(joint.name);
  for (const Bone& bone : armature.bones) bones.insert(bone.name);
  RetargetMap known = map;
  std::erase_if(known.sources, [&](const auto& entry) {
    return !bones.contains(entry.first) || !joints.contains(entry.second.joint);
  });
  return known;
}

RetargetMap read_retarget_map(const Path& path, const Motion& motion, const Armature& armature) {
  return parse_retarget_map(read_file(path, kMostBytes), path.string(), motion, armature);
}

void write_retarget_map(const RetargetMap& map, const Path& path) {
  // If a joint moves several bones, only their names are written. Their rest offsets are computed again on reading.
  nlohmann::ordered_json json = nlohmann::ordered_json::object();
  for (const auto& [bone, source] : map.sources) {
    nlohmann::ordered_json value = bone;
    if (source.rest_offset) {
      const glm::dquat& q = *source.rest_offset;
      value = {{"bone", bone}, {"rest_offset_wxyz", {q.w, q.x, q.y, q.z}}};
    }
    if (!json.contains(source.joint)) {
      json[source.joint] = value;
    } else {
      auto& several = json[source.joint];
      if (several.is_object()) several = several["bone"];
      if (several.is_string()) several = nlohmann::ordered_json::array({several});
      several.push_back(bone);
    }
  }
  if (map.stances != RestStances{} && !json.contains(kRests))
    json[kRests] = {{"motion", word_of(map.stances.source)}, {"rig", word_of(map.stances.rig)}};
  write_file_atomically(path, json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n");
}

}  // namespace limber
