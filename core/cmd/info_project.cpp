// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/cmd/info_project.h"

#include <algorithm>

#include <nlohmann/json.hpp>

#include "core/cmd/command.h"
#include "core/motion/constraint.h"
#include "core/motion/strips.h"
#include "core/project/journal.h"
#include "core/project/project_io.h"
#include "core/skin/weight_layers.h"

namespace limber::cmd {

namespace {
using Json = nlohmann::ordered_json;

Json json_of(const glm::dvec3& v) { return {v.x, v.y, v.z}; }

Json json_of(const LabelVolume& volume) {
  const glm::ivec3 size = volume.grid.size;
  return {{"size", {size.x, size.y, size.z}},
          {"spacing", json_of(volume.grid.spacing)},
          {"tissue_voxels", volume.voxels.size() - static_cast<std::size_t>(std::count(
                                                       volume.voxels.begin(), volume.voxels.end(), Label{0}))}};
}

Json json_of(const TissueTable& table) {
  Json tissues = Json::array();
  for (const Tissue& tissue : table.tissues)
    tissues.push_back({{"value", tissue.file_value}, {"name", tissue.name}, {"kind", to_string(tissue.kind)}});
  return tissues;
}

Json names_of(const Armature& armature) {
  Json names = Json::array();
  for (const Bone& bone : armature.bones) names.push_back(bone.name);
  return names;
}

Json turned_bones(const Document& document) {
  Json names = Json::array();
  for (std::size_t bone = 0; bone < document.pose->rotation.size(); ++bone)
    if (document.pose->rotation[bone] != glm::dquat(1, 0, 0, 0)) names.push_back(document.armature->bones[bone].name);
  return names;
}

bool is_stale(const Result& result, const Document& document) {
  return result.from_volume != document.volume || result.from_tissues != document.tissues ||
         result.from_armature != document.armature || result.from_weights != document.weights ||
         result.from_pose != document.pose || result.from_seams != document.seams ||
         result.from_bone_map != document.bone_map;
}

Json results_of(const Document& document) {
  Json results = Json::array();
  for (const auto& result : document.results)
    results.push_back({{"name", result->name},
                       {"method", result->method},
                       {"state", is_stale(*result, document) ? "stale" : "current"}});
  return results;
}
}  // namespace

std::string describe_project(const Path& file) {
  const Project project = read_project(file);
  warn(project.warnings);
  const ProjectSummary summary = summarize_project(file);
  const Document& document = project.document;
  Json json = {{"kind", "project"},
               {"program", summary.program},
               {"file_bytes", summary.file_bytes},
               {"chunks", summary.chunks}};
  if (document.volume) json["volume"] = json_of(*document.volume);
  if (document.volume_type) json["volume_type"] = document.volume_type->format + " " + document.volume_type->voxel_type;
  if (document.tissues) json["tissues"] = json_of(*document.tissues);
  if (document.armature) json["bones"] = names_of(*document.armature);
  if (document.weights)
    json["weights"] = {{"voxels", document.weights->size()}, {"bones", document.weights->bones().size()}};
  if (document.layers)
    for (const auto& layer : document.layers->layers)
      json["weights"]["layers"].push_back(
          {{"name", layer->name}, {"opacity", layer->opacity}, {"visible", layer->visible}});
  if (document.seams) json["seams"] = {{"faces", document.seams->size()}};
  if (document.bone_map) json["bone_map"] = *document.bone_map;
  if (document.pose) json["posed_bones"] = turned_bones(document);
  for (const auto& clip : document.clips) {
    Json one = {{"name", clip->name}, {"keys", frames_of(clip->keys).size()}};
    if (clip->motion) one.update({{"joints", clip->motion->joints.size()}, {"frames", clip->motion->frame_count}});
    if (clip->constraints)
      for (const Constraint& constraint : clip->constraints->list) one["constraints"].push_back(constraint.name);
    if (clip->strips)
      for (const StripTrack& track : clip->strips->tracks)
        for (const Strip& strip : track.strips)
          one["strips"].push_back({{"name", strip.name}, {"track", track.name}, {"clip", strip.clip->name}});
    json["clips"].push_back(one);
  }
  if (!document.results.empty()) json["results"] = results_of(document);
  if (const auto left = recoverable(journal_path(std::filesystem::absolute(file)))) json["unsaved_edits"] = left->edits;
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace limber::cmd
