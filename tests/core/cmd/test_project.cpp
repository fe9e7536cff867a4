// SPDX-License-Identifier: AGPL-3.0-or-later
#include <fstream>

#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

#include "core/base/file.h"
#include "core/bones/bone_map.h"
#include "core/motion/constraint.h"
#include "core/pose/pose_io.h"
#include "core/project/project_io.h"
#include "core/project/session.h"
#include "core/seams/seams_io.h"
#include "tests/support/documents.h"
#include "tests/support/program.h"
#include "tests/support/shared_data.h"

using namespace limber;
using namespace limber::test;

namespace {
ProgramRun project(const TemporaryFolder& folder, std::vector<std::string> words) {
  words.insert(words.begin(), {"project", folder / "arm.limber"});
  return run_limber(words);
}

void make_arm(const TemporaryFolder& folder) {
  REQUIRE(run_limber({"phantom", "arm", "--spacing", "8", "-o", folder.path()}).exit_code == 0);
  const std::string volume = folder / "volume.nrrd", rig = folder / "rig.json", tissues = folder / "tissues.json",
                    weights = folder / "weights.nrrd";
  REQUIRE(run_limber({"weights", volume, "--rig", rig, "--tissues", tissues, "--method", "rigid", "-o", weights})
              .exit_code == 0);
  const auto made = project(folder, {"create", volume, "--rig", rig, "--tissues", tissues, "--weights", weights,
                                     "--motion", folder / "motion.bvh"});
  INFO(made.err);
  REQUIRE(made.exit_code == 0);
}
}  // namespace

namespace {

// Returns the weights' header without its seams, which a project does not store.
std::string without_seams(std::string weights) {
  const std::size_t begin = weights.find("limber_seams:=");
  if (begin != std::string::npos) weights.erase(begin, weights.find('\n', begin) + 1 - begin);
  return weights;
}

}  // namespace

TEST_CASE("project command: what create puts in, inspect and info tell and export gives back" *
          doctest::test_suite("slow")) {
  const TemporaryFolder folder;
  make_arm(folder);
  const auto inspected = project(folder, {"--json"});
  REQUIRE(inspected.exit_code == 0);
  const auto json = nlohmann::json::parse(inspected.out);
  const auto volume = nlohmann::json::parse(run_limber({"info", folder / "volume.nrrd", "--json"}).out);
  CHECK(json["kind"] == "project");
  CHECK(json["volume"]["size"] == volume["size"]);
  CHECK(json["weights"]["voxels"] == json["volume"]["tissue_voxels"]);
  CHECK(json["bones"].size() == json["weights"]["bones"]);
  CHECK(json["posed_bones"].empty());
  CHECK(json["clips"][0]["frames"] > 0);
  CHECK(run_limber({"info", folder / "arm.limber", "--json"}).out == inspected.out);
  CHECK(run_limber({"info", folder / "arm.limber"}).out.starts_with("kind        project"));
  CHECK(project(folder, {"verify"}).exit_code == 0);

  REQUIRE(project(folder, {"export", "volume", "-o", folder / "again.nrrd"}).exit_code == 0);
  CHECK(read_volume(folder / "again.nrrd").volume.voxels == read_volume(folder / "volume.nrrd").volume.voxels);
  REQUIRE(project(folder, {"export", "weights", "-o", folder / "again-weights.nrrd"}).exit_code == 0);
  CHECK(read_file(folder / "again-weights.nrrd") == without_seams(read_file(folder / "weights.nrrd")));
  REQUIRE(project(folder, {"export", "rig", "-o", folder / "again-rig.json"}).exit_code == 0);
  CHECK(read_file(folder / "again-rig.json") == read_file(folder / "rig.json"));
  REQUIRE(project(folder, {"export", "motion", "-o", folder / "again.bvh"}).exit_code == 0);
}

