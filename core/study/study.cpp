// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/study/study.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <set>

#include <nlohmann/json.hpp>

#include "core/base/error.h"
#include "core/batch/description.h"

namespace limber {

namespace {
using Json = nlohmann::ordered_json;

constexpr std::size_t kMostCells = 100000;
constexpr int kMostRepeats = 1000;

// The techniques (ways of posing) that a study compares if its description names none.
const std::vector<std::string> kUsualTechniques = {"lbs", "dqs", "fem", "fem-contact"};

void read_body(const Description& description, Study& study) {
  const DescribedBody body = read_described_body(description, "a study");
  study.phantom = body.phantom;
  study.volume = body.volume;
  study.rig = body.rig;
  study.tissues = body.tissues;
  study.bones = body.bones;
}

QualityLimits read_gates(const Description& gates) {
  gates.check_keys(
      {"tissue_percent", "least_voxels", "bone_residual_mm", "skin_share_percent", "joint_excess_degrees"});
  QualityLimits limits = Study().gates;
  const auto take = [&](const char* key, auto& limit) {
    if (const auto number = gates.number(key, 0, 1e9))
      limit = static_cast<std::remove_reference_t<decltype(limit)>>(*number);
  };
  take("tissue_percent", limits.tissue_percent);
  take("least_voxels", limits.least_voxels);
  take("bone_residual_mm", limits.bone_residual_mm);
  take("skin_share_percent", limits.skin_share_percent);
  take("joint_excess_degrees", limits.joint_excess_degrees);
  return limits;
}

void read_cells(const Description& description, Study& study) {
  const bool is_phantom = !study.phantom.empty();
  std::vector<std::string> texts;
  for (const Description& one : description.list("spacings_mm")) {
    study.spacings.push_back(one.is_null() ? std::optional<double>()
                                           : one.as_number(is_phantom ? 0.5 : 1e-3, is_phantom ? 10 : 1e3));
    texts.push_back(study.spacings.back() ? std::to_string(*study.spacings.back()) : "");
  }
  check_distinct(description, "spacings_mm", std::move(texts));
  if (study.spacings.empty()) study.spacings = {std::nullopt};
  study.poses = read_described_poses(description, "study");
  study.techniques = read_techniques(description, kUsualTechniques);
  if (study.spacings.size() * study.poses.size() * study.techniques.size() > kMostCells)
    description.refuse("the study has too many cells", "split it into several studies");
}

void read_volumes(const Description& description, Study& study) {
  for (const Description& one : description.list("volumes")) {
    one.check_keys({"spacing_mm", "volume"});
    const auto spacing = one.number("spacing_mm", 1e-3, 1e3);
    if (!spacing || !one.has("volume"))
      one.refuse("an entry of \"volumes\" needs a spacing and a file", "give both: spacing_mm and volume");
    if (!study.phantom.empty()) one.refuse("a phantom has no volume files", "leave out \"volumes\"");
    if (!study.ready.emplace(*spacing, one.file("volume")).second)
      one.refuse("the spacing occurs twice", "leave out one of the two volumes");
  }
}

// Returns the volume files in the folder (man-arm-2mm.mha, man-arm-3mm.nrrd, ...), keyed by the spacing (mm) in their
// names.
std::map<double, Path> real_arms(const Path& folder) {
  std::map<double, Path> arms;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    double spacing = 0;
    int end = 0;
    if (std::sscanf(name.c_str(), "man-arm-%lfmm.%n", &spacing, &end) != 1 || end == 0 || !(spacing > 0)) continue;
    const std::string ending = name.substr(end);
    if (ending == "mha" || ending == "mhd" || ending == "nrrd" || ending == "nii" || ending == "nii.gz")
      arms.emplace(spacing, entry.path());
  }
  return arms;
}

}  // namespace

// Returns the colour and mark of a technique. There are five looks, in a fixed order, so that techniques look alike on
// all pages. Techniques beyond the fifth share colours and marks with earlier ones.
TechniqueLook look_of(const Technique& technique) {
  std::vector<std::string> order = {"lbs", "dqs", "fem", "fem-contact", "mix"};
  for (const Technique& one : plain_techniques())
    if (!std::count(order.begin(), order.end(), word_of(one))) order.push_back(word_of(one));
  const auto at = std::find(order.begin(), order.end(), word_of(technique.plain()));
  return {static_cast<int>(at - order.begin()) % kLooks, technique.mass_exact};
}

std::string spacing_text(const std::optional<double>& spacing) {
  if (!spacing) return "as given";
  char text[40];
  std::snprintf(text, sizeof text, "%g mm", *spacing);
  return text;
}

