// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/resample/results.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdio>

#include <nlohmann/json.hpp>

#include "core/base/json_text.h"
#include "core/project/history.h"
#include "core/report/report.h"
#include "core/resample/deformation_method.h"
#include "editor/context/comparison.h"
#include "editor/context/context.h"
#include "editor/context/screen.h"
#include "editor/pose/live_preview.h"
#include "editor/pose/pose_edits.h"
#include "editor/resample/result_list.h"
#include "editor/shown/fem_live_view.h"
#include "editor/shown/test_pose.h"
#include "editor/ui/ui.h"
#include "editor/volume/shown_image.h"

namespace limber::editor {

namespace {

// Returns the text of a warning with the words for users of the editor: options and commands of the command line that
// it names are replaced by the names of the same functions in the editor.
std::string in_words_of_the_editor(std::string warning) {
  for (const auto& [said, here] :
       {std::pair<std::string_view, std::string_view>{"--glide MM allows longer shifts",
                                                      "Keep bones apart allows longer shifts"},
        {"the command limber fit-joint moves the axis of a joint",
         "Fit joint axis in the Rig workspace moves the axis of a joint"},
        {"limber fit-joint, a command of its own, moves the axis of a joint",  // wording of older reports
         "Fit joint axis in the Rig workspace moves the axis of a joint"}})
    if (const auto place = warning.find(said); place != std::string::npos) warning.replace(place, said.size(), here);
  return warning;
}

using Json = nlohmann::json;

std::optional<double> number(const Json& json, const char* key) {
  if (!json.is_object() || !json.contains(key) || !json[key].is_number()) return std::nullopt;
  return json[key].get<double>();
}

std::string in_words(const Json& value) {
  if (value.is_boolean()) return value.get<bool>() ? "yes" : "no";
  if (value.is_string()) return value.get<std::string>();
  if (value.is_number_integer()) return value.dump();
  if (value.is_number()) {
    char text[32];
    std::snprintf(text, sizeof text, "%.4g", value.get<double>());
    return text;
  }
  std::string all;
  for (const Json& one : value) all += (all.empty() ? "" : ", ") + in_words(one);
  return all.empty() ? "none" : all;
}

// Returns a label for a JSON key: "fit_joints" -> "Fit joints".
std::string label_of_key(std::string key) {
  std::replace(key.begin(), key.end(), '_', ' ');
  if (!key.empty()) key[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(key[0])));
  return key;
}

void take_provenance(const Json& json, ResultFacts& facts) {
  if (const auto settings = json.find("settings"); settings != json.end() && settings->is_object())
    for (const auto& [key, value] : settings->items())
      if (key != "method") facts.settings.push_back({label_of_key(key), in_words(value), in_words(value)});
  if (const auto inputs = json.find("inputs"); inputs != json.end() && inputs->is_array())
    for (const Json& input : *inputs) {
      if (!input.is_object()) continue;
      const std::string hash = in_words(input.value("sha256", Json(""))),
                        file = Path(in_words(input.value("path", Json("")))).filename().string();
      facts.inputs.push_back({file, hash.substr(0, 16), hash});
    }
  if (const auto seconds = json.find("seconds"); seconds != json.end() && seconds->is_object())
    for (const auto& [key, value] : seconds->items())
      if (value.is_number()) {
        char text[32];
        std::snprintf(text, sizeof text, "%.2f s", value.get<double>());
        facts.stages.push_back({label_of_key(key), text, ""});
      }
}

std::int64_t count(const Json& json, const char* key) {
  return static_cast<std::int64_t>(number(json, key).value_or(0));
}

// Returns true if two tissue tables have equal labels, kinds and priorities, which resampling reads.
//   stiffness  true: also compares the Young's modulus and Poisson ratio, which only FEM reads
bool same_tissues(const std::shared_ptr<const TissueTable>& a, const std::shared_ptr<const TissueTable>& b,
                  bool stiffness) {
  if (a == b || !a || !b) return true;
  return std::equal(a->tissues.begin(), a->tissues.end(), b->tissues.begin(), b->tissues.end(),
                    [&](const Tissue& x, const Tissue& y) {
                      if (stiffness && (x.young_modulus != y.young_modulus || x.poisson_ratio != y.poisson_ratio))
                        return false;
                      return x.label == y.label && x.kind == y.kind && x.priority == y.priority;
                    });
}

template <class T>
bool same(const std::shared_ptr<const T>& a, const std::shared_ptr<const T>& b) {
  return a == b || (a && b && *a == *b);
}

// Converts a box from voxel coordinates of one grid to those of another grid with the same axes.
std::array<glm::dvec3, 2> in_grid(const std::array<glm::dvec3, 2>& box, const Grid& from, const Grid& to) {
  const AffineTransform world = world_from_voxel(from), voxel = voxel_from_world(to);
  return {voxel * (world * box[0]), voxel * (world * box[1])};
}

}  // namespace