TEST_CASE("project command: seams and a bone map are kept, told and given back" * doctest::test_suite("slow")) {
  const TemporaryFolder folder;
  make_arm(folder);
  const LabelVolume volume = read_volume(folder / "volume.nrrd").volume;
  Seams seams(volume.grid.size);
  for (int x = 0; x + 1 < volume.grid.size.x; ++x)
    for (int y = 0; y < volume.grid.size.y; ++y) {
      const glm::ivec3 v(x, y, volume.grid.size.z / 2);
      if (volume.at(v) && volume.at(v + glm::ivec3(1, 0, 0)) && (x + y) % 3 == 0) seams.cut(v, 0);
    }
  REQUIRE(seams.size() > 3);
  write_seams(seams, volume.grid, folder / "seams.nrrd");
  const auto bones = nlohmann::json::parse(read_file(folder / "rig.json"))["bones"];
  const TissueTable tissues =
      merge_tissue_tables(read_volume(folder / "volume.nrrd").tissues,
                          std::make_unique<TissueTable>(read_tissue_table(folder / "tissues.json")).get());
  const auto bone = std::find_if(tissues.tissues.begin(), tissues.tissues.end(),
                                 [](const Tissue& tissue) { return is_bone(tissue.kind); });
  REQUIRE(bone != tissues.tissues.end());
  write_bone_map({{map_key(*bone), bones[0]["name"].get<std::string>()}}, folder / "bones.json");
  const auto create = [&](const std::string& map) {
    return run_limber({"project", folder / "two.limber", "create", folder / "volume.nrrd", "--tissues",
                       folder / "tissues.json", "--rig", folder / "rig.json", "--seams", folder / "seams.nrrd",
                       "--bone-map", folder / map, "--replace"});
  };
  const auto made = create("bones.json");
  INFO(made.err);
  REQUIRE(made.exit_code == 0);
  const auto json = nlohmann::json::parse(run_limber({"project", folder / "two.limber", "--json"}).out);
  CHECK(json["seams"]["faces"] == seams.size());
  CHECK(json["bone_map"].size() == 1);
  REQUIRE(run_limber({"project", folder / "two.limber", "export", "seams", "-o", folder / "again.nrrd"}).exit_code ==
          0);
  CHECK(read_seams(folder / "again.nrrd", volume) == seams);
  REQUIRE(run_limber({"project", folder / "two.limber", "export", "bone-map", "-o", folder / "again.json"}).exit_code ==
          0);
  CHECK(read_bone_map(folder / "again.json") == read_bone_map(folder / "bones.json"));
  write_bone_map({{map_key(*bone), "no such bone"}}, folder / "wrong.json");
  CHECK(create("wrong.json").exit_code == 1);
  CHECK(run_limber({"project", folder / "arm.limber", "export", "seams", "-o", folder / "none.nrrd"}).exit_code == 1);
}

TEST_CASE("project command: recover writes the edits that a crash left, or what is whole of a damaged project" *
          doctest::test_suite("slow")) {
  const TemporaryFolder folder;
  make_arm(folder);
  {
    Project arm;
    const auto session = Session::open(folder / "arm.limber", arm, no_progress(), {.edits_folder = folder / "state"});
    Pose pose = *arm.document.pose;
    pose.rotation[1] = {0.6, 0.8, 0, 0};
    arm.document.pose = std::make_shared<const Pose>(pose);
    session->keep(arm.document, "Turn");
    REQUIRE(session->flush(30));
  }
  CHECK(nlohmann::json::parse(project(folder, {"--json"}).out)["unsaved_edits"] == 1);
  const auto recovered = project(folder, {"recover", "-o", folder / "out.limber"});
  CHECK(recovered.exit_code == 0);
  CHECK(recovered.out == "edits recovered up to: Turn\n");
  CHECK(nlohmann::json::parse(run_limber({"info", folder / "out.limber", "--json"}).out)["posed_bones"].size() == 1);
  CHECK(project(folder, {"recover", "-o", folder / "out.limber"}).exit_code == 1);  // the output exists already

  std::string bytes = read_file(folder / "out.limber");
  const std::size_t first_chunk = bytes.find("\x28\xb5\x2f\xfd");  // the first bytes of a zstd frame
  REQUIRE(first_chunk != std::string::npos);
  for (std::size_t at = first_chunk + 16; at < first_chunk + 24; ++at) bytes[at] ^= 0x55;
  std::ofstream(folder / "bad.limber", std::ios::binary) << bytes;
  const auto verified = run_limber({"project", folder / "bad.limber", "verify"});
  CHECK(verified.exit_code == 1);
  CHECK(verified.err.find("damaged") != std::string::npos);
  CHECK(run_limber({"project", folder / "bad.limber", "recover", "-o", folder / "saved.limber"}).exit_code == 0);
  CHECK(run_limber({"project", folder / "saved.limber", "verify"}).exit_code == 0);
}

