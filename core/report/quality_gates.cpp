// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/report/quality_gates.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>
#include <set>

#include <nlohmann/json.hpp>

#include "core/pose/pose.h"
#include "core/report/report.h"
#include "core/report/solve_gates.h"
#include "core/rig/joint_limits.h"

namespace limber {

namespace {

using Json = nlohmann::json;

constexpr double kTear = 0.5;  // of a voxel's edge: less does not show in voxels

std::optional<double> number(const Json& json, const char* key) {
  const auto found = json.is_object() ? json.find(key) : json.end();
  return found != json.end() && found->is_number() ? std::optional(found->get<double>()) : std::nullopt;
}

std::string text(const Json& json, const char* key) {
  const auto found = json.find(key);
  return found != json.end() && found->is_string() ? found->get<std::string>() : "";
}

const Json& part(const Json& json, const char* key) {
  static const Json kNothing;
  const auto found = json.is_object() ? json.find(key) : json.end();
  return found == json.end() ? kNothing : *found;
}

std::string formatted(const char* format, double value) {
  char buffer[48];
  std::snprintf(buffer, sizeof buffer, format, value);
  return buffer;
}

// "3 286 voxels", "1 pair"
std::string counted(double count, const char* what) {
  std::string digits = formatted("%.0f", count);
  for (auto place = static_cast<std::ptrdiff_t>(digits.size()) - 3; place > 0; place -= 3) digits.insert(static_cast<std::size_t>(place), " ");
  return digits + " " + what + (count == 1 ? "" : "s");
}

std::string in_quotes(const std::string& name) { return "\"" + name.substr(0, 80) + "\""; }

// " at (12, -40, 812) mm near LeftThigh", of where something is worst
std::string at_place(const Json& worst) {
  const Json& place = part(worst, "place");
  if (!place.is_array() || place.size() != 3) return "";
  std::string words = " at (";
  for (const Json& one : place) words += (one == place[0] && words.back() == '(' ? "" : ", ") + (one.is_number() ? formatted("%.0f", one.get<double>()) : "?");
  const std::string near = text(worst, "near");
  return words + ") mm" + (near.empty() ? "" : " near " + near);
}

void decide(QualityGate& gate, bool passed, std::string figure, std::string sentence = "") {
  gate.state = passed ? GateState::Passed : GateState::Failed;
  gate.figure = std::move(figure);
  gate.sentence = std::move(sentence);
}

void not_checked(QualityGate& gate, const std::string& why) { gate.sentence = "Not checked: " + why; }

using Judge = void (*)(const Json& report, const QualityLimits& limits, QualityGate& gate);
using LimitText = std::string (*)(const QualityLimits& limits);

// One gate; "{}" in a name or a meaning stands for the limit.
struct GateRule {
  const char* id;
  const char* name;
  const char* meaning;
  LimitText limit;
  bool strict;
  Judge judge;
};

std::string with_limit(std::string words, const std::string& limit) {
  if (const auto place = words.find("{}"); place != std::string::npos) words.replace(place, 2, limit);
  return words;
}

template <std::size_t N>
std::vector<QualityGate> judged(const GateRule (&rules)[N], const std::string& report, const QualityLimits& limits) {
  const Json json = Json::parse(report, nullptr, false);
  std::vector<QualityGate> gates;
  for (const GateRule& rule : rules) {
    QualityGate& gate = gates.emplace_back();
    gate.id = rule.id;
    gate.limit = rule.limit(limits);
    gate.name = with_limit(rule.name, gate.limit);
    gate.meaning = with_limit(rule.meaning, gate.limit);
    gate.strict = rule.strict;
    rule.judge(json, limits, gate);
    if (gate.sentence.empty() && gate.state == GateState::NotMeasured) not_checked(gate, "the report has no figures for it.");
    if (gate.sentence.empty()) gate.sentence = gate.name + ": " + gate.figure + (gate.worst.empty() ? "" : ", " + gate.worst) + ".";
  }
  return gates;
}

void judge_tissues(const Json& report, const QualityLimits& limits, QualityGate& gate) {
  const std::string least = counted(double(limits.least_voxels), "voxel");
  gate.meaning += " " + least + " or more.";
  bool any_large = false;
  double worst = 0;
  for (const Json& tissue : part(report, "tissues")) {
    const auto change = number(tissue, "volume_change_percent"), voxels = number(tissue, "voxels_before");
    if (!change || !voxels) continue;
    const bool large = *voxels >= double(limits.least_voxels);
    if (any_large && !large) continue;
    if ((large && !any_large) || gate.worst.empty() || std::abs(*change) > std::abs(worst)) {
      worst = *change;
      gate.worst = text(tissue, "name");
      if (gate.worst.empty()) gate.worst = "label " + formatted("%.0f", number(tissue, "label").value_or(0));
    }
    any_large = any_large || large;
  }
  if (!gate.worst.empty()) decide(gate, std::abs(worst) <= limits.tissue_percent, formatted("%+.2f %%", worst));
  if (!gate.worst.empty() && !any_large) gate.meaning = "The volume of the tissue that changed most; none has " + least + ".";
}

void judge_bones(const Json& report, const QualityLimits& limits, QualityGate& gate) {
  double worst = -1;
  for (const Json& bone : part(report, "bones"))
    if (const auto residual = number(bone, "rigid_residual_mm"); residual && *residual > worst) {
      worst = *residual;
      gate.worst = text(bone, "name");
    }
  if (worst >= 0) decide(gate, worst <= limits.bone_residual_mm, formatted("%.3f mm", worst));
}

void judge_skin(const Json& report, const QualityLimits& limits, QualityGate& gate) {
  const Json& skin = part(report, "skin");
  const auto before = number(skin, "surface_share_before"), after = number(skin, "surface_share_after");
  if (!before || !after) return;
  decide(gate, *after >= *before - limits.skin_share_percent / 100, formatted("%.1f %%", 100 * *after));
  gate.meaning += formatted(" At rest it is %.1f %%.", 100 * *before);
}

void judge_islands(const Json& report, const QualityLimits&, QualityGate& gate) {
  double islands = 0, most = 0;
  bool measured = false;
  for (const Json& tissue : part(report, "tissues")) {
    const auto before = number(tissue, "components_before"), after = number(tissue, "components_after");
    if (!before || !after) continue;
    measured = true;
    const double more = std::max(0.0, *after - *before);
    islands += more;
    if (more > most) most = more, gate.worst = text(tissue, "name");
  }
  const Json& total = part(report, "total");
  const auto holes = number(total, "new_hole_voxels"), dropped = number(total, "dropped_voxels");
  if (!measured && !holes) return;
  std::string figure = islands > 0 ? counted(islands, "island") : "";
  if (holes.value_or(0) > 0) figure += (figure.empty() ? "" : ", ") + counted(*holes, "hole");
  if (dropped.value_or(0) > 0) figure += (figure.empty() ? "" : ", ") + counted(*dropped, "voxel") + " lost";
  decide(gate, figure.empty(), figure.empty() ? "0" : figure);
}

void judge_inverted(const Json& report, const QualityLimits&, QualityGate& gate) {
  if (const auto inverted = number(part(report, "mesh"), "inverted")) decide(gate, *inverted == 0, formatted("%.0f", *inverted));
}

void judge_crossings(const Json& report, const QualityLimits&, QualityGate& gate) {
  const auto pairs = number(part(report, "mesh"), "self_intersections"), overlap = number(part(report, "total"), "overlap_voxels");
  if (!pairs && !overlap) return;
  const bool crossing = pairs.value_or(0) > 0, twice = overlap.value_or(0) > 0;
  decide(gate, !crossing && !twice, twice ? counted(*overlap, "voxel") : crossing ? counted(*pairs, "pair") : "0");
}

QualityGate gate_of_limits() {
  QualityGate gate;
  gate.id = "limits", gate.name = "Joint limits", gate.meaning = "How far the joint that is turned too far is beyond its limits.";
  return gate;
}

// Of the joint that is furthest beyond.
void decide_limits(QualityGate& gate, double excess_degrees, const std::string& bone, const QualityLimits& limits) {
  const bool within = excess_degrees <= limits.joint_excess_degrees;
  gate.worst = within ? "" : bone;
  decide(gate, within, within ? "within" : formatted("%+.1f\u00b0", excess_degrees),
         within ? "Every joint is within its limits." : bone + " is turned " + formatted("%.1f", excess_degrees) + " degrees beyond its limits.");
}

void judge_limits(const Json& report, const QualityLimits& limits, QualityGate& gate) {
  const Json& joints = part(report, "joints");
  double worst = 0;
  std::string bone;
  for (const Json& joint : joints)
    if (const auto excess = number(joint, "excess_degrees"); excess && *excess > worst) {
      worst = *excess;
      bone = text(joint, "bone");
    }
  if (joints.is_array()) decide_limits(gate, worst, bone, limits);
}

// Of the rows of a list, the one with the largest figure; nullptr where none has one.
template <class Figure>
const Json* worst_row(const Json& rows, const Figure& figure) {
  const Json* worst = nullptr;
  double most = 0;
  if (rows.is_array())
    for (const Json& row : rows)
      if (const std::optional<double> value = figure(row); value && (!worst || *value > most)) most = *value, worst = &row;
  return worst;
}

void judge_inputs(const Json& report, const QualityLimits&, QualityGate& gate) {
  const Json& doubts = part(report, "doubts");
  if (!doubts.is_array()) return not_checked(gate, "volume, labels and rig were not held against each other.");
  const std::string first = doubts.empty() || !doubts[0].is_string() ? "" : doubts[0].get<std::string>();
  decide(gate, doubts.empty(), counted(double(doubts.size()), "doubt"), doubts.empty() ? "Volume, labels and rig belong together." : "The inputs do not belong together: " + first + ".");
}

// The edge of a rest voxel, mm, as its volume says; 0 where no tissue was measured.
double voxel_edge(const Json& report) {
  for (const Json& tissue : part(report, "tissues"))
    if (const auto mm3 = number(tissue, "mm3_before"), voxels = number(tissue, "voxels_before"); mm3 && voxels && *voxels > 0) return std::cbrt(*mm3 / *voxels);
  return 0;
}

void judge_whole(const Json& report, const QualityLimits& limits, QualityGate& gate) {
  const Json& bones = part(report, "whole_bones");
  const Json* worst = worst_row(bones, [](const Json& bone) { return number(bone, "residual_mm"); });
  if (!worst) return not_checked(gate, "no posed voxel of a label that names a bone of the rig was looked at.");
  const double residual = *number(*worst, "residual_mm");
  gate.worst = text(*worst, "name");
  const bool passed = residual <= std::max(limits.bone_residual_mm, kTear * voxel_edge(report));
  decide(gate, passed, formatted("%.3f mm", residual),
         passed ? "Each of " + counted(double(bones.size()), "named bone") + " moved as one, within " + formatted("%.3f mm.", residual)
                : in_quotes(gate.worst) + " is torn or bent: its voxels lie up to " + formatted("%.1f mm", residual) + " from the bone's best rigid motion.");
}

std::optional<double> wrong_percent(const Json& bone) {
  const auto wrong = number(bone, "wrong_voxels"), all = number(bone, "voxels");
  return wrong && all && *all > 0 ? std::optional(100 * *wrong / *all) : std::nullopt;
}

void judge_follows(const Json& report, const QualityLimits& limits, QualityGate& gate) {
  const Json& bones = part(report, "whole_bones");
  const Json* worst = worst_row(bones, wrong_percent);
  if (!worst) return not_checked(gate, "no posed voxel of a label that names a bone of the rig was looked at.");
  const bool passed = *wrong_percent(*worst) <= limits.wrong_bone_percent;
  gate.worst = text(*worst, "name");
  decide(gate, passed, formatted("%.2f %%", *wrong_percent(*worst)),
         passed ? "Each of " + counted(double(bones.size()), "named bone") + " went with a rig bone that its name allows."
                : counted(number(*worst, "wrong_voxels").value_or(0), "voxel") + " of " + counted(number(*worst, "voxels").value_or(0), "voxel") + " of " + in_quotes(gate.worst) +
                      " went with " + text(*worst, "went_with") + ", but belong to " + text(*worst, "belongs_to") + ".");
}

void judge_directions(const Json& report, const QualityLimits& limits, QualityGate& gate) {
  const Json& limbs = part(report, "limbs");
  const Json* worst = worst_row(limbs, [](const Json& limb) { return number(limb, "direction_off_degrees"); });
  if (!worst) return not_checked(gate, "the pose turns no rig bone in which bone tissue was found.");
  const double off = *number(*worst, "direction_off_degrees");
  gate.worst = text(*worst, "bone");
  const bool passed = off <= limits.direction_degrees;
  decide(gate, passed, formatted("%.2f\u00b0", off),
         passed ? "Each of " + counted(double(limbs.size()), "turned limb") + " points where the pose asked, within " + formatted("%.2f degrees.", off)
                : gate.worst + " points " + formatted("%.1f degrees", off) + " away from where the pose asked.");
}

void judge_exposed(const Json& report, const QualityLimits& limits, QualityGate& gate) {
  const Json& exposure = part(report, "exposure");
  const auto percent = number(exposure, "percent"), voxels = number(exposure, "voxels");
  if (!percent || !voxels) return not_checked(gate, "where the posed tissue lay at rest is not known.");
  const bool passed = *percent <= limits.exposed_percent;
  const Json& labels = part(exposure, "by_label");
  const Json* most = worst_row(labels, [](const Json& row) { return number(row, "voxels"); });
  if (most) gate.worst = text(*most, "name");
  const std::string exposed = counted(*voxels, "voxel") + " that lay deep inside " + (*voxels == 1 ? "is" : "are") + " at the air now, " + formatted("%.2f %% of the surface", *percent);
  decide(gate, passed, formatted("%.2f %%", *percent),
         *voxels == 0 ? "Nothing that lay deep inside is at the air." : exposed + ", most of it " + in_quotes(gate.worst) + "; worst" + at_place(part(exposure, "worst")) + ".");
}

void judge_trapped(const Json& report, const QualityLimits& limits, QualityGate& gate) {
  const auto trapped = number(part(report, "total"), "trapped_air_voxels");
  if (!trapped) return not_checked(gate, "the volumes before and after were not compared.");
  const Json& pocket = part(report, "air_pocket");
  const bool passed = *trapped <= limits.trapped_voxels;
  decide(gate, passed, counted(*trapped, "voxel"),
         passed ? "No more air is closed in than at rest, but for " + counted(*trapped, "voxel") + "."
                : counted(*trapped, "voxel") + " of air are closed in that were not at rest" +
                      (pocket.is_object() ? "; the largest new pocket, " + counted(number(pocket, "voxels").value_or(0), "voxel") + ", lies" + at_place(pocket) : "") + ".");
}

// Of a tissue that counts: a row of the report with a change of volume, large enough at rest.
std::optional<double> change_of(const Json& tissue, const QualityLimits& limits) {
  const auto change = number(tissue, "volume_change_percent"), voxels = number(tissue, "voxels_before");
  return change && voxels && *voxels >= double(limits.least_organ_voxels) ? change : std::nullopt;
}

void judge_organs(const Json& report, const QualityLimits& limits, QualityGate& gate) {
  const Json& tissues = part(report, "tissues");
  const auto of_organ = [&](const Json& tissue) -> std::optional<double> {
    const std::string kind = tissue.is_object() ? text(tissue, "kind") : "";
    const auto change = kind == "organ" || kind == "brain" ? change_of(tissue, limits) : std::nullopt;
    return change ? std::optional(std::abs(*change)) : std::nullopt;
  };
  const Json* worst = worst_row(tissues, of_organ);
  if (!worst) return not_checked(gate, "no label of " + counted(double(limits.least_organ_voxels), "voxel") + " or more is known for an organ.");
  const double change = *number(*worst, "volume_change_percent");
  gate.worst = text(*worst, "name");
  const bool passed = std::abs(change) <= limits.organ_percent;
  decide(gate, passed, formatted("%+.1f %%", change),
         passed ? "No organ's volume changed by more than " + formatted("%.1f %%", std::abs(change)) + ", that of " + in_quotes(gate.worst) + "."
                : "The volume of " + in_quotes(gate.worst) + " changed by " + formatted("%+.1f %%.", change));
}

void judge_lost(const Json& report, const QualityLimits& limits, QualityGate& gate) {
  const Json* worst = worst_row(part(report, "tissues"), [&](const Json& tissue) -> std::optional<double> {
    const auto change = change_of(tissue, limits);
    return change ? std::optional(-*change) : std::nullopt;
  });
  if (!worst) return not_checked(gate, "no label of " + counted(double(limits.least_organ_voxels), "voxel") + " or more was compared.");
  const double left = 100 + *number(*worst, "volume_change_percent");
  const bool passed = left >= limits.lost_percent;
  gate.worst = text(*worst, "name");
  decide(gate, passed, formatted("%.0f %%", left),
         passed ? "No label is lost; of " + in_quotes(gate.worst) + " least is left, " + formatted("%.0f %%.", left)
                : in_quotes(gate.worst) + " is lost: " + (left <= 0 ? std::string("nothing") : formatted("%.1f %%", left)) + " of its volume is left.");
}

void judge_torn(const Json& report, const QualityLimits&, QualityGate& gate) {
  // Named bones are judged by where each voxel went; thin ones may miss the middles of thick slices at another angle.
  std::set<double> named;
  for (const Json& bone : part(report, "whole_bones"))
    if (const auto label = number(bone, "label")) named.insert(*label);
  const Json* worst = worst_row(part(report, "tissues"), [&](const Json& tissue) {
    const auto label = number(tissue, "label");
    return label && named.contains(*label) ? std::nullopt : number(tissue, "torn_parts");
  });
  if (!worst) return not_checked(gate, "the pieces of labels were not counted before and after, on voxels of one size.");
  const double parts = *number(*worst, "torn_parts");
  if (parts > 0) gate.worst = text(*worst, "name");
  decide(gate, parts == 0, counted(parts, "part"),
         parts == 0 ? "No label fell apart."
                    : in_quotes(gate.worst) + " fell apart: it has " + formatted("%.0f pieces", number(*worst, "components_after").value_or(0)) + " of 50 voxels or more, and had " +
                          formatted("%.0f at rest.", number(*worst, "components_before").value_or(0)));
}

void judge_bands(const Json& report, const QualityLimits&, QualityGate& gate) {
  const Json& bands = part(report, "bands");
  if (!bands.is_array()) return not_checked(gate, "where the posed tissue lay at rest, or the rig, is not known.");
  if (bands.empty()) return decide(gate, true, "0", "No tissue is pulled out to more than twice its length away from the joint that moves it.");
  const Json& worst = bands[0];
  const Json& between = part(worst, "between");
  const auto end = [&](std::size_t i) { return between.is_array() && between.size() == 2 && between[i].is_string() ? between[i].get<std::string>() : ""; };
  gate.worst = end(0);
  decide(gate, false, counted(double(bands.size()), "band"),
         "A band of " + counted(number(worst, "voxels").value_or(0), "voxel") + " is pulled out to " + formatted("%.1f times", number(worst, "stretch").value_or(0)) + " its length" +
             (end(1).empty() ? "" : " between " + end(0) + " and " + end(1)) + at_place(worst) + ", and no joint explains it: part what touches there at rest, or correct the rig's joint.");
}

void judge_volume(const Json& report, const QualityLimits& limits, QualityGate& gate) {
  const auto change = number(part(report, "total"), "volume_change_percent");
  if (!change) return not_checked(gate, "the volumes before and after were not compared.");
  const Json& whole = part(report, "whole_body");
  const bool limb = whole.is_boolean() && !whole.get<bool>();
  decide(gate, std::abs(*change) <= (limb ? limits.limb_percent : limits.body_percent), formatted("%+.2f %%", *change),
         std::string(limb ? "The limb's" : "The whole body's") + " volume changed by " + formatted("%+.2f %%.", *change));
}

const GateRule kBodyGates[] = {
    {"inputs", "Inputs belong together", "Whether the rig lies in the body, on the right side and in the right limb, and whether the volume holds labels.",
     [](const QualityLimits&) { return std::string("no doubt"); }, true, judge_inputs},
    {"whole", "Bones whole", "Of each bone that a label names, how far its voxels lie from the bone's best rigid motion, {}.",
     [](const QualityLimits& l) { return "at most half a voxel, or " + formatted("%g mm", l.bone_residual_mm); }, true, judge_whole},
    {"follows", "Bones follow their rig bone", "Of each bone that a label names, the share that went with another rig bone, {}.",
     [](const QualityLimits& l) { return "at most " + formatted("%g %%", l.wrong_bone_percent); }, true, judge_follows},
    {"directions", "Limbs point as asked", "The angle between where the pose asked a limb to point and where its bones point, {}.",
     [](const QualityLimits& l) { return "at most " + formatted("%g degrees", l.direction_degrees); }, true, judge_directions},
    {"exposed", "Inside stays inside", "Voxels at the air that lay deep at rest and are not skin, {}.",
     [](const QualityLimits& l) { return "at most " + formatted("%g %% of the surface", l.exposed_percent); }, true, judge_exposed},
    {"trapped", "No air closed in", "Air that tissue encloses and did not at rest, {}.",
     [](const QualityLimits& l) { return "at most " + counted(l.trapped_voxels, "voxel"); }, true, judge_trapped},
    {"organs", "Organs within 10 %", "The volume of the organ that changed most, {}.",
     [](const QualityLimits& l) { return "at most " + formatted("%g %%", l.organ_percent); }, true, judge_organs},
    {"lost", "No label lost", "What is left of the label that lost most of its volume, {}.",
     [](const QualityLimits& l) { return "at least " + formatted("%g %%", l.lost_percent); }, true, judge_lost},
    {"torn", "No label torn", "Pieces of a label of 50 voxels or more that were one piece at rest, {}.", [](const QualityLimits&) { return std::string("none"); }, true, judge_torn},
    {"bands", "No bands", "Tissue that is pulled out to more than twice its length between parts that are no neighbours, {}.",
     [](const QualityLimits&) { return std::string("none"); }, true, judge_bands},
    {"volume", "Body volume", "The volume of the whole body, changed by {}.", [](const QualityLimits& l) { return "at most " + formatted("%g %%", l.body_percent) + formatted(", of a limb alone %g %%", l.limb_percent); }, true, judge_volume},
};

const GateRule kFineGates[] = {
    {"tissues", "Each tissue within {}", "The volume of the tissue that changed most, of those of", [](const QualityLimits& l) { return formatted("%g %%", l.tissue_percent); }, false, judge_tissues},
    {"bones", "Bone parts rigid", "How far a voxel of one of the program's bone parts lies from where its rig bone takes it, {}.",
     [](const QualityLimits& l) { return "at most " + formatted("%g mm", l.bone_residual_mm); }, false, judge_bones},
    {"skin", "Skin closed", "The share of the surface that is skin, {} below that at rest.",
     [](const QualityLimits& l) { return "at most " + formatted("%g %% of the surface", l.skin_share_percent); }, false, judge_skin},
    {"islands", "No islands or holes", "Pieces of a tissue of 50 voxels or more that were one at rest, voxels inside tissue that have no label, and tissue that fell off the grid.",
     [](const QualityLimits&) { return std::string("none"); }, false, judge_islands},
    {"inverted", "No inverted cells", "Tetrahedra that were turned inside out.", [](const QualityLimits&) { return std::string("none"); }, false, judge_inverted},
    {"crossings", "No self-intersection", "Pairs of the skin's triangles that cross, and voxels that two places of the body claim.",
     [](const QualityLimits&) { return std::string("none"); }, false, judge_crossings},
    {"limits", "Joint limits", "How far the joint that is turned too far is beyond its limits.",
     [](const QualityLimits& l) { return "at most " + formatted("%g degrees", l.joint_excess_degrees); }, false, judge_limits},
};

}  // namespace

std::string_view to_string(GateState state) { return state == GateState::Passed ? "passed" : state == GateState::Failed ? "failed" : "not checked"; }

std::vector<QualityGate> body_gates(const std::string& report, const QualityLimits& limits) { return judged(kBodyGates, report, limits); }

std::vector<QualityGate> quality_gates(const std::string& report, const QualityLimits& limits) { return judged(kFineGates, report, limits); }

std::vector<QualityGate> quality_gates(const Report& report, const QualityLimits& limits) { return quality_gates(to_json(report), limits); }

std::vector<QualityGate> all_gates(const std::string& report, const QualityLimits& limits) {
  std::vector<QualityGate> gates = body_gates(report, limits);
  for (const auto& more : {quality_gates(report, limits), solve_gates(report)}) gates.insert(gates.end(), more.begin(), more.end());
  return gates;
}

QualityGate judge_joint_limits(const Armature& armature, const Pose& pose, const QualityLimits& limits) {
  QualityGate gate = gate_of_limits();
  double worst = 0;
  std::string bone;
  for (std::size_t b = 0; b < armature.bones.size() && b < pose.rotation.size(); ++b) {
    const double excess = limit_excess(armature.bones[b], pose.rotation[b]) * 180 / M_PI;
    if (excess > worst) worst = excess, bone = armature.bones[b].name;
  }
  decide_limits(gate, worst, bone, limits);
  return gate;
}

}  // namespace limber
