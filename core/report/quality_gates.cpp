// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/report/quality_gates.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include <nlohmann/json.hpp>

#include "core/pose/limit_check.h"
#include "core/report/gate_rules.h"
#include "core/report/report.h"
#include "core/report/solve_gates.h"

namespace limber {

namespace {

using Json = nlohmann::json;

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
  if (!gate.worst.empty() && !any_large)
    gate.meaning = "Volume change of the tissue that changed most; no tissue has " + least + ".";
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
  if (const auto inverted = number(part(report, "mesh"), "inverted"))
    decide(gate, *inverted == 0, formatted("%.0f", *inverted));
}

void judge_crossings(const Json& report, const QualityLimits&, QualityGate& gate) {
  const auto pairs = number(part(report, "mesh"), "self_intersections"),
             overlap = number(part(report, "total"), "overlap_voxels");
  if (!pairs && !overlap) return;
  const bool crossing = pairs.value_or(0) > 0, twice = overlap.value_or(0) > 0;
  decide(gate, !crossing && !twice, twice ? counted(*overlap, "voxel") : crossing ? counted(*pairs, "pair") : "0");
}

QualityGate gate_of_limits() {
  QualityGate gate;
  gate.id = "limits", gate.name = "Joint limits", gate.meaning = "Largest angle by which a joint exceeds its limits.";
  return gate;
}

// The figures by which the gate `limits` (joint limits) is judged. They come from a report, or from a rig and a pose.
struct LimitFigures {
  bool turned = true;              // false: the report names no turned joint
  int limited = 0, unlimited = 0;  // number of joints with limits and without
  double excess_degrees = 0;       // largest angle by which a joint exceeds its limits
  std::string bone;                // bone of the joint that exceeds its limits most
};

void decide_limits(QualityGate& gate, const LimitFigures& figures, const QualityLimits& limits) {
  if (!figures.turned) return not_checked(gate, "the pose turns no joint.");
  if (figures.limited == 0) return not_checked(gate, "no joint has limits.");
  const bool within = figures.excess_degrees <= limits.joint_excess_degrees;
  gate.worst = within ? "" : figures.bone;
  if (!within)
    return decide(
        gate, false, formatted("%+.1f\u00b0", figures.excess_degrees),
        figures.bone + " is turned " + formatted("%.1f", figures.excess_degrees) + " degrees beyond its limits.");
  const std::string others = counted(figures.unlimited, "joint") + (figures.unlimited == 1 ? " has" : " have");
  decide(gate, true, "within",
         figures.unlimited == 0 ? "Every joint is within its limits."
                                : "Every joint that has limits is within them; " + others + " none.");
}

void judge_limits(const Json& report, const QualityLimits& limits, QualityGate& gate) {
  const Json& joints = part(report, "joints");
  if (!joints.is_array()) return;
  LimitFigures figures{.turned = !joints.empty()};
  for (const Json& joint : joints) {
    const auto excess = number(joint, "excess_degrees");
    ++(excess ? figures.limited : figures.unlimited);
    if (excess && *excess > figures.excess_degrees) {
      figures.excess_degrees = *excess;
      figures.bone = text(joint, "bone");
    }
  }
  decide_limits(gate, figures, limits);
}

const GateRule<Json> kFineGates[] = {
    {"tissues", "Each tissue within {}", "Volume change of the tissue that changed most, among tissues of",
     [](const QualityLimits& l) { return formatted("%g %%", l.tissue_percent); }, false, judge_tissues},
    {"bones", "Bone parts rigid",
     "Largest distance of a bone voxel from the position to which its rig bone moves it, {}.",
     [](const QualityLimits& l) { return "at most " + formatted("%g mm", l.bone_residual_mm); }, false, judge_bones},
    {"skin", "Skin closed", "The share of the surface that is skin, {} below the share at rest.",
     [](const QualityLimits& l) { return "at most " + formatted("%g %% of the surface", l.skin_share_percent); }, false,
     judge_skin},
    {"islands", "No islands or holes",
     "New separate pieces of a tissue of 50 voxels or more, voxels without a label inside tissue, and tissue outside "
     "the voxel grid.",
     none, false, judge_islands},
    {"inverted", "No inverted cells", "Tetrahedra that were turned inside out.", none, false, judge_inverted},
    {"crossings", "No self-intersection",
     "Pairs of the skin's triangles that cross, and voxels in which two parts of the body overlap.", none, false,
     judge_crossings},
    {"limits", "Joint limits", "Largest angle by which a joint exceeds its limits.",
     [](const QualityLimits& l) { return "at most " + formatted("%g degrees", l.joint_excess_degrees); }, false,
     judge_limits},
};

}  // namespace

std::string_view to_string(GateState state) {
  return state == GateState::Passed ? "passed" : state == GateState::Failed ? "failed" : "not checked";
}

std::vector<QualityGate> quality_gates(const std::string& report, const QualityLimits& limits) {
  return judged(kFineGates, report, limits);
}

std::vector<QualityGate> quality_gates(const Report& report, const QualityLimits& limits) {
  return quality_gates(to_json(report), limits);
}

std::vector<QualityGate> all_gates(const std::string& report, const QualityLimits& limits) {
  std::vector<QualityGate> gates = body_gates(report, limits);
  for (const auto& more : {quality_gates(report, limits), solve_gates(report)})
    gates.insert(gates.end(), more.begin(), more.end());
  return gates;
}

QualityGate judge_joint_limits(const Armature& armature, const Pose& pose, const QualityLimits& limits) {
  QualityGate gate = gate_of_limits();
  const LimitCheck check = check_limits(armature, pose, 0);
  decide_limits(gate,
                {.limited = check.limited,
                 .unlimited = check.unlimited,
                 .excess_degrees = check.excess * 180 / M_PI,
                 .bone = check.worst < 0 ? "" : armature.bones[check.worst].name},
                limits);
  return gate;
}

}  // namespace limber