TEST_CASE("project command: what cannot be done is refused in one line and writes nothing" *
          doctest::test_suite("slow")) {
  const TemporaryFolder folder;
  make_arm(folder);
  std::ofstream(folder / "text.limber") << "hello";
  std::vector<std::vector<std::string>> requests = {{"create", folder / "volume.nrrd"},  // the project exists already
                                                    {"export"},
                                                    {"export", "volume"},
                                                    {"export", "pictures", "-o", folder / "new"},
                                                    {"export", "volume", "-o", folder / "new.xyz"},
                                                    {"recover"}};
  for (auto& words : requests) words.insert(words.begin(), folder / "arm.limber");
  requests.push_back({folder / "none.limber"});
  requests.push_back({folder / "text.limber"});
  requests.push_back({folder / "new.limber", "create", folder / "none.nrrd"});
  requests.push_back({folder / "new.limber", "create", "--weights", folder / "weights.nrrd"});
  for (auto words : requests) {
    words.insert(words.begin(), "project");
    const auto run = run_limber(words);
    INFO(words.back(), " -> ", run.err);
    CHECK(run.exit_code == 1);
    CHECK(std::count(run.err.begin(), run.err.end(), '\n') == 1);
    CHECK(run.err.starts_with("limber: "));
  }
  for (const char* name : {"new", "new.xyz", "new.limber"}) CHECK_FALSE(std::filesystem::exists(folder / name));
  CHECK(run_limber({"project", folder / "arm.limber", "dance"}).exit_code == 2);
}

TEST_CASE("info: a JSON with a table of bones that holds no rotations is no pose") {
  const TemporaryFolder folder;
  std::ofstream(folder / "weights.json") << R"({"vertices": 2, "bones": {"Head": [[0, 1.0], [1, 1.0]]}})";
  std::ofstream(folder / "pose.json") << R"({"bones": {"Head": {"axis": [1, 0, 0], "degrees": 5}}})";
  const auto weights = run_limber({"info", folder / "weights.json", "--json"});
  INFO(weights.out, weights.err);
  CHECK(weights.exit_code == 1);
  CHECK(weights.out.find("pose") == std::string::npos);
  CHECK(nlohmann::json::parse(run_limber({"info", folder / "pose.json", "--json"}).out)["kind"] == "pose");
  NEEDS_SHARED("data/makehuman/surface_weights.json");
  CHECK(run_limber({"info", shared_path("data/makehuman/surface_weights.json").string(), "--json"}).out.find("pose") ==
        std::string::npos);
}

TEST_CASE("project command: a motion with eased keys is written as it plays, a motion without keys as it came") {
  const TemporaryFolder folder;
  Armature arm;
  arm.bones = {{"Upper", -1, {0, 0, 30}, {0, 0, 0}}, {"Fore", 0, {0, 0, 0}, {0, 0, -30}}};
  Document document;
  document.armature = std::make_shared<const Armature>(arm);
  Clip clip{.name = "keys", .range_end = 20};
  const auto bent = [](double degrees) { return glm::angleAxis(glm::radians(degrees), glm::dvec3(1, 0, 0)); };
  clip.keys.bones["Fore"] = {{0, bent(0)}, {20, bent(80)}};
  set_shape(clip.keys, "Fore", 0, {.next = Interpolation::Bezier, .handles = HandleKind::Flat});
  document.clips = {std::make_shared<const Clip>(clip)};
  DocumentWriter writer;
  create_project({.document = document}, folder / "arm.limber", writer);
  const auto written = project(folder, {"export", "motion", "-o", folder / "out.bvh"});
  INFO(written.err);
  REQUIRE(written.exit_code == 0);
  const auto motion = std::make_shared<const Motion>(read_bvh(folder / "out.bvh"));
  REQUIRE(motion->frame_count == 21);
  const ClipOnRig played(std::make_shared<const Clip>(clip_of(motion, "back")), document.armature);
  for (const int frame : {0, 5, 10, 15, 20}) {
    const double t = frame / 20.0, wanted = 80 * t * t * (3 - 2 * t);
    const glm::dquat q = played.at(frame).rotation[1];
    CHECK(glm::degrees(2 * std::atan2(q.x, q.w)) == doctest::Approx(wanted).epsilon(1e-4));
  }

  clip.motion = motion;
  clip.keys = {};
  document.clips = {std::make_shared<const Clip>(clip)};
  create_project({.document = document}, folder / "arm.limber", writer);
  REQUIRE(project(folder, {"export", "motion", "-o", folder / "again.bvh"}).exit_code == 0);
  CHECK(read_file(folder / "again.bvh") == read_file(folder / "out.bvh"));
}

