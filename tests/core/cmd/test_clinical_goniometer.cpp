// SPDX-License-Identifier: AGPL-3.0-or-later
// Compares the clinical angles that `limber resample` was asked for with those that an independent goniometer measures
// on the bones of the posed volume: in 40 poses of four bodies, each angle must agree within one degree.
#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include <doctest/doctest.h>
#include <glm/gtc/quaternion.hpp>
#include <nlohmann/json.hpp>

#include "core/rig_io/rig_io.h"
#include "core/volume_io/tissue_table_io.h"
#include "core/volume_io/volume_io.h"
#include "tests/support/goniometer.h"
#include "tests/support/program.h"
#include "tests/support/shared_data.h"

using namespace limber;
using namespace limber::test;

namespace {

constexpr double kTolerance = 1;  // largest difference between measured and requested angle, degrees

using Json = nlohmann::json;

// The names of the rig bones that the goniometer measures. "@" in a name stands for the side.
struct BodyNames {
  std::string upper_arm, forearm, hand, thigh, shank, foot, index, little;
};

struct GoniometerBody {
  std::string volume, rig_file, tissues;  // paths of files
  Armature rig;
  BodyNames names;
  // Rig bone -> names of the labels that hold its bones. For a rig bone that is not listed, the goniometer takes the
  // voxels of all bone labels around its middle.
  std::map<std::string, std::vector<std::string>> bones;
  std::map<std::string, double> file_values;                  // label name -> its value in the file
  std::map<std::string, std::vector<std::string>> carried{};  // rig bone -> rig bones that move rigidly with it
};

std::string replaced_side(std::string name, double out) {
  if (const auto at = name.find('@'); at != name.npos) name.replace(at, 1, out > 0 ? "Left" : "Right");
  return name;
}

// Registers points from three starts that differ by 6 degrees and 5 mm from the program's own answer, so that the
// result does not depend on that answer. Returns the best of the three.
Registration searched_from_afar(const std::vector<glm::dvec3>& rest, const std::vector<glm::dvec3>& posed,
                                const Registration& told, double spacing) {
  glm::dvec3 middle(0);
  for (const glm::dvec3& point : rest) middle += point / double(rest.size());
  Registration best{.residual_mm = 1e9};
  for (const glm::dvec3& axis : {glm::dvec3(2, -1, 1.5), glm::dvec3(-1, -2, 1), glm::dvec3(-1, 1.5, -2)}) {
    const glm::dmat3 off = glm::mat3_cast(glm::angleAxis(glm::radians(6.0), glm::normalize(axis)));
    const glm::dvec3 place =
        told.rotation * middle + told.shift + 5.0 * glm::normalize(glm::dvec3(axis.y, axis.z, axis.x));
    const Registration found =
        register_points(rest, posed, {off * told.rotation, place - off * told.rotation * middle}, spacing);
    if (found.residual_mm < best.residual_mm) best = found;
  }
  return best;
}

class Goniometer {
 public:
  explicit Goniometer(const GoniometerBody& body) : body_(body), rest_(read_volume(body.volume)) {
    if (!body.tissues.empty()) rest_.tissues = tissues_of(rest_);
  }

  // Poses the body and reads the posed volume.
  void pose(const std::vector<std::string>& joints) {
    std::vector<std::string> words;
    for (const std::string& joint : joints) words.insert(words.end(), {"--joint", joint});
    std::vector<std::string> fk{"fk", body_.rig_file, "--json"};
    fk.insert(fk.end(), words.begin(), words.end());
    const ProgramRun told = run_limber(fk);
    REQUIRE(told.exit_code == 0);
    told_ = Json::parse(told.out)["joints"];
    std::vector<std::string> resample{
        "resample", body_.volume, "--rig", body_.rig_file, "--weights",
        weights(),  "--method",   "lbs",   "-o",           (folder_ / "posed.nrrd").string()};
    if (!body_.tissues.empty()) resample.insert(resample.end(), {"--tissues", body_.tissues});
    resample.insert(resample.end(), words.begin(), words.end());
    const ProgramRun run = run_limber(resample);
    INFO(run.err);
    REQUIRE(run.exit_code == 0);
    posed_ = read_volume((folder_ / "posed.nrrd").string());
    turns_.clear();
    surfaces_.clear();
  }

