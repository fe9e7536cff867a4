// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/report/quality_gates.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>

#include <nlohmann/json.hpp>

#include "core/pose/pose.h"
#include "core/report/report.h"
#include "core/rig/joint_limits.h"

namespace limber {

namespace {

using Json = nlohmann::json;

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

void decide(QualityGate& gate, bool passed, std::string figure) {
  gate.state = passed ? GateState::Passed : GateState::Failed;
  gate.figure = std::move(figure);
}

QualityGate judge_tissues(const Json& report, const QualityLimits& limits) {
  const std::string least = counted(double(limits.least_voxels), "voxel");
  QualityGate gate{"tissues", "Each tissue within " + formatted("%g %%", limits.tissue_percent), GateState::NotMeasured, "", "", "The volume of the tissue that changed most, of those of " + least + " or more."};
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
  return gate;
}

QualityGate judge_bones(const Json& report, const QualityLimits& limits) {
  QualityGate gate{"bones", "Bones rigid", GateState::NotMeasured, "", "", "How far a bone's voxel lies from where the bone's motion takes it, at most " + formatted("%g mm.", limits.bone_residual_mm)};
  double worst = -1;
  for (const Json& bone : part(report, "bones"))
    if (const auto residual = number(bone, "rigid_residual_mm"); residual && *residual > worst) {
      worst = *residual;
      gate.worst = text(bone, "name");
    }
  if (worst >= 0) decide(gate, worst <= limits.bone_residual_mm, formatted("%.3f mm", worst));
  return gate;
}

QualityGate judge_skin(const Json& report, const QualityLimits& limits) {
  QualityGate gate{"skin", "Skin closed", GateState::NotMeasured, "", "", "The share of the surface that is skin, at most " + formatted("%g %%", limits.skin_share_percent) + " of the surface below that at rest."};
  const Json& skin = part(report, "skin");
  const auto before = number(skin, "surface_share_before"), after = number(skin, "surface_share_after");
  if (!before || !after) return gate;
  decide(gate, *after >= *before - limits.skin_share_percent / 100, formatted("%.1f %%", 100 * *after));
  gate.meaning += formatted(" At rest it is %.1f %%.", 100 * *before);
  return gate;
}

QualityGate judge_islands(const Json& report) {
  QualityGate gate{"islands", "No islands or holes", GateState::NotMeasured, "", "", "Pieces of a tissue of 50 voxels or more that were one at rest, voxels inside tissue that have no label, and tissue that fell off the grid."};
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
  if (!measured && !holes) return gate;
  std::string figure = islands > 0 ? counted(islands, "island") : "";
  if (holes.value_or(0) > 0) figure += (figure.empty() ? "" : ", ") + counted(*holes, "hole");
  if (dropped.value_or(0) > 0) figure += (figure.empty() ? "" : ", ") + counted(*dropped, "voxel") + " lost";
  decide(gate, figure.empty(), figure.empty() ? "0" : figure);
  return gate;
}

QualityGate judge_inverted(const Json& report) {
  QualityGate gate{"inverted", "No inverted cells", GateState::NotMeasured, "", "", "Tetrahedra that were turned inside out."};
  if (const auto inverted = number(part(report, "mesh"), "inverted")) decide(gate, *inverted == 0, formatted("%.0f", *inverted));
  return gate;
}

QualityGate judge_crossings(const Json& report) {
  QualityGate gate{"crossings", "No self-intersection", GateState::NotMeasured, "", "", "Pairs of the skin's triangles that cross, and voxels that two places of the body claim."};
  const auto pairs = number(part(report, "mesh"), "self_intersections"), overlap = number(part(report, "total"), "overlap_voxels");
  if (!pairs && !overlap) return gate;
  const bool crossing = pairs.value_or(0) > 0, twice = overlap.value_or(0) > 0;
  decide(gate, !crossing && !twice, twice ? counted(*overlap, "voxel") : crossing ? counted(*pairs, "pair") : "0");
  return gate;
}

QualityGate gate_of_limits() { return {"limits", "Joint limits", GateState::NotMeasured, "", "", "How far the joint that is turned too far is beyond its limits."}; }

// Of the joint that is furthest beyond.
void decide_limits(QualityGate& gate, double excess_degrees, const std::string& bone, const QualityLimits& limits) {
  const bool within = excess_degrees <= limits.joint_excess_degrees;
  gate.worst = within ? "" : bone;
  decide(gate, within, within ? "within" : formatted("%+.1f\u00b0", excess_degrees));
}

QualityGate judge_limits(const Json& report, const QualityLimits& limits) {
  QualityGate gate = gate_of_limits();
  const Json& joints = part(report, "joints");
  double worst = 0;
  std::string bone;
  for (const Json& joint : joints)
    if (const auto excess = number(joint, "excess_degrees"); excess && *excess > worst) {
      worst = *excess;
      bone = text(joint, "bone");
    }
  if (joints.is_array()) decide_limits(gate, worst, bone, limits);
  return gate;
}

}  // namespace

std::vector<QualityGate> quality_gates(const std::string& report, const QualityLimits& limits) {
  const Json json = Json::parse(report, nullptr, false);
  return {judge_tissues(json, limits), judge_bones(json, limits), judge_skin(json, limits), judge_islands(json), judge_inverted(json), judge_crossings(json), judge_limits(json, limits)};
}

std::vector<QualityGate> quality_gates(const Report& report, const QualityLimits& limits) { return quality_gates(to_json(report), limits); }

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