ResultFacts facts_of_report(const std::string& text) {
  ResultFacts facts;
  facts.gates = all_gates(text);
  const Json json = Json::parse(sound_json(text), nullptr, false);
  if (!json.is_object()) return facts;
  facts.seconds = method_seconds(text);
  if (json.contains("total")) {
    const Json& total = json["total"];
    facts.change_percent = number(total, "volume_change_percent");
    facts.overlap_voxels = count(total, "overlap_voxels");
    facts.hole_voxels = count(total, "new_hole_voxels");
    facts.dropped_voxels = count(total, "dropped_voxels");
    facts.trapped_air_voxels = count(total, "trapped_air_voxels");
  }
  if (json.contains("tissues") && json["tissues"].is_array())
    for (const Json& row : json["tissues"]) {
      if (!row.is_object()) continue;
      const std::string name =
          row.contains("name") && row["name"].is_string() ? row["name"].get<std::string>() : "Unknown";
      facts.tissues.push_back({name, number(row, "mm3_before").value_or(0), number(row, "mm3_after").value_or(0),
                               number(row, "volume_change_percent"), count(row, "overlap_voxels")});
    }
  if (json.contains("warnings") && json["warnings"].is_array())
    for (const Json& warning : json["warnings"])
      if (warning.is_string()) facts.warnings.push_back(in_words_of_the_editor(warning));
  if (json.contains("mesh") && number(json["mesh"], "inverted")) facts.inverted = count(json["mesh"], "inverted");
  facts.version = json.value("version", Json()).is_string() ? json["version"].get<std::string>() : "";
  facts.peak_memory_mb = number(json, "peak_memory_mb");
  take_provenance(json, facts);
  return facts;
}

std::shared_ptr<const ResultFacts> facts_of(Context& context, const std::shared_ptr<const Result>& result) {
  auto& known = context.results->known;
  std::erase_if(known, [](const KnownResult& one) { return one.result.expired(); });
  const auto found =
      std::find_if(known.begin(), known.end(), [&](const KnownResult& one) { return one.result.lock() == result; });
  if (found != known.end()) return found->facts;
  ResultFacts facts = facts_of_report(result->report);
  // A report may have no joint angles, so judge joint limits from the armature and pose that the result was made from.
  if (result->from_armature && result->from_pose)
    for (QualityGate& gate : facts.gates)
      if (gate.id == "limits") gate = judge_joint_limits(*result->from_armature, *result->from_pose);
  known.push_back({result, std::make_shared<const ResultFacts>(std::move(facts))});
  return known.back().facts;
}

std::string text_of_report(const std::string& name, const ResultFacts& facts) {
  std::string text = name + "\n\n";
  char line[256];
  const auto add = [&](const char* format, const auto&... values) {
    std::snprintf(line, sizeof line, format, values...);
    text += std::string(line) + "\n";
  };
  for (const QualityGate& gate : facts.gates)
    add("%-8s %-26s %18s  %s",
        gate.state == GateState::Passed   ? "passed"
        : gate.state == GateState::Failed ? "FAILED"
                                          : "-",
        gate.name.c_str(), gate.state == GateState::NotMeasured ? "not checked" : gate.figure.c_str(),
        gate.worst.c_str());
  text += "\n";
  add("%-32s %12s %12s %10s %12s", "tissue", "cm3 at rest", "cm3 posed", "change %", "overlap");
  for (const ResultTissue& tissue : facts.tissues) {
    char change[24] = "-";
    if (tissue.change_percent) std::snprintf(change, sizeof change, "%+.2f", *tissue.change_percent);
    add("%-32.32s %12.2f %12.2f %10s %12lld", tissue.name.c_str(), tissue.mm3_before / 1000, tissue.mm3_after / 1000,
        change, static_cast<long long>(tissue.overlap_voxels));
  }
  if (facts.change_percent)
    add("%-32s %12s %12s %+10.2f %12lld", "all tissue", "", "", *facts.change_percent,
        static_cast<long long>(facts.overlap_voxels));
  text += "\n";
  for (const std::string& warning : facts.warnings) text += "warning: " + warning + "\n";
  if (!facts.version.empty()) add("%-20s %s", "Limber", facts.version.c_str());
  for (const auto& one : facts.settings)
    text += one.name + std::string(one.name.size() < 20 ? 20 - one.name.size() : 1, ' ') + " " + one.value + "\n";
  for (const auto& one : facts.inputs)
    text += one.name + std::string(one.name.size() < 20 ? 20 - one.name.size() : 1, ' ') + " " + one.whole + "\n";
  for (const auto& one : facts.stages) add("%-20s %s", one.name.c_str(), one.value.c_str());
  if (facts.peak_memory_mb) add("%-20s %.0f MB", "Memory", *facts.peak_memory_mb);
  return text;
}

std::string method_name(const std::string& method) {
  if (method == "fem-contact") return "FEM with contact";
  const DeformationMethod* known = find_method(method);
  return known ? known->label : method;
}