  // Returns the rotation of a rig bone from rest, measured by the voxels of its own bones.
  const glm::dmat3& turn_of(const std::string& bone) {
    const auto known = turns_.find(bone);
    if (known != turns_.end()) return known->second;
    const std::vector<glm::dvec3> points = rest_points(bone);
    REQUIRE_MESSAGE(points.size() > 30, bone);
    const std::set<double> values = values_of(bone);
    auto& surface = surfaces_[values];
    if (surface.empty()) surface = surface_of_labels(posed_.volume, labels_of(posed_, values));
    const auto b = static_cast<std::size_t>(require_bone(body_.rig, bone));
    const Json& told = told_[b];
    const std::vector<double> q = told["rotation_wxyz"], p = told["position"];
    Registration start;
    start.rotation = glm::mat3_cast(glm::dquat(q[0], q[1], q[2], q[3]));
    start.shift = glm::dvec3(p[0], p[1], p[2]) - start.rotation * body_.rig.bones[b].head;
    const Registration found = searched_from_afar(points, surface, start, rest_.volume.grid.spacing.x);
    CHECK_MESSAGE(found.residual_mm < 1.2 * rest_.volume.grid.spacing.x, bone);
    return turns_[bone] = found.rotation;
  }

  // Returns the posed direction from the head of bone `from` to the head of bone `to`. Both heads are turned with the
  // bone `carrier`, or with `from` if it is empty.
  glm::dvec3 line(const std::string& from, const std::string& to, const std::string& carrier = "") {
    const auto head = [&](const std::string& bone) {
      return body_.rig.bones[static_cast<std::size_t>(require_bone(body_.rig, bone))].head;
    };
    return turn_of(carrier.empty() ? from : carrier) * (head(to) - head(from));
  }

  LimbAngles arm(double out, bool raised = false) {
    return limb_angles(line(side(body_.names.upper_arm, out), side(body_.names.forearm, out)),
                       line(side(body_.names.forearm, out), side(body_.names.hand, out)), out, -1, raised);
  }
  LimbAngles leg(double out) {
    return limb_angles(line(side(body_.names.thigh, out), side(body_.names.shank, out)),
                       line(side(body_.names.shank, out), side(body_.names.foot, out)), out, 1);
  }
  double pronation(double out) {
    return pronation_angle(
        line(side(body_.names.upper_arm, out), side(body_.names.forearm, out)),
        line(side(body_.names.forearm, out), side(body_.names.hand, out)),
        line(side(body_.names.index, out), side(body_.names.little, out), side(body_.names.hand, out)), out);
  }

  const GoniometerBody& body() const { return body_; }

 private:
  static std::string side(const std::string& name, double out) { return replaced_side(name, out); }

  TissueTable tissues_of(const VolumeFile&) const { return read_tissue_table(body_.tissues); }

  std::string weights() {
    const std::string file = (folder_ / "weights.nrrd").string();
    if (std::filesystem::exists(file)) return file;
    std::vector<std::string> words{"weights", body_.volume, "--rig", body_.rig_file, "-o", file};
    if (!body_.tissues.empty()) words.insert(words.end(), {"--tissues", body_.tissues});
    const ProgramRun run = run_limber(words);
    INFO(run.err);
    REQUIRE(run.exit_code == 0);
    return file;
  }

  // Returns the values, in files, of the labels that hold a rig bone's bones.
  std::set<double> values_of(const std::string& bone) const {
    std::set<double> values;
    const auto own = body_.bones.find(bone);
    if (own != body_.bones.end())
      for (const std::string& name : own->second) values.insert(body_.file_values.at(name));
    else
      for (const Tissue& tissue : rest_.tissues.tissues)
        if (is_bone(tissue.kind)) values.insert(tissue.file_value);
    return values;
  }

  static std::set<Label> labels_of(const VolumeFile& file, const std::set<double>& values) {
    std::set<Label> labels;
    for (const double value : values)
      if (const Tissue* tissue = file.tissues.find_file_value(value)) labels.insert(tissue->label);
    return labels;
  }

  std::vector<glm::dvec3> rest_points(const std::string& name) {
    const std::vector<glm::dvec3> all = surface_of_labels(rest_.volume, labels_of(rest_, values_of(name)));
    if (body_.bones.contains(name)) return all;
    std::vector<std::size_t> own{static_cast<std::size_t>(require_bone(body_.rig, name))};
    if (const auto carried = body_.carried.find(name); carried != body_.carried.end())
      for (const std::string& one : carried->second)
        own.push_back(static_cast<std::size_t>(require_bone(body_.rig, one)));
    std::vector<glm::dvec3> points;
    for (const glm::dvec3& p : all)
      if (const auto& bones = body_.rig.bones; is_around_middle(bones[nearest_bone(p)], p) &&
                                               std::find(own.begin(), own.end(), nearest_bone(p)) != own.end())
        points.push_back(p);
    return points;
  }

