// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/report/report.h"

#include <cmath>

#include <nlohmann/json.hpp>

#include "core/base/json_text.h"
#include "core/platform/process.h"
#include "core/report/quality_gates.h"
#include "core/rig/joint_limits.h"
#include "core/rig/joint_names.h"

namespace limber {

namespace {
using Json = nlohmann::ordered_json;

// Returns a label's value in files as an integer for JSON. Such values are whole numbers of at most 2^53.
Json whole(double value) { return static_cast<std::int64_t>(value); }

// Returns the number of voxels that a label lost to other tissue where regions of the body overlap; 0 if it was not
// counted.
std::int64_t overlap_of(const Report& report, Label label) {
  return report.deform && !report.deform->overlap_by_label.empty() ? report.deform->overlap_by_label[label] : 0;
}

Json tissue_rows(const Report& report) {
  Json rows = Json::array();
  for (const TissueChange& tissue : report.metrics->tissues) {
    Json row{{"label", whole(tissue.file_value)},
             {"name", tissue.name},
             {"kind", std::string(to_string(tissue.kind))},
             {"voxels_before", tissue.voxels_before},
             {"voxels_after", tissue.voxels_after},
             {"mm3_before", tissue.mm3_before},
             {"mm3_after", tissue.mm3_after},
             {"mass_before_g", tissue.mass_before},
             {"mass_after_g", tissue.mass_after}};
    // Leaves out the change in percent for a tissue that was absent before posing.
    if (tissue.voxels_before) {
      row["volume_change_percent"] = tissue.volume_change_percent;
      row["mass_change_percent"] = tissue.mass_change_percent;
    }
    row["components_before"] = tissue.components_before;
    row["components_after"] = tissue.components_after;
    if (tissue.torn_parts) row["torn_parts"] = *tissue.torn_parts;
    if (report.deform) row["overlap_voxels"] = overlap_of(report, tissue.label);
    if (!report.dice.empty()) row["dice"] = report.dice[tissue.label];
    rows.push_back(row);
  }
  return rows;
}

Json total(const Report& report) {
  Json row = Json::object();
  if (report.metrics) {
    const VolumeMetrics& metrics = *report.metrics;
    row["voxels_before"] = metrics.voxels_before;
    row["voxels_after"] = metrics.voxels_after;
    row["mm3_before"] = metrics.mm3_before;
    row["mm3_after"] = metrics.mm3_after;
    row["mass_before_g"] = metrics.mass_before;
    row["mass_after_g"] = metrics.mass_after;
    if (metrics.voxels_before) {
      row["volume_change_percent"] = metrics.volume_change_percent;
      row["mass_change_percent"] = metrics.mass_change_percent;
    }
    row["trapped_air_voxels"] = metrics.trapped_air_voxels;
    row["enclosed_air_before"] = metrics.enclosed_air_before;
    row["enclosed_air_after"] = metrics.enclosed_air_after;
  }
  if (report.deform) {
    row["overlap_voxels"] = report.deform->overlap_voxels;
    row["new_hole_voxels"] = report.deform->new_hole_voxels;
    row["dropped_voxels"] = report.deform->dropped_voxels;
    row["bone_overlap_voxels"] = report.deform->bone_overlap_voxels;
    row["mended_voxels"] = report.deform->mended_voxels;
    row["new_skin_voxels"] = report.deform->new_skin_voxels;
    row["filled_air_voxels"] = report.deform->filled_air_voxels;
  }
  return row;
}

Json baked_of(const BakedJointReport& joint) {
  const BakeError& worst = joint.worst_between;
  return {{"bone", joint.bone},
          {"degrees", joint.degrees},
          {"other_degrees", joint.other_degrees},
          {"baked_at_degrees", joint.baked_at},
          {"beyond_baked_range", joint.is_beyond()},
          {"glide", joint.glide},
          {"error_between",
           {{"degrees", worst.degrees},
            {"flesh_95_mm", worst.flesh_mm},
            {"skin_95_mm", worst.skin_mm},
            {"largest_mm", worst.largest_mm}}}};
}

Json settled_of(const SettledFlesh::Report& settled) {
  return {{"cells", settled.cells},
          {"volume_error_before", settled.volume_error_before},
          {"volume_error_after", settled.volume_error_after},
          {"largest_shift_mm", settled.largest_shift_mm}};
}

// Returns the label's value in the user's files as text; the label itself if the report has no tissues.
std::string key_of(const Report& report, Label label) {
  if (report.metrics)
    for (const TissueChange& tissue : report.metrics->tissues)
      if (tissue.label == label) return whole(tissue.file_value).dump();
  return std::to_string(label);
}

Json mesh_of(const Report& report, const MeshReport& mesh) {
  Json row{
      {"tets", mesh.tets},           {"nodes", mesh.nodes},           {"inverted", mesh.inverted},
      {"min_det_f", mesh.min_det_f}, {"joint_tets", mesh.joint_tets}, {"share_below_fifth", mesh.share_below_fifth}};
  if (mesh.self_intersections) row["self_intersections"] = *mesh.self_intersections;
  if (mesh.contact_nodes > 0) row["contact_nodes"] = mesh.contact_nodes;
  if (mesh.min_gap_mm) row["min_gap_mm"] = *mesh.min_gap_mm;
  if (mesh.median_gap_mm) row["median_gap_mm"] = *mesh.median_gap_mm;
  Json change = Json::object();
  for (const auto& [label, percent] : mesh.volume_change_percent) change[key_of(report, label)] = percent;
  row["volume_change_percent_by_label"] = change;
  for (const auto& [label, stretch] : mesh.stretch)
    row["stretch_by_label"][key_of(report, label)] = {{"least", stretch.least}, {"most", stretch.most}};
  if (!mesh.fallback.empty()) row["fallback"] = mesh.fallback;
  return row;
}

Json object_of(const ObjectReport& object) {
  Json row{{"name", object.name},
           {"away_mm", object.away_mm},
           {"pressing_n", object.pressing_n},
           {"force_n", {object.force_n.x, object.force_n.y, object.force_n.z}},
           {"contact_area_mm2", object.area_mm2},
           {"largest_pressure_kpa", object.largest_kpa},
           {"crossings", object.crossings}};
  if (object.asked_n) row["asked_n"] = *object.asked_n;
  if (std::isfinite(object.gap_mm)) row["gap_mm"] = object.gap_mm;
  return row;
}

Json vector_of(const glm::dvec3& v) { return {v.x, v.y, v.z}; }

Json solve_of(const SolveReport& solve) {
  Json row{{"converged", solve.converged}, {"reached", solve.reached}};
  if (!solve.blocked_by.empty()) row["blocked_by"] = solve.blocked_by;
  row.update({{"steps", solve.steps},
              {"iterations", solve.iterations},
              {"factorizations", solve.factorizations},
              {"analyses", solve.analyses},
              {"residual", solve.residual_mm},
              {"bone_drift_mm", solve.bone_drift_mm}});
  if (solve.repeated_in_double > 0) row["repeated_in_double"] = solve.repeated_in_double;
  if (solve.sliding_nodes > 0)
    row["sliding"] = {{"nodes", solve.sliding_nodes},
                      {"largest_mm", solve.largest_slide_mm},
                      {"largest_gap_mm", solve.largest_slide_gap_mm}};
  const SolveParameters& used = solve.parameters;
  row["parameters"] = {{"tet_mm", used.tet_mm},
                       {"finest_tet_mm", used.finest_tet_mm},
                       {"step_degrees", used.step_degrees},
                       {"step_tolerance_mm", used.step_tolerance_mm},
                       {"tolerance_mm", used.tolerance_mm},
                       {"joint_mm", used.joint_mm}};
  if (used.contact_mm) row["parameters"]["contact_mm"] = *used.contact_mm;
  if (solve.error && !solve.error->unknown.empty()) row["error_estimate"] = {{"unknown", solve.error->unknown}};
  else if (solve.error)
    row["error_estimate"] = {{"rms_mm", solve.error->rms_mm},
                             {"most_mm", solve.error->most_mm},
                             {"largest_mm", solve.error->largest_mm},
                             {"place", vector_of(solve.error->place)},
                             {"coarse_tet_mm", solve.error->coarse_tet_mm}};
  return row;
}

// Returns the changes that the option --mass-exact made, as JSON.
Json mass_exact_of(const Report& report, const MassExactReport& exact) {
  Json row{{"changed_voxels", exact.changed_voxels}};
  for (const auto& [label, tissue] : exact.tissues)
    row["tissues"].push_back({{"label", Json::parse(key_of(report, label))},
                              {"voxels_wanted", tissue.wanted},
                              {"voxels_before", tissue.before},
                              {"voxels_after", tissue.after}});
  return row;
}

Json joint_of(const TurnedJoint& joint) {
  Json row{{"bone", joint.bone},
           {"degrees", joint.degrees},
           {"axis", vector_of(joint.axis)},
           {"head", vector_of(joint.head)},
           {"tail", vector_of(joint.tail)},
           {"parent_head", vector_of(joint.parent_head)}};
  if (joint.excess_degrees) row["excess_degrees"] = *joint.excess_degrees;
  return row;
}

Json glide_of(const std::vector<GlidedJoint>& joints) {
  Json rows = Json::array();
  for (const GlidedJoint& joint : joints)
    rows.push_back({{"bone", joint.bone},
                    {"against", joint.against},
                    {"shift_mm", vector_of(joint.shift)},
                    {"length_mm", glm::length(joint.shift)},
                    {"most_mm", joint.most_mm},
                    {"free", joint.free},
                    {"depth_before_mm", joint.depth_before},
                    {"depth_after_mm", joint.depth_after}});
  return rows;
}

bool is_whole_body(const Armature& armature) {
  std::vector<std::string> names;
  std::vector<int> parents;
  for (const Bone& bone : armature.bones) names.push_back(bone.name), parents.push_back(bone.parent);
  bool leg = false, above = false;
  for (const auto& role : joint_roles(names, parents)) {
    leg |= role && (role->part == BodyPart::Thigh || role->part == BodyPart::Shank);
    above |= role && (role->part == BodyPart::UpperArm || role->part == BodyPart::Head);
  }
  return leg && above;
}

Json worst_of(const WorstPlace& worst) {
  Json row{{"voxels", worst.voxels}, {"place", vector_of(worst.place)}};
  if (!worst.near.empty()) row["near"] = worst.near;
  return row;
}

Json exposure_of(const Report& report, const Exposure& exposure) {
  Json row{{"voxels", exposure.voxels},
           {"surface_voxels", exposure.surface_voxels},
           {"percent", exposure.percent()},
           {"deeper_than_mm", exposure.deeper_than_mm}};
  for (const auto& [label, voxels] : exposure.by_label) {
    std::string name = "label " + key_of(report, label);
    if (report.metrics)
      for (const TissueChange& tissue : report.metrics->tissues)
        if (tissue.label == label) name = tissue.name;
    row["by_label"].push_back({{"label", Json::parse(key_of(report, label))}, {"name", name}, {"voxels", voxels}});
  }
  if (exposure.worst) row["worst"] = worst_of(*exposure.worst);
  return row;
}

Json whole_bone_of(const WholeBone& bone) {
  Json row{{"label", bone.file_value},          {"name", bone.name},
           {"belongs_to", bone.belongs_to},     {"voxels", bone.voxels},
           {"wrong_voxels", bone.wrong_voxels}, {"residual_mm", bone.residual_mm}};
  if (!bone.went_with.empty()) row["went_with"] = bone.went_with;
  return row;
}

Json band_of(const Band& band) {
  Json row{{"voxels", band.voxels}, {"mm3", band.mm3}, {"stretch", band.stretch}, {"place", vector_of(band.place)}};
  if (!band.between[1].empty()) row["between"] = band.between;
  return row;
}

Json gate_of(const QualityGate& gate) {
  Json row{{"id", gate.id},       {"name", gate.name},         {"state", std::string(to_string(gate.state))},
           {"limit", gate.limit}, {"sentence", gate.sentence}, {"strict", gate.strict}};
  if (!gate.figure.empty()) row["figure"] = gate.figure;
  if (!gate.worst.empty()) row["worst"] = gate.worst;
  return row;
}

// Adds the measures of the posed body to the JSON: bones, limbs, exposed tissue, enclosed air and bands.
void add_body(const Report& report, Json& json) {
  if (report.doubts) json["doubts"] = *report.doubts;
  if (report.whole_body) json["whole_body"] = *report.whole_body;
  for (const WholeBone& bone : report.posed_bones.whole) json["whole_bones"].push_back(whole_bone_of(bone));
  for (const LimbDirection& limb : report.posed_bones.limbs)
    json["limbs"].push_back(
        {{"bone", limb.bone},
         {"direction_off_degrees", limb.direction_degrees},
         {"orientation_off_degrees", limb.orientation_degrees},
         {"voxels", limb.voxels},
         {"measured_from", limb.by_name ? "named bones" : "bone tissue around the middle of its axis"}});
  if (report.exposure) json["exposure"] = exposure_of(report, *report.exposure);
  if (report.air_pocket) json["air_pocket"] = worst_of(*report.air_pocket);
  if (!report.bands) return;
  json["bands"] = Json::array();
  for (const Band& band : *report.bands) json["bands"].push_back(band_of(band));
}

Json seconds_of(const StageSeconds& seconds) {
  Json row = Json::object();
  for (const auto& [stage, value] : stages_of(seconds)) row[stage] = value;
  return row;
}
}  // namespace

std::vector<std::pair<std::string, double>> stages_of(const StageSeconds& seconds) {
  const std::pair<const char*, const std::optional<double>*> all[] = {
      {"read", &seconds.read},           {"weights", &seconds.weights}, {"glide", &seconds.glide},
      {"deform", &seconds.deform},       {"mesh", &seconds.mesh},       {"solve", &seconds.solve},
      {"rasterize", &seconds.rasterize}, {"report", &seconds.report},   {"write", &seconds.write},
      {"total", &seconds.total}};
  std::vector<std::pair<std::string, double>> stages;
  for (const auto& [stage, value] : all)
    if (*value) stages.emplace_back(stage, **value);
  return stages;
}

std::vector<TurnedJoint> turned_joints(const Armature& rig, const Pose& pose) {
  std::vector<TurnedJoint> joints;
  const std::vector<RigidTransform> motions = posed_from_rest(rig, pose);
  for (size_t b = 0; b < rig.bones.size(); ++b) {
    const Bone& bone = rig.bones[b];
    glm::dquat turn = pose.rotation[b];
    if (turn.w < 0) turn = -turn;
    const glm::dvec3 about(turn.x, turn.y, turn.z);
    if (glm::length(about) == 0) continue;
    TurnedJoint joint{.bone = bone.name,
                      .degrees = glm::degrees(2 * std::atan2(glm::length(about), turn.w)),
                      .axis = glm::normalize(about)};
    if (bone.parent >= 0) joint.axis = motions[bone.parent].rotation * joint.axis;
    joint.head = motions[b] * bone.head;
    joint.tail = motions[b] * bone.tail;
    joint.parent_head = bone.parent >= 0 ? motions[bone.parent] * rig.bones[bone.parent].head : joint.head;
    if (bone.limits.type != JointLimits::Type::Free)
      joint.excess_degrees = glm::degrees(limit_excess(bone, pose.rotation[b]));
    joints.push_back(joint);
  }
  return joints;
}

void measure_body(const JudgedPose& pose, const BoneMap& map, Report& report) {
  if (pose.armature) report.whole_body = is_whole_body(*pose.armature);
  const AirAround air = air_around(pose);
  if (report.metrics && report.metrics->trapped_air_voxels > 0) report.air_pocket = largest_air_pocket(pose, air);
  if (!pose.knows_field()) return;
  report.exposure = measure_exposure(pose, air);
  if (!pose.armature) return;
  report.posed_bones = measure_posed_bones(pose, map);
  report.bands = find_bands(pose, air);
}

void judge(Report& report) { report.gates = all_gates(to_json(report)); }

std::vector<std::string> failed_gates(const Report& report) {
  std::vector<std::string> sentences;
  for (const QualityGate& gate : report.gates)
    if (gate.strict && gate.state == GateState::Failed) sentences.push_back(gate.sentence);
  return sentences;
}

InputFile describe_input(const Path& path) { return {path.string(), sha256_of_file(path)}; }

double peak_memory_mb() { return static_cast<double>(peak_memory()) / 1e6; }

std::string to_json(const Report& report) {
  Json json{{"schema", "limber-report/1"}, {"version", LIMBER_VERSION}};
  if (!report.method.empty()) json["method"] = report.method;
  if (!report.settings.empty())
    for (const auto& [name, value] : report.settings)
      std::visit([&, &key = name](const auto& v) { json["settings"][key] = v; }, value);
  if (!report.inputs.empty())
    for (const InputFile& input : report.inputs)
      json["inputs"].push_back({{"path", input.path}, {"sha256", input.sha256}});
  for (const TurnedJoint& joint : report.joints) json["joints"].push_back(joint_of(joint));
  if (report.glide) json["glide"] = glide_of(*report.glide);
  if (Json seconds = seconds_of(report.seconds); !seconds.empty()) json["seconds"] = seconds;
  json["peak_memory_mb"] = std::round(peak_memory_mb() * 10) / 10;
  if (report.metrics) json["tissues"] = tissue_rows(report);
  if (report.metrics || report.deform) json["total"] = total(report);
  if (report.metrics && report.metrics->has_skin)
    json["skin"] = {{"surface_share_before", report.metrics->skin_share_before},
                    {"surface_share_after", report.metrics->skin_share_after}};
  if (report.deform && !report.deform->bones.empty())
    for (const auto& bone : report.deform->bones)
      json["bones"].push_back({{"name", bone.name}, {"rigid_residual_mm", bone.rigid_residual_mm}});
  add_body(report, json);
  if (report.deform && report.deform->settled) json["settled_flesh"] = settled_of(*report.deform->settled);
  if (report.deform)
    for (const BakedJointReport& joint : report.deform->baked) json["baked_joints"].push_back(baked_of(joint));
  if (report.deform)
    for (const auto& [label, voxels] : report.deform->kept_organs) json["kept_organs"][key_of(report, label)] = voxels;
  if (report.deform && report.deform->mass_exact)
    json["mass_exact"] = mass_exact_of(report, *report.deform->mass_exact);
  if (report.deform && report.deform->mesh) json["mesh"] = mesh_of(report, *report.deform->mesh);
  if (report.deform && report.deform->solve) json["solve"] = solve_of(*report.deform->solve);
  if (report.deform)
    for (const ObjectReport& object : report.deform->objects) json["objects"].push_back(object_of(object));
  if (!report.warnings.empty()) json["warnings"] = report.warnings;
  for (const QualityGate& gate : report.gates) json["gates"].push_back(gate_of(gate));
  // Replaces bytes that are not UTF-8, for example in a name, since dump() would throw otherwise.
  return json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

double method_seconds(const std::string& report) {
  const Json json = Json::parse(sound_json(report), nullptr, false);
  double sum = 0;
  if (const auto seconds = json.find("seconds"); seconds != json.end() && seconds->is_object())
    for (const char* stage : {"deform", "mesh", "solve", "rasterize"})
      if (const auto took = seconds->find(stage); took != seconds->end() && took->is_number())
        sum += took->get<double>();
  return sum;
}

void write_report(const Report& report, const Path& path) { write_file_atomically(path, to_json(report)); }

}  // namespace limber