std::string stale_reason(const Document& document, const Result& result) {
  if (result.from_volume != document.volume) return "volume changed";
  if (!same_tissues(result.from_tissues, document.tissues, result.method.starts_with("fem"))) return "tissues changed";
  if (!same(result.from_armature, document.armature)) return "rig changed";
  if (!same(result.from_weights, document.weights)) return "weights changed";
  if (!same(result.from_seams, document.seams)) return "seams changed";
  if (!same(result.from_bone_map, document.bone_map)) return "bone map changed";
  return "";
}

bool is_of_this_pose(const Document& document, const Result& result) {
  if (!document.armature || !result.from_pose) return false;
  return *result.from_pose == (document.pose ? *document.pose : rest_pose(*document.armature));
}

std::string name_of_pose(const Armature& armature, const Pose& pose) {
  int turned = 0;
  std::string first;
  for (std::size_t b = 0; b < armature.bones.size() && b < pose.rotation.size(); ++b) {
    const double angle = 2 * std::acos(std::min(1.0, std::abs(pose.rotation[b].w)));
    if (angle < 1e-4) continue;
    if (++turned == 1)
      first =
          armature.bones[b].name + " " + std::to_string(static_cast<int>(std::lround(glm::degrees(angle)))) + "\u00b0";
  }
  return turned == 0 ? "Rest" : turned == 1 ? first : first + " and " + std::to_string(turned - 1) + " more";
}

std::string unique_name(const std::vector<std::shared_ptr<const Result>>& results, const std::string& name) {
  const auto taken = [&](const std::string& candidate) {
    return std::any_of(results.begin(), results.end(), [&](const auto& result) { return result->name == candidate; });
  };
  if (!taken(name)) return name;
  for (int i = 2;; ++i)
    if (const std::string candidate = name + " (" + std::to_string(i) + ")"; !taken(candidate)) return candidate;
}

void show_rest(Comparison& comparison) {
  comparison.shows_a = comparison.a.empty();
  if (!comparison.shows_a) comparison.b.clear();
}

void show_result(Context& context, const std::string& name) {
  stop_watching(context.fem);
  if (name.empty()) show_rest(context.comparison);
  else context.comparison->b = name, context.comparison->shows_a = false;
  // Other workspaces may show the body itself or another pose. Switches to the Resample workspace, so that the result
  // is visible.
  if (result_named(context.document(), name) && !shown_result(context)) context.screen->workspace = Workspace::Resample;
}

void show_result_of_pose(Context& context) {
  const Document& document = context.document();
  const Comparison& comparison = context.comparison;
  if (comparison.views != Comparison::Views::One || comparison.shows_a) return;
  const auto shown = result_named(document, comparison.b);
  if (shown && is_of_this_pose(document, *shown)) return;
  const auto fresh = std::find_if(document.results.rbegin(), document.results.rend(), [&](const auto& result) {
    return is_of_this_pose(document, *result) && stale_reason(document, *result).empty();
  });
  if (fresh != document.results.rend()) context.comparison->b = (*fresh)->name;
}

void rename_result(Context& context, const std::shared_ptr<const Result>& result, const std::string& name) {
  Document next = context.document();
  const auto place = std::find(next.results.begin(), next.results.end(), result);
  if (place == next.results.end() || name.empty() || name == result->name) return;
  auto renamed = std::make_shared<Result>(*result);
  renamed->name = unique_name(next.results, name);
  *place = renamed;
  for (std::string* side : {&context.comparison->a, &context.comparison->b})
    if (*side == result->name) *side = renamed->name;
  context.history->commit("Rename " + result->name, std::move(next));
  context.ui->touch();
}

void move_clip_box(render::Clip& clip, const Grid& from, const Grid& to) {
  if (!clip.box) return;
  if (from.direction == to.direction) clip.box = in_grid(*clip.box, from, to);
  else clip.box.reset();
}

namespace {

// Puts a result into the scene. If `result` is null, the scene shows the document's volume, deformed by the current
// pose or by the watched FEM solve, if any.
void put_into(render::Scene& scene, const Context& context, const std::shared_ptr<const Result>& result) {
  const Document& document = context.document();
  scene.posed_from_rest.clear();
  scene.pose = nullptr;
  if (result && document.volume) {
    scene.volume = result->volume;
    const PosedImage* image = posed_image_of(*context.views, result->volume);
    if (scene.grey && image) scene.grey->image = image->levels;
    else scene.grey.reset();
    move_clip_box(scene.clip, document.volume->grid, result->volume->grid);
    if (document.armature && result->from_pose && result->from_pose->rotation.size() == document.armature->bones.size())
      scene.posed_from_rest = posed_from_rest(*document.armature, *result->from_pose);
  } else if (watched_solve(context) || shows_pose(context)) {
    scene.pose = context.live->map();
    scene.posed_from_rest = context.live->rig_motions();
  }
}

}  // namespace

void show_posed(Context& context) {
  Views& views = *context.views;
  if (comparing(context)) {
    views.other_scene = views.scene;
    put_into(*views.other_scene, context, result_named(context.document(), context.comparison->a));
  } else {
    views.other_scene.reset();
  }
  put_into(views.scene, context, shown_result(context));
}

}  // namespace limber::editor