  std::size_t nearest_bone(const glm::dvec3& p) const {
    const auto& bones = body_.rig.bones;
    return static_cast<std::size_t>(std::min_element(bones.begin(), bones.end(),
                                                     [&](const Bone& a, const Bone& b) {
                                                       return distance_to_bone(a, p) < distance_to_bone(b, p);
                                                     }) -
                                    bones.begin());
  }

  // Returns true if p lies in the middle part of a bone, away from its joints and from the bones beside it.
  static bool is_around_middle(const Bone& bone, const glm::dvec3& p) {
    const glm::dvec3 along = bone.tail - bone.head;
    const double share = glm::dot(p - bone.head, along) / glm::dot(along, along);
    return share > 0.15 && share < 0.85 && distance_to_bone(bone, p) < 0.12 * glm::length(along) + 10;
  }

  const GoniometerBody& body_;
  VolumeFile rest_, posed_;
  TemporaryFolder folder_;
  Json told_;
  std::map<std::string, glm::dmat3> turns_;
  std::map<std::set<double>, std::vector<glm::dvec3>> surfaces_;
};

// Compares one measured angle with the angle that was asked for.
void expect(const std::string& what, double measured, double asked) {
  CHECK_MESSAGE(std::abs(measured - asked) <= kTolerance, what, ": asked ", asked, ", measured ", measured);
  static const char* log = std::getenv("LIMBER_GONIOMETER_LOG");
  if (log) std::ofstream(log, std::ios::app) << what << '\t' << asked << '\t' << measured << '\n';
}

struct Asked {
  double flexion = 0, abduction = 0, rotation = 0, bend = 0;
};

void expect_limb(const std::string& what, const LimbAngles& measured, const Asked& asked) {
  INFO(what);
  expect("flexion", measured.flexion, asked.flexion);
  expect("abduction", measured.abduction, asked.abduction);
  expect("flexion of knee or elbow", measured.bend, asked.bend);
  if (asked.bend >= 30) expect("internal rotation", measured.rotation, asked.rotation);
}

// Measures ten poses of a body with arms and legs.
void measure_whole_body(const GoniometerBody& body, bool hands) {
  Goniometer goniometer(body);
  goniometer.pose({"left hip flexion=70", "left knee flexion=90"});
  expect_limb("left leg", goniometer.leg(1), {70, 0, 0, 90});
  goniometer.pose({"right hip abduction=30", "right hip internal rotation=20", "right knee flexion=60"});
  expect_limb("right leg", goniometer.leg(-1), {0, 30, 20, 60});
  goniometer.pose(
      {"left hip flexion=45", "left hip abduction=20", "left hip external rotation=25", "left knee flexion=80"});
  expect_limb("left leg", goniometer.leg(1), {45, 20, -25, 80});
  goniometer.pose({"right hip extension=20", "right hip adduction=5", "right knee flexion=15"});
  expect_limb("right leg", goniometer.leg(-1), {-20, -5, 0, 15});
  goniometer.pose({"hips flexion=100", "knees flexion=110"});
  expect_limb("left leg", goniometer.leg(1), {100, 0, 0, 110});
  expect_limb("right leg", goniometer.leg(-1), {100, 0, 0, 110});
  goniometer.pose({"left shoulder flexion=100", "left elbow flexion=60"});
  expect_limb("left arm", goniometer.arm(1), {100, 0, 0, 60});
  goniometer.pose({"right shoulder abduction=75", "right shoulder external rotation=40", "right elbow flexion=90"});
  expect_limb("right arm", goniometer.arm(-1), {0, 75, -40, 90});
  goniometer.pose({"left shoulder abduction=150", "left elbow flexion=30"});
  expect_limb("left arm", goniometer.arm(1, true), {0, 150, 0, 30});
  goniometer.pose({"left shoulder flexion=40", "left shoulder abduction=30", "left shoulder internal rotation=25",
                   "left elbow flexion=80", "left forearm pronation=20", "left wrist flexion=0"});
  expect_limb("left arm", goniometer.arm(1), {40, 30, 25, 80});
  if (hands) expect("pronation", goniometer.pronation(1), 20);
  goniometer.pose({"right shoulder extension=30", "right elbow flexion=90", "right forearm pronation=140",
                   "right wrist flexion=0"});
  expect_limb("right arm", goniometer.arm(-1), {-30, 0, 0, 90});
  if (hands) expect("pronation", goniometer.pronation(-1), 140);
}

const BodyNames kAnatomist = {"@UpperArm", "@Forearm", "@Hand",          "@Thigh",
                              "@Shank",    "@Foot",    "@IndexProximal", "@LittleProximal"};

}  // namespace

