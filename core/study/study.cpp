// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/study/study.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <set>

#include <nlohmann/json.hpp>

#include "core/base/error.h"
#include "core/base/json_text.h"
#include "core/pose/flex_request.h"

namespace limber {

namespace {
using Json = nlohmann::ordered_json;

constexpr std::uint64_t kLargestDescription = 1 << 20;
constexpr std::size_t kMostCells = 100000;
constexpr std::size_t kLongestName = 60;

constexpr const char* kExactWord = "-mass-exact";

// Returns the techniques (ways of posing) that a study compares if its description names none.
std::vector<Technique> usual_techniques() { return techniques_of({"lbs", "dqs", "fem", "fem-contact"}, ""); }

// Reads values of a study's description. Throws Error for a wrong value, with its key in the message.
class Reader {
 public:
  Reader(const Path& path) : path_(path) {}

  [[noreturn]] void refuse(const std::string& what, const std::string& key, const std::string& what_to_do) const {
    throw Error(what, path_.string() + (key.empty() ? "" : ", " + key), what_to_do);
  }
  void check_keys(const Json& object, const std::string& where, const std::set<std::string>& known) const {
    for (const auto& [key, value] : object.items())
      if (!known.contains(key)) {
        std::string all;
        for (const std::string& one : known) all += (all.empty() ? "" : ", ") + one;
        refuse("a study has no such key", where.empty() ? key : where + ", " + key, "use: " + all);
      }
  }
  std::string text(const Json& value, const std::string& key) const {
    if (!value.is_string() || value.get<std::string>().empty())
      refuse("this should be text", key, "write \"" + key + "\": \"...\"");
    return value.get<std::string>();
  }
  std::string text(const Json& object, const std::string& key, const std::string& otherwise,
                   const std::set<std::string>& words = {}) const {
    if (!object.contains(key)) return otherwise;
    const std::string word = text(object[key], key);
    if (!words.empty() && !words.contains(word)) {
      std::string all;
      for (const std::string& one : words) all += (all.empty() ? "" : ", ") + one;
      refuse("\"" + word + "\" is none of its words", key, "use one of: " + all);
    }
    return word;
  }
  Path file(const Json& object, const std::string& key) const {
    const std::string name = text(object, key, "");
    if (name.empty()) return {};
    const Path file = path_.parent_path() / name;
    if (!std::filesystem::exists(file))
      refuse("the file does not exist", key + ": " + file.string(), "paths are relative to the description");
    return file;
  }
  double number(const Json& value, const std::string& key, double least, double most) const {
    const double number = value.is_number() ? value.get<double>() : NAN;
    char range[80];
    std::snprintf(range, sizeof range, "write a number from %g to %g", least, most);
    if (!(number >= least && number <= most)) refuse("this is no number that it can have", key, range);
    return number;
  }
  bool flag(const Json& object, const std::string& key) const {
    if (!object.contains(key)) return false;
    if (!object[key].is_boolean()) refuse("this should be true or false", key, "write \"" + key + "\": true");
    return object[key].get<bool>();
  }
  const Json& list(const Json& value, const std::string& key) const {
    if (!value.is_array() || value.empty())
      refuse("this should be a list with something in it", key, "write \"" + key + "\": [...]");
    return value;
  }

  // Returns the texts under a key, whose value may be one text or a list of texts. Returns an empty list if the key is
  // absent.
  std::vector<std::string> texts(const Json& value, const char* key, const std::string& where) const {
    if (!value.contains(key)) return {};
    if (value[key].is_string()) return {text(value[key], key)};
    std::vector<std::string> all;
    for (const Json& one : list(value[key], where + ", " + key)) all.push_back(text(one, key));
    return all;
  }

