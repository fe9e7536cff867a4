// SPDX-License-Identifier: AGPL-3.0-or-later
// Judges the body gates: tests of a report's figures that tell whether a posed volume is still a body
// (quality_gates.h).
#include "core/report/quality_gates.h"

#include <algorithm>
#include <cmath>
#include <set>

#include <nlohmann/json.hpp>

#include "core/report/gate_rules.h"

namespace limber {

namespace {

using Json = nlohmann::json;

// Smallest tear of a bone that counts, in voxel edges. A smaller tear cannot be seen in a voxel volume.
constexpr double kTear = 0.5;

void judge_inputs(const Json& report, const QualityLimits&, QualityGate& gate) {
  const Json& doubts = part(report, "doubts");
  if (!doubts.is_array()) return not_checked(gate, "volume, labels and rig were not compared.");
  const std::string first = doubts.empty() || !doubts[0].is_string() ? "" : doubts[0].get<std::string>();
  decide(
      gate, doubts.empty(), counted(double(doubts.size()), "doubt"),
      doubts.empty() ? "Volume, labels and rig belong together." : "The inputs do not belong together: " + first + ".");
}

// Returns the edge length in mm of a cube with the volume of a rest voxel; 0: no tissue was measured.
double voxel_edge(const Json& report) {
  for (const Json& tissue : part(report, "tissues"))
    if (const auto mm3 = number(tissue, "mm3_before"), voxels = number(tissue, "voxels_before");
        mm3 && voxels && *voxels > 0)
      return std::cbrt(*mm3 / *voxels);
  return 0;
}

void judge_whole(const Json& report, const QualityLimits& limits, QualityGate& gate) {
  const Json& bones = part(report, "whole_bones");
  const Json* worst = worst_row(bones, [](const Json& bone) { return number(bone, "residual_mm"); });
  if (!worst) return not_checked(gate, "no posed voxel has a label that names a bone of the rig.");
  const double residual = *number(*worst, "residual_mm");
  gate.worst = text(*worst, "name");
  const bool passed = residual <= std::max(limits.bone_residual_mm, kTear * voxel_edge(report));
  decide(gate, passed, formatted("%.3f mm", residual),
         passed ? "Each of " + counted(double(bones.size()), "named bone") + " moved rigidly, within " +
                      formatted("%.3f mm.", residual)
                : in_quotes(gate.worst) + " is torn or bent: its voxels lie up to " + formatted("%.1f mm", residual) +
                      " from the bone's best rigid motion.");
}

std::optional<double> wrong_percent(const Json& bone) {
  const auto wrong = number(bone, "wrong_voxels"), all = number(bone, "voxels");
  return wrong && all && *all > 0 ? std::optional(100 * *wrong / *all) : std::nullopt;
}

void judge_follows(const Json& report, const QualityLimits& limits, QualityGate& gate) {
  const Json& bones = part(report, "whole_bones");
  const Json* worst = worst_row(bones, wrong_percent);
  if (!worst) return not_checked(gate, "no posed voxel has a label that names a bone of the rig.");
  const bool passed = *wrong_percent(*worst) <= limits.wrong_bone_percent;
  gate.worst = text(*worst, "name");
  decide(gate, passed, formatted("%.2f %%", *wrong_percent(*worst)),
         passed ? "Each of " + counted(double(bones.size()), "named bone") + " follows a rig bone that its name allows."
                : counted(number(*worst, "wrong_voxels").value_or(0), "voxel") + " of " +
                      counted(number(*worst, "voxels").value_or(0), "voxel") + " of " + in_quotes(gate.worst) +
                      " follow " + text(*worst, "went_with") + ", but belong to " + text(*worst, "belongs_to") + ".");
}

void judge_directions(const Json& report, const QualityLimits& limits, QualityGate& gate) {
  const Json& limbs = part(report, "limbs");
  const Json* worst = worst_row(limbs, [](const Json& limb) { return number(limb, "direction_off_degrees"); });
  if (!worst) return not_checked(gate, "the pose turns no rig bone in which bone tissue was found.");
  const double off = *number(*worst, "direction_off_degrees");
  gate.worst = text(*worst, "bone");
  const bool passed = off <= limits.direction_degrees;
  decide(gate, passed, formatted("%.2f\u00b0", off),
         passed ? "Each of " + counted(double(limbs.size()), "turned limb") +
                      " points in the direction that the pose sets, within " + formatted("%.2f degrees.", off)
                : gate.worst + " points " + formatted("%.1f degrees", off) +
                      " away from the direction that the pose sets.");
}

void judge_exposed(const Json& report, const QualityLimits& limits, QualityGate& gate) {
  const Json& exposure = part(report, "exposure");
  const auto percent = number(exposure, "percent"), voxels = number(exposure, "voxels");
  if (!percent || !voxels) return not_checked(gate, "where the posed tissue lay at rest is not known.");
  const bool passed = *percent <= limits.exposed_percent;
  const Json& labels = part(exposure, "by_label");
  const Json* most = worst_row(labels, [](const Json& row) { return number(row, "voxels"); });
  if (most) gate.worst = text(*most, "name");
  const std::string exposed = counted(*voxels, "voxel") + " that lay deep inside " + (*voxels == 1 ? "is" : "are") +
                              " exposed to the air now, " + formatted("%.2f %% of the surface", *percent);
  decide(gate, passed, formatted("%.2f %%", *percent),
         *voxels == 0 ? "No tissue that lay deep inside touches the air."
                      : exposed + ", most of them in " + in_quotes(gate.worst) + "; the worst place is" +
                            at_place(part(exposure, "worst")) + ".");
}

void judge_trapped(const Json& report, const QualityLimits& limits, QualityGate& gate) {
  const auto trapped = number(part(report, "total"), "trapped_air_voxels");
  if (!trapped) return not_checked(gate, "the volumes before and after were not compared.");
  const Json& pocket = part(report, "air_pocket");
  const bool passed = *trapped <= limits.trapped_voxels;
  decide(gate, passed, counted(*trapped, "voxel"),
         passed ? "No more air is enclosed than at rest, except " + counted(*trapped, "voxel") + "."
                : counted(*trapped, "voxel") + " of air are enclosed that were not enclosed at rest" +
                      (pocket.is_object()
                           ? "; the largest new pocket, " + counted(number(pocket, "voxels").value_or(0), "voxel") +
                                 ", lies" + at_place(pocket)
                           : "") +
                      ".");
}

// Returns the change of a tissue's volume in percent; nothing if the tissue is too small at rest to be judged.
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
  if (!worst)
    return not_checked(
        gate, "no label of " + counted(double(limits.least_organ_voxels), "voxel") + " or more is known for an organ.");
  const double change = *number(*worst, "volume_change_percent");
  gate.worst = text(*worst, "name");
  const bool passed = std::abs(change) <= limits.organ_percent;
  decide(gate, passed, formatted("%+.1f %%", change),
         passed ? "No organ's volume changed by more than " + formatted("%.1f %%", std::abs(change)) +
                      ", the change of " + in_quotes(gate.worst) + "."
                : "The volume of " + in_quotes(gate.worst) + " changed by " + formatted("%+.1f %%.", change));
}

void judge_lost(const Json& report, const QualityLimits& limits, QualityGate& gate) {
  const Json* worst = worst_row(part(report, "tissues"), [&](const Json& tissue) -> std::optional<double> {
    const auto change = change_of(tissue, limits);
    return change ? std::optional(-*change) : std::nullopt;
  });
  if (!worst)
    return not_checked(gate,
                       "no label of " + counted(double(limits.least_organ_voxels), "voxel") + " or more was compared.");
  const double left = 100 + *number(*worst, "volume_change_percent");
  const bool passed = left >= limits.lost_percent;
  gate.worst = text(*worst, "name");
  decide(gate, passed, formatted("%.0f %%", left),
         passed ? "No label is lost. The smallest share of its volume is left of " + in_quotes(gate.worst) + ": " +
                      formatted("%.0f %%.", left)
                : in_quotes(gate.worst) + " is lost: " +
                      (left <= 0 ? std::string("nothing") : formatted("%.1f %%", left)) + " of its volume is left.");
}

void judge_torn(const Json& report, const QualityLimits&, QualityGate& gate) {
  // Skips labels that name bones: the gate `whole` judges these by the motion of their voxels. In a volume of thick
  // slices a thin bone may look torn after a turn although it is whole, because it misses voxel centres.
  std::set<double> named;
  for (const Json& bone : part(report, "whole_bones"))
    if (const auto label = number(bone, "label")) named.insert(*label);
  const Json* worst = worst_row(part(report, "tissues"), [&](const Json& tissue) {
    const auto label = number(tissue, "label");
    return label && named.contains(*label) ? std::nullopt : number(tissue, "torn_parts");
  });
  if (!worst)
    return not_checked(gate, "the pieces of labels were not counted before and after, on voxels of one size.");
  const double parts = *number(*worst, "torn_parts");
  if (parts > 0) gate.worst = text(*worst, "name");
  decide(gate, parts == 0, counted(parts, "part"),
         parts == 0 ? "No label fell apart."
                    : in_quotes(gate.worst) + " fell apart: it has " +
                          formatted("%.0f pieces", number(*worst, "components_after").value_or(0)) +
                          " of 50 voxels or more, and had " +
                          formatted("%.0f at rest.", number(*worst, "components_before").value_or(0)));
}

void judge_bands(const Json& report, const QualityLimits&, QualityGate& gate) {
  const Json& bands = part(report, "bands");
  if (!bands.is_array()) return not_checked(gate, "where the posed tissue lay at rest, or the rig, is not known.");
  if (bands.empty())
    return decide(gate, true, "0",
                  "Away from the joint that moves it, no tissue is stretched to more than twice its length.");
  const Json& worst = bands[0];
  const Json& between = part(worst, "between");
  const auto end = [&](std::size_t i) {
    return between.is_array() && between.size() == 2 && between[i].is_string() ? between[i].get<std::string>() : "";
  };
  gate.worst = end(0);
  decide(gate, false, counted(double(bands.size()), "band"),
         "A band of " + counted(number(worst, "voxels").value_or(0), "voxel") + " is stretched to " +
             formatted("%.1f times", number(worst, "stretch").value_or(0)) + " its length" +
             (end(1).empty() ? "" : " between " + end(0) + " and " + end(1)) + at_place(worst) +
             ", and no joint explains it: separate the parts that touch there at rest, or correct the rig's joint.");
}

void judge_volume(const Json& report, const QualityLimits& limits, QualityGate& gate) {
  const auto change = number(part(report, "total"), "volume_change_percent");
  if (!change) return not_checked(gate, "the volumes before and after were not compared.");
  const Json& whole = part(report, "whole_body");
  const bool limb = whole.is_boolean() && !whole.get<bool>();
  decide(
      gate, std::abs(*change) <= (limb ? limits.limb_percent : limits.body_percent), formatted("%+.2f %%", *change),
      std::string(limb ? "The limb's" : "The whole body's") + " volume changed by " + formatted("%+.2f %%.", *change));
}

const GateRule<Json> kBodyGates[] = {
    {"inputs", "Inputs belong together",
     "Whether the rig lies in the body, on the correct side and in the correct limb, and whether the volume holds "
     "labels.",
     [](const QualityLimits&) { return std::string("no doubt"); }, true, judge_inputs},
    {"whole", "Bones whole",
     "Largest distance of a bone's voxels from the rigid motion that fits this bone best, {}. Bones are found by the "
     "names of labels.",
     [](const QualityLimits& l) { return "at most half a voxel, or " + formatted("%g mm", l.bone_residual_mm); }, true,
     judge_whole},
    {"follows", "Bones follow their rig bone",
     "Largest share of a bone's voxels that follow a wrong rig bone, {}. Bones are found by the names of labels.",
     at_most_percent<&QualityLimits::wrong_bone_percent>, true, judge_follows},
    {"directions", "Limbs point as posed",
     "The angle between the direction of a limb that the pose sets and the direction of its bones, {}.",
     [](const QualityLimits& l) { return "at most " + formatted("%g degrees", l.direction_degrees); }, true,
     judge_directions},
    {"exposed", "No deep tissue exposed",
     "Voxels that touch the air, but lay deep in the body at rest and are not skin, {}.",
     [](const QualityLimits& l) { return "at most " + formatted("%g %% of the surface", l.exposed_percent); }, true,
     judge_exposed},
    {"trapped", "No air enclosed", "Air that tissue encloses in the pose but not at rest, {}.",
     [](const QualityLimits& l) { return "at most " + counted(l.trapped_voxels, "voxel"); }, true, judge_trapped},
    {"organs", "Organs keep their volume", "Volume change of the organ that changed most, {}.",
     at_most_percent<&QualityLimits::organ_percent>, true, judge_organs},
    {"lost", "No label lost", "Remaining volume of the label that lost the most, {}.",
     [](const QualityLimits& l) { return "at least " + formatted("%g %%", l.lost_percent); }, true, judge_lost},
    {"torn", "No label torn",
     "Labels that are in one piece at rest and in several pieces of 50 voxels or more in the pose, {}.", none, true,
     judge_torn},
    {"bands", "No stretched bands",
     "Tissue that is stretched to more than twice its length between parts of the body that are not neighbours, {}.",
     none, true, judge_bands},
    {"volume", "Body volume", "Volume change of the whole body, {}.",
     [](const QualityLimits& l) {
       return "at most " + formatted("%g %%", l.body_percent) + formatted(", of a limb alone %g %%", l.limb_percent);
     },
     true, judge_volume},
};

}  // namespace

std::vector<QualityGate> body_gates(const std::string& report, const QualityLimits& limits) {
  return judged(kBodyGates, report, limits);
}

}  // namespace limber