TEST_CASE("clinical goniometer: the elbow of the procedural arm, in short") {
  const TemporaryFolder folder;
  REQUIRE(run_limber({"phantom", "arm", "--spacing", "4", "-o", folder.path().string()}).exit_code == 0);
  const GoniometerBody body{folder / "volume.nrrd",
                            folder / "rig.json",
                            folder / "tissues.json",
                            read_armature(folder / "rig.json"),
                            {"UpperArm", "Forearm", "Hand", "", "", "", "", ""},
                            {},
                            {}};
  Goniometer goniometer(body);
  for (const int degrees : {20, 100}) {
    goniometer.pose({"elbow flexion=" + std::to_string(degrees)});
    expect("elbow", goniometer.arm(1).bend, degrees);
  }
}

TEST_SUITE("slow") {
  TEST_CASE("clinical goniometer: ten poses of the procedural body") {
    const TemporaryFolder folder;
    REQUIRE(run_limber({"phantom", "body", "--spacing", "3", "-o", folder.path().string()}).exit_code == 0);
    GoniometerBody body{folder / "volume.nrrd",
                        folder / "rig.json",
                        folder / "tissues.json",
                        read_armature(folder / "rig.json"),
                        kAnatomist,
                        {},
                        {}};
    for (const std::string side : {"Left", "Right"})
      for (const char* finger : {"IndexMetacarpal", "MiddleMetacarpal", "RingMetacarpal", "LittleMetacarpal"})
        body.carried[side + "Hand"].push_back(side + finger);
    measure_whole_body(body, true);
  }

  TEST_CASE("clinical goniometer: ten poses of a body with a label for each bone") {
    NEEDS_SHARED("data/bp3d/body_3mm_structures.nii.gz");
    const TemporaryFolder folder;
    const auto shared = [](const char* name) { return shared_path(std::string("data/bp3d/") + name).string(); };
    const std::string table = shared("body_structures.labels.json");
    const ProgramRun coarser = run_limber({"prepare", shared("body_3mm_structures.nii.gz"), "--tissues", table,
                                           "--spacing", "4", "-o", (folder / "coarse.nii.gz").string()});
    REQUIRE(coarser.exit_code == 0);
    GoniometerBody body{folder / "coarse.nii.gz",
                        shared("body.armature.json"),
                        table,
                        read_armature(shared("body.armature.json")),
                        kAnatomist,
                        {},
                        {}};
    for (const Tissue& tissue : read_tissue_table(table).tissues) body.file_values[tissue.name] = tissue.file_value;
    for (const std::string side : {"Left", "Right"}) {
      body.bones[side + "Thigh"] = {side + " femur"};
      body.bones[side + "Shank"] = {side + " tibia"};
      body.bones[side + "UpperArm"] = {side + " humerus"};
      body.bones[side + "Forearm"] = {side + " ulna"};
      body.bones[side + "Hand"] = {side + " second metacarpal bone", side + " third metacarpal bone",
                                   side + " fourth metacarpal bone", side + " fifth metacarpal bone"};
    }
    measure_whole_body(body, true);
  }

  TEST_CASE("clinical goniometer: ten poses of a body whose bones are tubes of one label") {
    NEEDS_SHARED("data/makehuman/body_4mm.nrrd");
    const TemporaryFolder folder;
    const auto shared = [](const char* name) { return shared_path(std::string("data/makehuman/") + name).string(); };
    std::ofstream(folder / "tissues.json") << R"({"1": "skin", "2": "fat", "3": "muscle", "4": "bone"})";
    GoniometerBody body{shared("body_4mm.nrrd"),
                        shared("body.armature.json"),
                        folder / "tissues.json",
                        read_armature(shared("body.armature.json")),
                        {"@Arm", "@ForeArm", "@Hand", "@UpLeg", "@Leg", "@Foot", "", ""},
                        {},
                        {}};
    measure_whole_body(body, false);
  }

  TEST_CASE("clinical goniometer: ten poses of an arm with its hand, finger by finger") {
    NEEDS_SHARED("data/bp3d/arm_shoulder_1mm.nrrd");
    const TemporaryFolder folder;
    const auto shared = [](const char* name) { return shared_path(std::string("data/bp3d/") + name).string(); };
    const std::string table = shared("arm_shoulder.labels.json");
    const ProgramRun coarser = run_limber({"prepare", shared("arm_shoulder_1mm.nrrd"), "--tissues", table, "--spacing",
                                           "2", "-o", (folder / "coarse.nrrd").string()});
    REQUIRE(coarser.exit_code == 0);
    GoniometerBody body{folder / "coarse.nrrd",
                        shared("arm_shoulder.armature.json"),
                        table,
                        read_armature(shared("arm_shoulder.armature.json")),
                        kAnatomist,
                        {},
                        {}};
    for (const Tissue& tissue : read_tissue_table(table).tissues) body.file_values[tissue.name] = tissue.file_value;
    body.bones["RightUpperArm"] = {"Right humerus"};
    body.bones["RightForearm"] = {"Right ulna"};
    body.bones["RightHand"] = {"Right second metacarpal bone", "Right third metacarpal bone",
                               "Right fourth metacarpal bone", "Right fifth metacarpal bone"};
    for (const auto& [finger, word] :
         {std::pair{"Index", "index"}, {"Middle", "middle"}, {"Ring", "ring"}, {"Little", "little"}})
      for (const auto& [segment, part] : {std::pair{"Proximal", "Proximal"}, {"Middle", "Middle"}})
        body.bones[std::string("Right") + finger + segment] = {std::string(part) + " phalanx of right " + word +
                                                               " finger"};

    Goniometer goniometer(body);
    const auto wrist_to = [&](const std::string& knuckle) { return goniometer.line("RightHand", knuckle); };
    const auto forearm = [&] { return goniometer.line("RightForearm", "RightHand"); };
    goniometer.pose({"elbow flexion=40"});
    expect("elbow", goniometer.arm(-1).bend, 40);
    goniometer.pose({"elbow flexion=120", "forearm pronation=90", "wrist flexion=0"});
    expect("elbow", goniometer.arm(-1).bend, 120);
    expect("pronation", goniometer.pronation(-1), 90);
    goniometer.pose({"shoulder flexion=60", "shoulder abduction=25", "shoulder external rotation=20",
                     "elbow flexion=75", "forearm pronation=45", "wrist flexion=0"});
    expect_limb("arm", goniometer.arm(-1), {60, 25, -20, 75});
    expect("pronation", goniometer.pronation(-1), 45);
    goniometer.pose({"shoulder abduction=120", "elbow flexion=50"});
    expect_limb("arm", goniometer.arm(-1, true), {0, 120, 0, 50});
    goniometer.pose({"wrist flexion=50", "elbow flexion=90"});
    expect("wrist", degrees_between_vectors(forearm(), wrist_to("RightMiddleProximal")), 50);
    goniometer.pose({"wrist extension=40", "elbow flexion=90"});
    expect("wrist", degrees_between_vectors(forearm(), wrist_to("RightMiddleProximal")), 40);
    goniometer.pose({"wrist ulnar deviation=20", "elbow flexion=30"});
    expect("wrist", degrees_between_vectors(forearm(), wrist_to("RightMiddleProximal")), 20);
    // Finger bones are too round for a measured rotation, so their directions are compared: two poses that differ by
    // one joint angle give directions that differ by that angle.
    const auto proximal = [&](const std::string& finger) {
      return goniometer.line("Right" + finger + "Proximal", "Right" + finger + "Middle");
    };
    goniometer.pose({"index flexion=0", "middle flexion=0", "hand spread=0"});
    const glm::dvec3 index = proximal("Index"), middle = proximal("Middle"), ring = proximal("Ring");
    expect("straight index",
           degrees_between_vectors(goniometer.line("RightIndexMetacarpal", "RightIndexProximal", "RightHand"), index),
           0);
    goniometer.pose({"index knuckle flexion=60", "middle flexion=45", "hand spread=0"});
    expect("index", degrees_between_vectors(proximal("Index"), index), 60);
    expect("middle", degrees_between_vectors(proximal("Middle"), middle), 45);
    expect("middle, second joint",
           degrees_between_vectors(proximal("Middle"), goniometer.line("RightMiddleMiddle", "RightMiddleDistal")), 45);
    goniometer.pose({"index flexion=0", "middle flexion=0", "hand spread=18"});
    expect("index spread", degrees_between_vectors(proximal("Index"), index), 18);
    expect("ring spread", degrees_between_vectors(proximal("Ring"), ring), 18);
    CHECK(degrees_between_vectors(proximal("Index"), proximal("Ring")) > degrees_between_vectors(index, ring) + 30);
  }
}