  // Reads a pose that is given by its name or by joint angles. Throws Error for an unknown name of a pose or joint,
  // before hours of computing begin. A known joint that the rig lacks only makes the cells with this pose fail later.
  PoseRequest body_request(const Json& value, const std::string& where) const {
    PoseRequest request{text(value, "pose_name", ""), texts(value, "joints", where)};
    if (!request.name.empty()) require_body_pose(request.name, path_.string() + ", " + where + ", pose_name");
    JointAngles angles;
    for (const std::string& joint : request.joints)
      add_joint_request(angles, joint, path_.string() + ", " + where + ", joints");
    return request;
  }

  StudyPose pose(const Json& value, size_t number) const {
    const std::string where = "poses, number " + std::to_string(number + 1);
    if (!value.is_object()) refuse("a pose is an object", where, R"(write {"name": "+45", "flex": ["Forearm=45"]})");
    check_keys(value, where, {"name", "flex", "pose_name", "joints", "pose", "motion", "map", "frame", "up"});
    if (!value.contains("name"))
      refuse("a pose needs a name", where, R"(write {"name": "+45", "flex": ["Forearm=45"]})");
    StudyPose pose{.name = text(value["name"], "name")};
    if (pose.name.size() > kLongestName)
      refuse("the name is too long", where + ", name", "write " + std::to_string(kLongestName) + " letters at most");
    pose.flex = texts(value, "flex", where);
    for (const std::string& request : pose.flex) parse_flex_request(request, path_.string() + ", " + where + ", flex");
    pose.body = body_request(value, where);
    pose.pose = file(value, "pose");
    pose.motion = file(value, "motion");
    pose.map = file(value, "map");
    pose.up = text(value, "up", "", {"y", "z", "auto"});
    if (value.contains("frame")) pose.frame = static_cast<int>(number_of_frame(value["frame"], where));
    if (!pose.body.name.empty() && !(pose.pose.empty() && pose.motion.empty()))
      refuse("a pose comes by its name or from a file", where, "leave \"pose_name\" or the file out");
    if (!pose.pose.empty() && !pose.motion.empty())
      refuse("a pose comes from a file or from a motion", where, "leave \"pose\" or \"motion\" out");
    if (pose.motion.empty() && (pose.frame || !pose.map.empty() || !pose.up.empty()))
      refuse("frame, map and up are of a motion", where, "add \"motion\": FILE");
    return pose;
  }

  std::vector<Technique> techniques(const std::vector<std::string>& words) const {
    return techniques_of(words, path_.string() + ", methods");
  }

  QualityLimits gates(const Json& value) const {
    QualityLimits limits;
    if (!value.is_object()) refuse("this should be an object", "gates", R"(write "gates": {"tissue_percent": 1})");
    check_keys(value, "gates",
               {"tissue_percent", "least_voxels", "bone_residual_mm", "skin_share_percent", "joint_excess_degrees"});
    const auto take = [&](const char* key, auto& limit) {
      if (value.contains(key))
        limit = static_cast<std::remove_reference_t<decltype(limit)>>(
            number(value[key], std::string("gates, ") + key, 0, 1e9));
    };
    take("tissue_percent", limits.tissue_percent);
    take("least_voxels", limits.least_voxels);
    take("bone_residual_mm", limits.bone_residual_mm);
    take("skin_share_percent", limits.skin_share_percent);
    take("joint_excess_degrees", limits.joint_excess_degrees);
    return limits;
  }

