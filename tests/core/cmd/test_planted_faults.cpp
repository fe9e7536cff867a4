// SPDX-License-Identifier: AGPL-3.0-or-later
// Plants wrong inputs and wrong results one by one. Each must be reported, and with --strict end with exit code 5.
// Correct inputs in small poses must pass.
#include <algorithm>
#include <fstream>
#include <functional>
#include <map>
#include <memory>
#include <random>

#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

#include "core/base/file.h"
#include "core/rig/pose.h"
#include "core/skin/weights_io.h"
#include "core/volume_io/vector_volume_io.h"
#include "core/volume_io/volume_io.h"
#include "tests/support/figure.h"
#include "tests/support/program.h"
#include "tests/support/shared_data.h"

using namespace limber;
using namespace limber::test;
using nlohmann::json;

namespace {

std::vector<std::string> body_arguments(const TemporaryFolder& folder) {
  return {folder / "volume.nrrd", "--rig", folder / "rig.json", "--tissues", folder / "tissues.json"};
}

std::vector<std::string> operator+(std::vector<std::string> a, const std::vector<std::string>& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

ProgramRun resample(const TemporaryFolder& folder, const std::vector<std::string>& more) {
  return run_limber(std::vector<std::string>{"resample"} + body_arguments(folder) +
                    std::vector<std::string>{"--method", "dqs", "--strict", "-o", folder / "posed.nrrd", "--report",
                                             folder / "report.json"} +
                    more);
}

// Checks that a fault is caught: exit code 5, the sentence on stderr, and both outputs written.
void check_caught(const ProgramRun& run, const TemporaryFolder& folder, const char* sentence) {
  INFO(run.err);
  CHECK(run.exit_code == 5);
  CHECK(run.err.find(sentence) != std::string::npos);
  CHECK(run.err.find("limber: gate failed: ") != std::string::npos);
  CHECK(std::filesystem::exists(folder / "posed.nrrd"));
  CHECK(std::filesystem::exists(folder / "report.json"));
}

// Changes the weights of the figure voxel by voxel.
void change_weights(const Figure& figure, const TemporaryFolder& folder,
                    const std::function<void(const glm::ivec3& voxel, Label label, Influence& influence)>& change) {
  const auto run = run_limber(std::vector<std::string>{"weights"} + body_arguments(folder) +
                              std::vector<std::string>{"-o", folder / "weights.nrrd"});
  REQUIRE_MESSAGE(run.exit_code == 0, run.err);
  const TissueVoxels tissue(figure.volume);
  SkinWeights weights = read_weights(folder / "weights.nrrd", figure.volume, tissue, figure.armature).weights;
  for (std::int64_t brick = 0; brick < weights.chunk_count(); ++brick) {
    SkinWeights::Influences influences = weights.chunk(brick);
    auto influence = influences.begin();
    tissue.for_each(brick, brick + 1,
                    [&](std::int64_t, const glm::ivec3& v) { change(v, figure.volume.at(v), *influence++); });
    weights.set_chunk(brick, influences);
  }
  write_weights(weights, figure.volume, tissue, folder / "weights.nrrd");
}

// Returns the index of a rig bone. The weights list the bones in the rig's order.
int bone(const Figure& figure, const char* name) { return *figure.armature.find(name); }

void rewrite_rig(Figure& figure, const std::function<glm::dvec3(const glm::dvec3&)>& move) {
  for (Bone& bone : figure.armature.bones) bone.head = move(bone.head), bone.tail = move(bone.tail);
}

// A posed volume and its displacement field, made without the program: the function `map` moves `points` sample points
// of each rest voxel.
struct OwnPose {
  LabelVolume posed;
  ZeroedVector<glm::vec3> displacement;
};
OwnPose posed_by(const LabelVolume& rest,
                 const std::function<glm::dvec3(const glm::ivec3& voxel, const glm::dvec3& place)>& map,
                 const glm::ivec3& points) {
  OwnPose own{{rest.grid, {}}, {}};
  own.posed.grid.size += glm::ivec3(80, 0, 0);
  own.posed.grid.origin.x -= 40 * rest.grid.spacing.x;
  own.posed.voxels.assign(static_cast<std::size_t>(own.posed.grid.voxel_count()), 0);
  own.displacement.resize(own.posed.voxels.size());
  std::vector<double> nearest(own.posed.voxels.size(), 1e9);
  const AffineTransform to_world = world_from_voxel(rest.grid), to_posed = voxel_from_world(own.posed.grid);
  for (int z = 0; z < rest.grid.size.z; ++z)
    for (int y = 0; y < rest.grid.size.y; ++y)
      for (int x = 0; x < rest.grid.size.x; ++x) {
        const Label label = rest.at({x, y, z});
        if (!label) continue;
        for (int k = 0; k < points.x * points.y * points.z; ++k) {
          const glm::dvec3 part(k % points.x, k / points.x % points.y, k / points.x / points.y);
          const glm::dvec3 place = to_world * (glm::dvec3(x, y, z) + (part + 0.5) / glm::dvec3(points) - 0.5);
          const glm::dvec3 went = map({x, y, z}, place), in_grid = to_posed * went, middle = glm::floor(in_grid + 0.5);
          if (!own.posed.grid.contains(glm::ivec3(middle))) continue;
          const std::int64_t at = own.posed.grid.index(glm::ivec3(middle));
          const double off = glm::distance(middle, in_grid);
          if (off >= nearest[at]) continue;
          nearest[at] = off;
          own.posed.voxels[at] = label;
          own.displacement[at] = went - place;
        }
      }
  return own;
}
}  // namespace

TEST_CASE("planted faults: weights that swap two bones are caught by the bones that went with the other") {
  const TemporaryFolder folder;
  const Figure figure = block_figure();
  write_figure(figure, folder.path());
  const auto thigh = static_cast<std::uint16_t>(bone(figure, "LeftThigh")),
             shank = static_cast<std::uint16_t>(bone(figure, "LeftShank"));
  change_weights(figure, folder, [&](const glm::ivec3&, Label, Influence& influence) {
    for (int k = 0; k < 4; ++k)
      if (influence.weight[k])
        influence.bone[k] = influence.bone[k] == thigh ? shank : influence.bone[k] == shank ? thigh : influence.bone[k];
  });
  check_caught(resample(folder, {"--weights", folder / "weights.nrrd", "--flex", "LeftShank=40"}), folder,
               "follow LeftShank, but belong to LeftThigh");
}

TEST_CASE(
    "planted faults: weights that tear a bone in two are caught, and so are those that give half a label to another "
    "bone") {
  const TemporaryFolder folder;
  const Figure figure = block_figure();
  write_figure(figure, folder.path());
  change_weights(figure, folder, [&](const glm::ivec3& v, Label label, Influence& influence) {
    if (label == kLeftHumerus && v.z < 78) influence = rigid_influence(bone(figure, "LeftForearm"));
  });
  const auto run = resample(folder, {"--weights", folder / "weights.nrrd", "--flex", "LeftForearm=50"});
  check_caught(run, folder, "\"Left humerus\" is torn or bent");
  CHECK(run.err.find("of \"Left humerus\" follow LeftForearm, but belong to LeftUpperArm") != std::string::npos);
}

TEST_CASE("planted faults: half of a bone under the label of the next one is caught before any pose") {
  const TemporaryFolder folder;
  Figure figure = block_figure();
  fill_where(figure.volume, {36, 10, 24}, {40, 14, 35}, kLeftFemur, kLeftTibia);
  write_figure(figure, folder.path());
  check_caught(resample(folder, {}), folder, "of the label \"Left tibia\" lie along the middle of LeftThigh");
  const auto weights = run_limber(std::vector<std::string>{"weights"} + body_arguments(folder) +
                                  std::vector<std::string>{"--strict", "-o", folder / "w.nrrd"});
  CHECK(weights.exit_code == 5);
  CHECK(std::filesystem::exists(folder / "w.nrrd"));
}

TEST_CASE("planted faults: a rig that is mirrored, in RAS axes, or beside the body is caught" *
          doctest::test_suite("slow")) {
  struct Case {
    std::function<glm::dvec3(const glm::dvec3&)> move;
    const char* sentence;
  };
  const Case kCases[] = {
      {[](const glm::dvec3& p) { return p * glm::dvec3(-1, 1, 1); },
       "left and right are swapped between rig and labels"},
      {[](const glm::dvec3& p) { return (p + glm::dvec3(0, 100, 0)) * glm::dvec3(-1, -1, 1); }, "RAS axes"},
      {[](const glm::dvec3& p) { return p + glm::dvec3(0, 0, 700); }, "the rig lies outside the body"}};
  for (const Case& one : kCases) {
    const TemporaryFolder folder;
    Figure figure = block_figure();
    rewrite_rig(figure, one.move);
    // Moves the body behind the origin, so that a rig with the signs of x and y exchanged lies far from it.
    if (std::string(one.sentence) == "RAS axes") figure.volume.grid.origin.y += 100;
    write_figure(figure, folder.path());
    check_caught(resample(folder, {}), folder, one.sentence);
  }
}

TEST_CASE("planted faults: a mirrored rig is caught also where no label says its side") {
  const TemporaryFolder folder;
  Figure figure = block_figure();
  for (Tissue& tissue : figure.tissues.tissues)
    if (is_bone(tissue.kind)) tissue.name = "Bone";
  rewrite_rig(figure, [](const glm::dvec3& p) { return p * glm::dvec3(-1, 1, 1); });
  write_figure(figure, folder.path());
  check_caught(resample(folder, {}), folder, "the rig's left bones are on the body's right");
}

TEST_CASE("planted faults: a rig of another limb is caught") {
  const TemporaryFolder folder;
  Figure arm = block_arm();
  arm.armature.bones[0].name = "LeftThigh";
  arm.armature.bones[1].name = "LeftShank";
  write_figure(arm, folder.path());
  check_caught(resample(folder, {}), folder, "this is a rig of the leg, and the labels are bones of the arm");
}

TEST_CASE("planted faults: labels whose sides are swapped are caught") {
  const TemporaryFolder folder;
  Figure figure = block_figure();
  for (Tissue& tissue : figure.tissues.tissues) {
    if (tissue.name.starts_with("Left")) tissue.name.replace(0, 4, "Right");
    else if (tissue.name.starts_with("Right")) tissue.name.replace(0, 5, "Left");
  }
  write_figure(figure, folder.path());
  check_caught(resample(folder, {}), folder, "left and right are swapped");
}

TEST_CASE("planted faults: a grey image in place of labels is refused before anything is written" *
          doctest::test_suite("slow")) {
  const TemporaryFolder folder;
  Figure figure = block_figure();
  write_figure(figure, folder.path());
  std::mt19937 random(5);
  TissueTable greys;
  for (int value = 1; value <= 300; ++value) {
    Tissue& tissue = greys.tissues.emplace_back();
    tissue.label = static_cast<Label>(value);
    tissue.file_value = value;
  }
  for (Label& label : figure.volume.voxels)
    if (label) label = static_cast<Label>(1 + random() % 300);
  write_volume(figure.volume, folder / "grey.nrrd", greys);
  const std::string grey = folder / "grey.nrrd", rig = folder / "rig.json";
  const std::vector<std::vector<std::string>> commands{
      {"resample", grey, "--rig", rig, "--bones", "7", "--method", "lbs", "-o", folder / "out.nrrd"},
      {"weights", grey, "--rig", rig, "--bones", "7", "-o", folder / "out.nrrd"},
      {"fit-rig", grey, "--template", "arm", "-o", folder / "out.json"},
      {"surfaces", grey, "-o", folder / "out.obj"},
      {"convert", grey, folder / "out.stl"},
      {"prepare", grey, "--pad", "1", "-o", folder / "out.nrrd"},
      {"tissues", grey, "--frequency", "900e6", "-o", folder / "out.csv"},
      {"report", grey, grey, "--json"},
      {"project", folder / "out.limber", "create", grey}};
  for (const auto& command : commands) {
    const auto run = run_limber(command);
    INFO(command[0], ": ", run.err);
    CHECK(run.exit_code == 1);
    CHECK(run.err.find("this looks like a grey image, not a label volume (it has 300 values, and ") !=
          std::string::npos);
    CHECK(std::count(run.err.begin(), run.err.end(), '\n') == 1);
    int written = 0;
    for (const auto& entry : std::filesystem::directory_iterator(folder.path()))
      written += entry.path().filename().string().starts_with("out");
    CHECK(written == 0);
  }
  // The same file is still accepted as an image.
  CHECK(run_limber({"convert", grey, folder / "copy.mha"}).exit_code == 0);
}

TEST_CASE("planted faults: an organ that vanished and a muscle that fell apart are caught between two volumes") {
  const TemporaryFolder folder;
  const Figure figure = block_figure();
  write_figure(figure, folder.path());
  Figure posed = figure;
  fill_where(posed.volume, {0, 0, 0}, posed.volume.grid.size, kBladder, kFigureMuscle);
  fill_where(posed.volume, {0, 0, 15}, {64, 24, 17}, kLeftTibia, kFigureMuscle);
  write_volume(posed.volume, folder / "posed.nrrd", posed.tissues);
  const std::vector<std::string> compare{"report", folder / "volume.nrrd", folder / "posed.nrrd", "--tissues",
                                         folder / "tissues.json"};
  const auto run = run_limber(compare + std::vector<std::string>{"--strict", "--json"});
  CHECK(run.exit_code == 5);
  CHECK(run.err.find("\"Bladder\" is lost: nothing of its volume is left") != std::string::npos);
  CHECK(run.err.find("\"Left tibia\" fell apart") != std::string::npos);
  CHECK(json::parse(run.out)["gates"].size() == 20);
  CHECK(run_limber(compare).exit_code == 0);
  CHECK(run_limber({"report", folder / "volume.nrrd", folder / "volume.nrrd", "--tissues", folder / "tissues.json",
                    "--strict"})
            .exit_code == 0);
}

TEST_CASE(
    "planted faults: a hand that grew to the hip is caught by the band that a raised arm pulls out, by a field of "
    "another program" *
    doctest::test_suite("slow")) {
  const TemporaryFolder folder;
  Figure figure = block_figure();
  fill_where(figure.volume, {44, 7, 46}, {48, 17, 54}, 0, kFigureMuscle);
  write_figure(figure, folder.path());
  Pose pose = rest_pose(figure.armature);
  pose.rotation[2] = glm::angleAxis(glm::radians(-25.0), glm::dvec3(0, 1, 0));  // the left arm, away from the trunk
  const RigidTransform arm = posed_from_rest(figure.armature, pose)[2];
  std::ofstream(folder / "pose.json") << R"({"bones": {"LeftUpperArm": {"axis": [0, 1, 0], "degrees": -25}}})";
  // From x = 44 to 48 voxels, the map blends from the trunk, which stays, to the motion of the arm. These voxels belong
  // to the shoulder above, and to the muscle that joins hand and hip below.
  const auto posed = posed_by(figure.volume,
                              [&](const glm::ivec3& v, const glm::dvec3& p) {
                                if (v.x < 44) return p;
                                const double share =
                                    glm::clamp((p.x - figure.volume.grid.origin.x) / 4 - 43.5, 0.0, 4.0) / 4;
                                return glm::mix(p, arm * p, share);
                              },
                              {24, 3, 3});
  write_volume(posed.posed, folder / "posed.nrrd", figure.tissues);
  write_vector_volume(posed.posed.grid, {posed.displacement.data(), posed.displacement.size()}, folder / "field.nrrd");
  const std::vector<std::string> with_field{"--field", folder / "field.nrrd", "--rig",     folder / "rig.json",
                                            "--pose",  folder / "pose.json",  "--tissues", folder / "tissues.json"};
  const auto run = run_limber(
      std::vector<std::string>{"report", folder / "volume.nrrd", folder / "posed.nrrd", "--strict"} + with_field);
  INFO(run.err, run.out);
  CHECK(run.exit_code == 5);
  CHECK(run.err.find("A band of ") != std::string::npos);
  CHECK(run.err.find("separate the parts that touch there at rest") != std::string::npos);
  // The muscle joins the hand to the hip where the thigh begins. The thigh does not move in this pose.
  CHECK(run.err.find("between LeftForearm and LeftThigh") != std::string::npos);
  CHECK(run.out.find("passed      Each of 11 named bones moved rigidly") != std::string::npos);
}

TEST_CASE("strict: a job ends with exit code 5 as the command does, and without it a failed gate costs nothing") {
  const TemporaryFolder folder;
  Figure figure = block_figure();
  rewrite_rig(figure, [](const glm::dvec3& p) { return p * glm::dvec3(-1, 1, 1); });
  write_figure(figure, folder.path());
  const char* kJob =
      R"({"command": "resample", "volume": "volume.nrrd", "rig": "rig.json", "tissues": "tissues.json",
        "method": "lbs", "strict": STRICT, "output": "posed.nrrd", "report": "report.json"})";
  for (const bool strict : {true, false}) {
    std::string job = kJob;
    std::ofstream(folder / "job.json") << job.replace(job.find("STRICT"), 6, strict ? "true" : "false");
    CHECK(run_limber({"job", folder / "job.json"}).exit_code == (strict ? 5 : 0));
    const json report = json::parse(read_file(folder / "report.json"));
    CHECK(report["gates"][0]["state"] == "failed");
    CHECK(report["doubts"].size() == 1);
  }
  CHECK(run_limber({"resample", "--help"}).out.find("5 a quality gate failed with --strict") != std::string::npos);
}