TEST_CASE("project command: constraints hold in the motion and the poses that are exported, and are listed") {
  const TemporaryFolder folder;
  Armature arm;
  arm.bones = {{"Trunk", -1, {0, 0, 0}, {0, 0, 200}},
               {"LeftArm", 0, {0, 0, 200}, {120, 20, 40}},
               {"LeftForeArm", 1, {120, 20, 40}, {240, -20, -100}},
               {"LeftHand", 2, {240, -20, -100}, {270, -40, -180}}};
  Document document;
  document.armature = std::make_shared<const Armature>(arm);
  Clip clip{.name = "turn", .range_end = 20};
  clip.keys.bones["Trunk"] = {{0, {1, 0, 0, 0}}, {20, glm::angleAxis(0.9, glm::dvec3(0, 0, 1))}};
  Constraint plant{.name = "Plant LeftHand", .kind = ConstraintKind::Plant, .bone = "LeftHand", .place{150, -120, -60}};
  clip.constraints = std::make_shared<const Constraints>(Constraints{{plant}});
  clip.keys.weights["Plant LeftHand"] = {{0, 0}, {10, 1}};
  document.clips = {std::make_shared<const Clip>(clip)};
  DocumentWriter writer;
  create_project({.document = document}, folder / "arm.limber", writer);
  REQUIRE(project(folder, {"export", "motion", "-o", folder / "out.bvh"}).exit_code == 0);
  const auto motion = std::make_shared<const Motion>(read_bvh(folder / "out.bvh"));
  const ClipOnRig played(std::make_shared<const Clip>(clip_of(motion, "back")), document.armature);
  for (const int frame : {0, 5, 10, 20}) {
    const std::string file = folder / ("pose" + std::to_string(frame) + ".json");
    const auto written = project(folder, {"export", "pose", "--frame", std::to_string(frame), "-o", file});
    INFO(written.err);
    REQUIRE(written.exit_code == 0);
    const auto tail = [&](const Pose& pose) { return posed_from_rest(arm, pose)[3] * arm.bones[3].tail; };
    const glm::dvec3 from_pose = tail(read_pose(file, arm)), from_motion = tail(played.at(frame));
    CHECK(glm::distance(from_pose, from_motion) < 0.01);
    CHECK((glm::distance(from_pose, plant.place) < 0.5) == (frame >= 10));
    // In frame 0 the constraint has weight 0, and only the trunk is turned.
    if (frame == 0) CHECK(glm::distance(from_pose, arm.bones[3].tail) < 1e-6);
  }
  const auto told = nlohmann::json::parse(project(folder, {"inspect", "--json"}).out);
  CHECK(told["clips"][0]["constraints"] == nlohmann::json{"Plant LeftHand"});
  for (const std::vector<std::string> words : {std::vector<std::string>{"inspect", "--frame", "3"},
                                               {"verify", "--frame", "3"},
                                               {"export", "motion", "--frame", "3", "-o", folder / "none.bvh"}}) {
    const auto refused = project(folder, words);
    CHECK(refused.exit_code == 1);
    CHECK(refused.err.find("only export pose takes a frame") != std::string::npos);
  }
  // A clip with more constraints than the editor allows is refused.
  std::vector<Constraint> many;
  for (std::size_t i = 0; i <= kMostConstraints; ++i) {
    many.push_back(plant);
    many.back().name = std::to_string(i);
  }
  for (const std::size_t count : {kMostConstraints + 1, kMostConstraints}) {
    many.resize(count);
    clip.constraints = std::make_shared<const Constraints>(Constraints{many});
    document.clips = {std::make_shared<const Clip>(clip)};
    create_project({.document = document}, folder / "arm.limber", writer);
    CHECK((project(folder, {"verify"}).exit_code == 0) == (count == kMostConstraints));
  }
  document.clips.clear();
  create_project({.document = document}, folder / "arm.limber", writer);
  const auto refused = project(folder, {"export", "pose", "--frame", "3", "-o", folder / "none.json"});
  CHECK(refused.exit_code == 1);
  CHECK(refused.err.find("the project has no clip on a rig") != std::string::npos);
}
