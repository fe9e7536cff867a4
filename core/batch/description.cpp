// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/batch/description.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include <nlohmann/json.hpp>

#include "core/base/error.h"
#include "core/base/json_text.h"
#include "core/motion/bvh.h"
#include "core/motion/frame_range.h"
#include "core/pose/flex_request.h"

namespace limber {

namespace {
using Json = nlohmann::ordered_json;

constexpr std::uint64_t kLargestDescription = 1 << 20;
constexpr std::size_t kLongestName = 60;
constexpr std::size_t kMostPoses = 100000;

std::string joined(const std::set<std::string>& words) {
  std::string all;
  for (const std::string& one : words) all += (all.empty() ? "" : ", ") + one;
  return all;
}

const Json& json_of(const void* value) { return *static_cast<const Json*>(value); }
}  // namespace

struct Description::File {
  Path path;
  std::string what;
  Json json;
};

Description::Description(const Path& file, const std::string& what) {
  const std::string text = checked_json(read_file(file, kLargestDescription), file.string());
  file_ = std::make_shared<const File>(File{file, what, Json::parse(text, nullptr, false)});
  value_ = &file_->json;
  if (!is_object())
    refuse("this is not a description of a " + what,
           R"(write a JSON object: {"poses": [...], ...}, as the guide says)");
}
Description::Description(std::shared_ptr<const File> file, const void* value, std::string place)
    : file_(std::move(file)),
      value_(value),
      place_(std::move(place)) {}

std::string Description::where(const std::string& key) const {
  std::string all = file_->path.string();
  for (const std::string* part : {&place_, &key})
    if (!part->empty()) all += ", " + *part;
  return all;
}
void Description::refuse(const std::string& what, const std::string& what_to_do) const {
  throw Error(what, where(), what_to_do);
}
void Description::refuse(const std::string& what, const std::string& key, const std::string& what_to_do) const {
  throw Error(what, where(key), what_to_do);
}

bool Description::is_object() const { return json_of(value_).is_object(); }
bool Description::is_null() const { return json_of(value_).is_null(); }
bool Description::has(const std::string& key) const { return json_of(value_).contains(key); }

Description Description::at(const std::string& key) const {
  return {file_, &json_of(value_).at(key), place_.empty() ? key : place_ + ", " + key};
}

void Description::check_keys(const std::set<std::string>& known) const {
  for (const auto& [key, value] : json_of(value_).items())
    if (!known.contains(key)) refuse("a " + file_->what + " has no such key", key, "use: " + joined(known));
}

std::string Description::as_text() const {
  const Json& value = json_of(value_);
  if (!value.is_string() || value.get<std::string>().empty()) refuse("this should be text", R"(write "...")");
  return value.get<std::string>();
}

double Description::as_number(double least, double most) const {
  const Json& value = json_of(value_);
  const double number = value.is_number() ? value.get<double>() : NAN;
  char range[80];
  std::snprintf(range, sizeof range, "write a number from %g to %g", least, most);
  if (!(number >= least && number <= most)) refuse("this is not an allowed number", range);
  return number;
}

std::string Description::text(const std::string& key, const std::string& otherwise,
                              const std::set<std::string>& words) const {
  if (!has(key)) return otherwise;
  const std::string word = at(key).as_text();
  if (!words.empty() && !words.contains(word))
    refuse("\"" + word + "\" is not an allowed value", key, "use one of: " + joined(words));
  return word;
}

Path Description::file(const std::string& key) const {
  const std::string name = text(key);
  if (name.empty()) return {};
  const Path file = file_->path.parent_path() / name;
  std::error_code unreadable;  // set for a name that no file can have, such as one that is too long
  if (!std::filesystem::exists(file, unreadable))
    refuse("the file does not exist", key + ": " + file.string(), "give a path relative to the description's folder");
  return file;
}

std::optional<double> Description::number(const std::string& key, double least, double most) const {
  if (!has(key)) return {};
  return at(key).as_number(least, most);
}

bool Description::flag(const std::string& key) const {
  if (!has(key)) return false;
  const Json& value = json_of(at(key).value_);
  if (!value.is_boolean()) refuse("this should be true or false", key, "write \"" + key + "\": true");
  return value.get<bool>();
}

std::vector<Description> Description::list(const std::string& key) const {
  if (!has(key)) return {};
  const Json& value = json_of(at(key).value_);
  if (!value.is_array() || value.empty())
    refuse("this should be a list with at least one entry", key, "write \"" + key + "\": [...]");
  std::vector<Description> values;
  for (const Json& one : value)
    values.push_back(
        {file_, &one, (place_.empty() ? "" : place_ + ", ") + key + ", number " + std::to_string(values.size() + 1)});
  return values;
}

std::vector<std::string> Description::texts(const std::string& key) const {
  if (has(key) && json_of(at(key).value_).is_string()) return {at(key).as_text()};
  std::vector<std::string> all;
  for (const Description& one : list(key)) all.push_back(one.as_text());
  return all;
}

Description Description::object(const std::string& key) const {
  const Description value = at(key);
  if (!value.is_object()) value.refuse("this should be an object", "write \"" + key + "\": {...}");
  return value;
}

namespace {
// Reads a pose that is given by its name or by joint angles. Throws Error for an unknown name of a pose or joint,
// before hours of computing begin. A known joint that the rig lacks only makes the cells with this pose fail later.
PoseRequest read_body_request(const Description& value) {
  PoseRequest request{value.text("pose_name"), value.texts("joints")};
  if (!request.name.empty()) require_body_pose(request.name, value.where("pose_name"));
  JointAngles angles;
  for (const std::string& joint : request.joints) add_joint_request(angles, joint, value.where("joints"));
  return request;
}

void add_frames(const Description& value, const DescribedPose& pose, const std::string& frames,
                std::vector<DescribedPose>& poses) {
  const int count = read_bvh(pose.motion).frame_count;
  const std::string range = frames == "all" ? "0:" + std::to_string(std::max(count - 1, 0)) : frames;
  for (const int frame : frames_in(range, count, value.where("frames: " + frames))) {
    if (poses.size() >= kMostPoses) value.refuse("there are too many poses", "frames", "take fewer frames");
    DescribedPose one = pose;
    char number[16];
    std::snprintf(number, sizeof number, " %04d", frame);
    one.sequence = pose.name;
    one.name += number;
    one.frame = frame;
    poses.push_back(std::move(one));
  }
}

void add_pose(const Description& value, std::vector<DescribedPose>& poses) {
  if (!value.is_object())
    value.refuse("a pose must be a JSON object", R"(write {"name": "+45", "flex": ["Forearm=45"]})");
  value.check_keys({"name", "flex", "pose_name", "joints", "pose", "motion", "map", "frame", "frames", "up"});
  if (!value.has("name")) value.refuse("a pose needs a name", R"(write {"name": "+45", "flex": ["Forearm=45"]})");
  DescribedPose pose{.name = value.text("name")};
  if (pose.name.size() > kLongestName)
    value.refuse("the name is too long", "name", "write " + std::to_string(kLongestName) + " letters at most");
  pose.flex = value.texts("flex");
  for (const std::string& request : pose.flex) parse_flex_request(request, value.where("flex"));
  pose.body = read_body_request(value);
  pose.pose = value.file("pose");
  pose.motion = value.file("motion");
  pose.map = value.file("map");
  pose.up = value.text("up", "", {"y", "z", "auto"});
  if (const auto frame = value.number("frame", 0, 1e9)) {
    if (*frame != std::floor(*frame))
      value.refuse("a frame is a whole number", "frame", "write the frame's number, counted from 0");
    pose.frame = static_cast<int>(*frame);
  }
  const std::string frames = value.text("frames");
  if (!pose.body.name.empty() && !(pose.pose.empty() && pose.motion.empty()))
    value.refuse("a pose is given either by its name or by a pose or motion file",
                 "leave \"pose_name\" or the file out");
  if (!pose.pose.empty() && !pose.motion.empty())
    value.refuse("a pose is given either by a file or by a motion", "leave \"pose\" or \"motion\" out");
  if (pose.motion.empty() && (pose.frame || !frames.empty() || !pose.map.empty() || !pose.up.empty()))
    value.refuse("frame, frames, map and up need a motion", "add \"motion\": FILE");
  if (pose.frame && !frames.empty())
    value.refuse("a pose has either one frame or several", "leave \"frame\" or \"frames\" out");
  if (frames.empty()) poses.push_back(std::move(pose));
  else add_frames(value, pose, frames, poses);
}
}  // namespace

std::vector<DescribedPose> read_described_poses(const Description& description, const std::string& what) {
  if (!description.has("poses"))
    description.refuse("the " + what + " has no poses", R"(add "poses": [{"name": "+45", "flex": ["Forearm=45"]}])");
  std::vector<DescribedPose> poses;
  for (const Description& one : description.list("poses")) add_pose(one, poses);
  std::vector<std::string> names;
  for (const DescribedPose& pose : poses) names.push_back(pose.name);
  check_distinct(description, "poses, name", std::move(names));
  return poses;
}

std::vector<Technique> read_techniques(const Description& description, const std::vector<std::string>& otherwise) {
  const std::vector<std::string> words = description.texts("methods");
  return techniques_of(words.empty() ? otherwise : words, description.where("methods"));
}

DescribedBody read_described_body(const Description& description, const std::string& whose) {
  DescribedBody body;
  body.phantom = description.text("phantom", "", {"arm", "body"});
  body.volume = description.file("volume");
  body.rig = description.file("rig");
  body.tissues = description.file("tissues");
  if (body.phantom.empty() == body.volume.empty())
    description.refuse(whose + " needs exactly one body", "give \"volume\": FILE, or \"phantom\": \"arm\"");
  if (!body.phantom.empty() && (!body.rig.empty() || !body.tissues.empty() || description.has("bones")))
    description.refuse("a phantom has its own rig and tissues", "phantom",
                       "leave \"rig\", \"tissues\" and \"bones\" out");
  if (!body.volume.empty() && body.rig.empty()) description.refuse("a volume needs a rig", "rig", "add \"rig\": FILE");
  for (const Description& one : description.list("bones")) body.bones.push_back(one.as_number(0, 9e15));
  return body;
}

bool read_nearest(const Description& description, const std::vector<Technique>& techniques) {
  const bool nearest = description.flag("nearest");
  if (nearest && std::any_of(techniques.begin(), techniques.end(),
                             [](const Technique& technique) { return technique.mass_exact; }))
    description.refuse("mass-exact techniques need interpolated labels, which \"nearest\" does not compute", "nearest",
                       "leave out \"nearest\" or the mass-exact techniques");
  return nearest;
}

void check_distinct(const Description& description, const std::string& key, std::vector<std::string> values) {
  std::sort(values.begin(), values.end());
  if (std::adjacent_find(values.begin(), values.end()) != values.end())
    description.refuse("a value occurs twice", key, "name each value once");
}

}  // namespace limber