 private:
  double number_of_frame(const Json& value, const std::string& where) const {
    if (!value.is_number_integer()) refuse("a frame is a whole number", where + ", frame", "frames count from 0");
    return number(value, where + ", frame", 0, 1e9);
  }
  const Path& path_;
};

void read_body(const Reader& read, const Json& json, Study& study) {
  study.phantom = read.text(json, "phantom", "", {"arm", "body"});
  study.volume = read.file(json, "volume");
  study.rig = read.file(json, "rig");
  study.tissues = read.file(json, "tissues");
  if (study.phantom.empty() == study.volume.empty())
    read.refuse("a study is of one body", "", "give \"volume\": FILE, or \"phantom\": \"arm\"");
  if (!study.phantom.empty() && (!study.rig.empty() || !study.tissues.empty() || json.contains("bones")))
    read.refuse("a phantom has its own rig and tissues", "phantom", "leave \"rig\", \"tissues\" and \"bones\" out");
  if (!study.volume.empty() && study.rig.empty()) read.refuse("a volume needs a rig", "rig", "add \"rig\": FILE");
  if (json.contains("bones"))
    for (const Json& one : read.list(json["bones"], "bones")) study.bones.push_back(read.number(one, "bones", 0, 9e15));
}

void read_cells(const Reader& read, const Json& json, Study& study) {
  const bool is_phantom = !study.phantom.empty();
  if (json.contains("spacings_mm"))
    for (const Json& one : read.list(json["spacings_mm"], "spacings_mm"))
      study.spacings.push_back(one.is_null()
                                   ? std::optional<double>()
                                   : read.number(one, "spacings_mm", is_phantom ? 0.5 : 1e-3, is_phantom ? 10 : 1e3));
  else study.spacings = {std::nullopt};
  if (!json.contains("poses"))
    read.refuse("the study has no poses", "", R"(add "poses": [{"name": "+45", "flex": ["Forearm=45"]}])");
  for (const Json& one : read.list(json["poses"], "poses")) study.poses.push_back(read.pose(one, study.poses.size()));
  if (json.contains("methods")) {
    std::vector<std::string> words;
    for (const Json& one : read.list(json["methods"], "methods")) words.push_back(read.text(one, "methods"));
    study.techniques = read.techniques(words);
  } else {
    study.techniques = usual_techniques();
  }

  const auto check_distinct = [&](auto values, const char* key) {
    std::sort(values.begin(), values.end());
    if (std::adjacent_find(values.begin(), values.end()) != values.end())
      read.refuse("something stands there twice", key, "name each once");
  };
  check_distinct(study.spacings, "spacings_mm");
  std::vector<std::string> names;
  for (const StudyPose& pose : study.poses) names.push_back(pose.name);
  check_distinct(names, "poses, name");
  if (study.spacings.size() * study.poses.size() * study.techniques.size() > kMostCells)
    read.refuse("the study has too many cells", "", "split it into several studies");
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

std::vector<Technique> plain_techniques() {
  std::vector<Technique> all;
  for (const DeformationMethod& method : deformation_methods()) all.push_back({method.word});
  all.push_back({std::string(kFiniteElements), true});
  return all;
}

std::string technique_words() {
  std::string words;
  for (const Technique& technique : plain_techniques()) words += (words.empty() ? "" : ", ") + word_of(technique);
  return words;
}

std::string word_of(const Technique& technique) {
  return technique.method + (technique.contact ? "-contact" : "") + (technique.mass_exact ? kExactWord : "");
}
std::string title_of(const Technique& technique) {
  return find_method(technique.method)->name + (technique.contact ? " with contact" : "") +
         (technique.mass_exact ? ", mass-exact" : "");
}

std::vector<Technique> techniques_of(const std::vector<std::string>& words, const std::string& where) {
  std::vector<Technique> known = plain_techniques();
  for (const Technique& technique : plain_techniques()) known.push_back({technique.method, technique.contact, true});

  std::vector<Technique> techniques;
  for (const std::string& word : words) {
    const auto found =
        std::find_if(known.begin(), known.end(), [&](const Technique& one) { return word_of(one) == word; });
    if (found == known.end())
      throw Error("there is no such method: " + word, where,
                  "use " + technique_words() + ", or one of them with " + kExactWord + " behind it");
    if (std::count(techniques.begin(), techniques.end(), *found))
      throw Error("something stands there twice", where, "name each once");
    techniques.push_back(*found);
  }
  return techniques;
}

// Returns the colour and mark of a technique. There are five of them, in a fixed order, so that techniques look alike
// on all pages. Techniques beyond the fifth share colours and marks with earlier ones.
TechniqueLook look_of(const Technique& technique) {
  std::vector<std::string> order = {"lbs", "dqs", "fem", "fem-contact", "mix"};
  for (const Technique& one : plain_techniques())
    if (!std::count(order.begin(), order.end(), word_of(one))) order.push_back(word_of(one));
  const auto at = std::find(order.begin(), order.end(), word_of(technique.plain()));
  return {static_cast<int>(at - order.begin()) % kLooks, technique.mass_exact};
}

std::string spacing_text(const std::optional<double>& spacing) {
  if (!spacing) return "as it is";
  char text[40];
  std::snprintf(text, sizeof text, "%g mm", *spacing);
  return text;
}

Study read_study(const Path& path) {
  const Reader read(path);
  const Json json = Json::parse(checked_json(read_file(path, kLargestDescription), path.string()), nullptr, false);
  if (!json.is_object())
    read.refuse("this is no description of a study", "",
                R"(write a JSON object: {"volume": FILE, "rig": FILE, "poses": [...]})");
  read.check_keys(json, "",
                  {"name", "volume", "phantom", "rig", "tissues", "bones", "weights", "spacings_mm", "poses", "methods",
                   "quality", "fit_joints", "nearest", "gates"});
  Study study{.name = read.text(json, "name", path.stem().string()), .description = path};
  read_body(read, json, study);
  read_cells(read, json, study);
  study.weights = read.text(json, "weights", study.weights, {"heat", "geodesic", "rigid"});
  study.quality = read.text(json, "quality", study.quality, {"draft", "normal", "fine"});
  study.fit_joints = read.flag(json, "fit_joints");
  study.nearest = read.flag(json, "nearest");
  if (study.nearest && std::any_of(study.techniques.begin(), study.techniques.end(),
                                   [](const Technique& technique) { return technique.mass_exact; }))
    read.refuse("masses are made exact by what a voxel is nearly, which \"nearest\" does not ask", "nearest",
                "leave one of the two out");
  if (json.contains("gates")) study.gates = read.gates(json["gates"]);
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
  study.techniques = usual_techniques();
  return study;
}

std::string to_json(const Study& study) {
  Json json{{"name", study.name}};
  if (study.phantom.empty()) {
    json["volume"] = study.volume.filename().string();
    json["rig"] = study.rig.filename().string();
  } else {
    json["phantom"] = study.phantom;
  }
  if (!study.tissues.empty()) json["tissues"] = study.tissues.filename().string();
  if (!study.bones.empty()) json["bones"] = study.bones;
  json["weights"] = study.weights;
  for (const auto& spacing : study.spacings) json["spacings_mm"].push_back(spacing ? Json(*spacing) : Json());
  for (const StudyPose& pose : study.poses) {
    Json row{{"name", pose.name}};
    if (!pose.flex.empty()) row["flex"] = pose.flex;
    if (!pose.body.name.empty()) row["pose_name"] = pose.body.name;
    if (!pose.body.joints.empty()) row["joints"] = pose.body.joints;
    for (const auto& [key, file] : {std::pair{"pose", &pose.pose}, {"motion", &pose.motion}, {"map", &pose.map}})
      if (!file->empty()) row[key] = file->filename().string();
    if (pose.frame) row["frame"] = *pose.frame;
    if (!pose.up.empty()) row["up"] = pose.up;
    json["poses"].push_back(row);
  }
  for (const Technique& technique : study.techniques) json["methods"].push_back(word_of(technique));
  json["quality"] = study.quality;
  json["fit_joints"] = study.fit_joints;
  json["nearest"] = study.nearest;
  json["gates"] = {{"tissue_percent", study.gates.tissue_percent},
                   {"least_voxels", study.gates.least_voxels},
                   {"bone_residual_mm", study.gates.bone_residual_mm},
                   {"skin_share_percent", study.gates.skin_share_percent},
                   {"joint_excess_degrees", study.gates.joint_excess_degrees}};
  return json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace limber