TEST_CASE("strict: gates that nobody could check say so, and never pass") {
  const TemporaryFolder folder;
  const Figure figure = block_figure();
  write_figure(figure, folder.path());
  const auto run = run_limber(
      {"report", folder / "volume.nrrd", folder / "volume.nrrd", "--tissues", folder / "tissues.json", "--json"});
  REQUIRE(run.exit_code == 0);
  const json report = json::parse(run.out);
  for (const json& gate : report["gates"])
    for (const char* id : {"inputs", "whole", "follows", "directions", "exposed", "bands"})
      if (gate["id"] == id) {
        CHECK(gate["state"] == "not checked");
        CHECK(gate["sentence"].get<std::string>().find("is not checked: ") != std::string::npos);
      }
}

TEST_CASE("good cases: bodies built in code, at rest and in small poses, pass every gate of the body" *
          doctest::test_suite("slow")) {
  struct Case {
    std::string body;  // arm, body: the phantoms; figure, block arm: bodies of this test
    std::vector<std::string> flex;
    std::string method;
  };
  const std::vector<Case> kCases = {{"figure", {}, "lbs"},
                                    {"figure", {}, "dqs"},
                                    {"figure", {"LeftForearm=15"}, "dqs"},
                                    {"figure", {"LeftForearm=-15", "RightForearm=-15"}, "lbs"},
                                    {"figure", {"LeftShank=15"}, "dqs"},
                                    {"figure", {"LeftUpperArm=10"}, "dqs"},
                                    {"figure", {"RightThigh=-10"}, "dqs"},
                                    {"block arm", {}, "dqs"},
                                    {"block arm", {"LeftForearm=20"}, "dqs"},
                                    {"block arm", {"LeftForearm=-20"}, "lbs"},
                                    {"arm", {}, "dqs"},
                                    {"arm", {"Forearm=20"}, "dqs"},
                                    {"arm", {"Forearm=20"}, "lbs"},
                                    {"arm", {"Forearm=40", "IndexProximal=20"}, "dqs"},
                                    {"body", {}, "dqs"},
                                    {"body", {"LeftForearm=30"}, "dqs"}};
  std::map<std::string, std::unique_ptr<TemporaryFolder>> bodies;
  for (const Case& one : kCases) {
    auto& folder = bodies[one.body];
    if (!folder) {
      folder = std::make_unique<TemporaryFolder>();
      if (one.body == "figure") write_figure(block_figure(), folder->path());
      else if (one.body == "block arm") write_figure(block_arm(), folder->path());
      else
        REQUIRE(run_limber({"phantom", one.body, "--spacing", one.body == "arm" ? "4" : "6", "-o", folder->path()})
                    .exit_code == 0);
    }
    std::vector<std::string> arguments =
        std::vector<std::string>{"resample"} + body_arguments(*folder) +
        std::vector<std::string>{"--method", one.method, "--strict", "-o", *folder / "posed.nrrd"};
    std::string name = one.body + " " + one.method;
    for (const std::string& flex : one.flex) arguments.insert(arguments.end(), {"--flex", flex}), name += " " + flex;
    const auto run = run_limber(arguments);
    CHECK_MESSAGE(run.exit_code == 0, name, ": ", run.err);
    CHECK_MESSAGE(run.err.find("gate failed") == std::string::npos, name, ": ", run.err);
  }
}