Study read_study(const Path& path) {
  const Description description(path, "study");
  description.check_keys({"name", "volume", "phantom", "rig", "tissues", "bones", "weights", "spacings_mm", "poses",
                          "methods", "quality", "fit_joints", "nearest", "gates", "repeats", "volumes"});
  Study study{.name = description.text("name", path.stem().string()), .description = path};
  read_body(description, study);
  read_cells(description, study);
  study.weights = description.text("weights", study.weights, {"heat", "geodesic", "rigid"});
  study.quality = description.text("quality", study.quality, {"draft", "normal", "fine"});
  study.fit_joints = description.flag("fit_joints");
  study.nearest = read_nearest(description, study.techniques);
  if (const auto repeats = description.number("repeats", 1, kMostRepeats)) {
    study.repeats = static_cast<int>(*repeats);
    if (study.repeats != *repeats)
      description.refuse("this is not a whole number", "repeats", "write the number of repeats, such as 5");
  }
  read_volumes(description, study);
  if (description.has("gates")) study.gates = read_gates(description.object("gates"));
  return study;
}

Study paper_study(const Path& folder) {
  Study study{.name = "Elbow flexion of the arm", .spacings = {2.0, 3.0, 4.0}};
  if (folder.empty()) {
    study.phantom = "arm";
  } else {
    std::error_code error;
    if (!std::filesystem::is_directory(folder, error))
      throw Error("the folder does not exist", folder.string(),
                  "name the folder with man-arm-2mm.mha, or none for the procedural arm");
    study.ready = real_arms(folder);
    if (study.ready.empty())
      throw Error("there is no arm in the folder", folder.string(),
                  "put man-arm-2mm.mha there, or name no folder for the procedural arm");
    study.volume = study.ready.begin()->second;  // the volume with the finest spacing
    for (const char* rig : {"man-arm-2mm-armature.vtk", "Arm-armature.vtk"})
      if (study.rig.empty() && std::filesystem::exists(folder / rig)) study.rig = folder / rig;
    if (study.rig.empty())
      throw Error("the arm has no armature", folder.string(), "put man-arm-2mm-armature.vtk beside it");
    study.name = "Elbow flexion of the Visible Human arm";
    study.fit_joints = true;  // because flexion about the elbow of this rig would move bone into bone
  }
  for (const int degrees : {0, 45, 60, 90}) {
    const std::string text = "+" + std::to_string(degrees);
    study.poses.push_back({.name = text + "°",
                           .flex = degrees ? std::vector<std::string>{"Forearm=" + std::to_string(degrees)}
                                           : std::vector<std::string>{}});
  }
  study.techniques = techniques_of(kUsualTechniques, "");
  return study;
}

std::string to_json(const Study& study, const std::function<std::string(const Path&)>& name_of) {
  const auto name = [&](const Path& file) { return name_of ? name_of(file) : file.filename().string(); };
  Json json{{"name", study.name}};
  if (study.phantom.empty()) {
    json["volume"] = name(study.volume);
    for (const auto& [spacing, file] : study.ready)
      json["volumes"].push_back({{"spacing_mm", spacing}, {"volume", name(file)}});
    json["rig"] = name(study.rig);
  } else {
    json["phantom"] = study.phantom;
  }
  if (!study.tissues.empty()) json["tissues"] = name(study.tissues);
  if (!study.bones.empty()) json["bones"] = study.bones;
  json["weights"] = study.weights;
  for (const auto& spacing : study.spacings) json["spacings_mm"].push_back(spacing ? Json(*spacing) : Json());
  for (const DescribedPose& pose : study.poses) {
    Json row{{"name", pose.name}};
    if (!pose.flex.empty()) row["flex"] = pose.flex;
    if (!pose.body.name.empty()) row["pose_name"] = pose.body.name;
    if (!pose.body.joints.empty()) row["joints"] = pose.body.joints;
    for (const auto& [key, file] : {std::pair{"pose", &pose.pose}, {"motion", &pose.motion}, {"map", &pose.map}})
      if (!file->empty()) row[key] = name(*file);
    if (pose.frame) row["frame"] = *pose.frame;
    if (!pose.up.empty()) row["up"] = pose.up;
    json["poses"].push_back(row);
  }
  for (const Technique& technique : study.techniques) json["methods"].push_back(word_of(technique));
  json["quality"] = study.quality;
  json["fit_joints"] = study.fit_joints;
  json["nearest"] = study.nearest;
  json["repeats"] = study.repeats;
  json["gates"] = {{"tissue_percent", study.gates.tissue_percent},
                   {"least_voxels", study.gates.least_voxels},
                   {"bone_residual_mm", study.gates.bone_residual_mm},
                   {"skin_share_percent", study.gates.skin_share_percent},
                   {"joint_excess_degrees", study.gates.joint_excess_degrees}};
  return json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace limber