TEST_CASE("good cases: real bodies at rest and with bent elbows pass every gate of the body" *
          doctest::test_suite("slow")) {
  NEEDS_SHARED("data/bp3d/body_3mm_structures.nii.gz");
  struct Case {
    const char *volume, *rig, *tissues;
    std::vector<std::string> flex;
  };
  const Case kCases[] = {
      {"bp3d/body_3mm_structures.nii.gz", "bp3d/body.armature.json", "bp3d/body_structures.labels.json", {}},
      {"bp3d/body_3mm_structures.nii.gz",
       "bp3d/body.armature.json",
       "bp3d/body_structures.labels.json",
       {"LeftForearm=60", "RightForearm=60"}},
      {"makehuman/body_4mm.nrrd", "makehuman/body.armature.json", "", {"LeftForeArm=30"}},
      {"bender/man-arm-2mm.mha", "bender/man-arm-2mm-armature.vtk", "", {}},
      {"bender/man-arm-2mm.mha", "bender/man-arm-2mm-armature.vtk", "", {"Forearm=30"}}};
  const TemporaryFolder folder;
  for (const Case& one : kCases) {
    const auto file = [](const char* name) { return (shared_path("data") / name).string(); };
    std::vector<std::string> arguments{"resample", file(one.volume), "--rig", file(one.rig),        "--method",
                                       "dqs",      "--strict",       "-o",    folder / "posed.nrrd"};
    if (*one.tissues) arguments.insert(arguments.end(), {"--tissues", file(one.tissues)});
    for (const std::string& flex : one.flex) arguments.insert(arguments.end(), {"--flex", flex});
    const auto run = run_limber(arguments);
    CHECK_MESSAGE(run.exit_code == 0, one.volume, ": ", run.err);
    CHECK(run.err.find("gate failed") == std::string::npos);
  }
}
