// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/batch/batch.h"

#include <fstream>

#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

#include "core/base/error.h"
#include "core/batch/observations.h"
#include "core/batch/work_folder.h"
#include "core/phantom/phantom.h"
#include "tests/support/program.h"

using namespace limber;

namespace {
// Writes a folder with files that a batch may name.
struct Inputs {
  test::TemporaryFolder folder;
  Inputs() {
    for (const char* name : {"v.nrrd", "r.json", "w.nrrd", "points.csv"}) std::ofstream(folder / name) << "x";
    std::ofstream motion(folder / "walk.bvh");
    motion
        << "HIERARCHY\nROOT Hips\n{\nOFFSET 0 0 0\nCHANNELS 3 Zrotation Xrotation Yrotation\nEnd Site\n{\nOFFSET 0 1 "
           "0\n}\n}\nMOTION\nFrames: 12\nFrame Time: 0.1\n";
    for (int frame = 0; frame < 12; ++frame) motion << "0 0 0\n";
  }
  Batch read(const std::string& text) {
    std::ofstream(folder / "batch.json") << text;
    return read_batch(folder / "batch.json");
  }
};
}  // namespace

TEST_CASE("batch: cells are bodies x poses or frames x methods, and each frame of a sequence is a pose") {
  Inputs inputs;
  const Batch batch = inputs.read(R"({
    "bodies": [{"name": "man", "volume": "v.nrrd", "rig": "r.json", "weights": "w.nrrd", "seams": "none",
                "landmarks": "points.csv"},
               {"phantom": "arm", "spacing_mm": 3}],
    "poses": [{"name": "seated", "pose_name": "sit"},
              {"name": "walk", "motion": "walk.bvh", "frames": "1:11:5"}, {"name": "all", "motion": "walk.bvh",
               "frames": "all", "up": "z"}],
    "methods": ["dqs", "fem-contact"], "volumes": ["jacobian", "displacement"], "format": ".nii.gz", "mesh": ".vtu",
    "exports": [".stl", {"ending": ".gprmax.h5", "frequency_hz": 9e8}]})");
  CHECK(batch.name == "batch");
  REQUIRE(batch.bodies.size() == 2);
  CHECK(batch.bodies[0].weights_file.filename() == "w.nrrd");
  CHECK(batch.bodies[0].no_seams);
  CHECK(batch.bodies[1].name == "arm");
  CHECK(batch.bodies[1].spacing == 3);
  REQUIRE(batch.poses.size() == 1 + 3 + 12);
  CHECK(batch.poses[2].name == "walk 0006");
  CHECK(batch.poses[2].sequence == "walk");
  CHECK(batch.poses[2].frame == 6);
  CHECK(batch.poses[15].frame == 11);
  const std::vector<BatchCell> cells = cells_of(batch);
  REQUIRE(cells.size() == 2 * 16 * 2);
  CHECK(text_of(batch, cells[0]) == "man, seated, dqs");
  CHECK(text_of(batch, cells[5]) == "man, walk 0006, fem-contact");
  CHECK(text_of(batch, cells.back()) == "arm, all 0011, fem-contact");
  CHECK(batch.settings.outputs.at("output") == "posed.nii.gz");
  CHECK(batch.settings.outputs.at("field") == "displacement.nrrd");
  CHECK(batch.settings.mesh == "mesh.vtu");
  REQUIRE(batch.exports.size() == 2);
  CHECK(batch.exports[1].frequency == 9e8);
}

TEST_CASE("batch: a description that is wrong is refused in one line that names the key") {
  Inputs inputs;
  const std::string body = R"("bodies": [{"volume": "v.nrrd", "rig": "r.json"}])", pose = R"("poses": [{"name": "a"}])";
  const std::string both = "{" + body + ", " + pose;
  for (const auto& [text, named] : std::vector<std::pair<std::string, std::string>>{
           {"[]", "not a description of a batch"},
           {"{}", "no bodies"},
           {"{" + body + "}", "the batch has no poses"},
           {R"({"bodies": [], )" + pose + "}", "bodies"},
           {R"({"bodies": [3], )" + pose + "}", "bodies, number 1"},
           {R"({"bodies": [{"rig": "r.json"}], )" + pose + "}", "needs exactly one body"},
           {R"({"bodies": [{"volume": "v.nrrd"}], )" + pose + "}", "needs a rig"},
           {R"({"bodies": [{"phantom": "arm"}, {"phantom": "arm"}], )" + pose + "}", "twice"},
           {R"({"bodies": [{"phantom": "arm", "spacing_mm": 0}], )" + pose + "}", "spacing_mm"},
           {R"({"bodies": [{"phantom": "arm", "weights": "w.nrrd"}], )" + pose + "}", "weights"},
           {R"({"bodies": [{"volume": "v.nrrd", "rig": "r.json", "weights": "w.nrrd", "spacing_mm": 2}], )" + pose +
                "}",
            "own voxel size"},
           {R"({"bodies": [{"volume": "v.nrrd", "rig": "r.json", "weights": "none.nrrd"}], )" + pose + "}",
            "none.nrrd"},
           {R"({"bodies": [{"volume": "v.nrrd", "rig": "r.json", "colour": "red"}], )" + pose + "}", "colour"},
           {"{" + body + R"(, "poses": [{"name": "a", "motion": "walk.bvh", "frames": "3:12"}]})", "last frame is 11"},
           {"{" + body + R"(, "poses": [{"name": "a", "motion": "walk.bvh", "frames": "3-9"}]})",
            "not a range of frames"},
           {"{" + body + R"(, "poses": [{"name": "a", "motion": "walk.bvh", "frames": "0:1", "frame": 1}]})",
            "a pose has either one frame or several"},
           {"{" + body + R"(, "poses": [{"name": "a", "frames": "0:1"}]})", "motion"},
           {"{" + body + R"(, "poses": [{"name": "b", "motion": "r.json", "frames": "0:1"}]})", "r.json"},
           {both + R"(, "methods": ["spline"]})", "spline"},
           {both + R"(, "format": "nrrd"})", "format"},
           {both + R"(, "format": ".dcm"})", ".dcm"},
           {both + R"(, "format": ".x/../../y.nrrd"})", "format"},
           {both + R"(, "volumes": ["strain"]})", "strain"},
           {both + R"(, "exports": [".docx"]})", ".docx"},
           {both + R"(, "exports": ["/tmp/x.stl"]})", "exports"},
           {both + R"(, "exports": [".stl", ".stl"]})", "twice"},
           {both + R"(, "exports": [".gprmax.h5"]})", "frequency"},
           {both + R"(, "mesh": ".stl"})", "mesh"},
           {both + R"(, "glide": "far"})", "glide"},
           {both + R"(, "methods": ["dqs-mass-exact"], "nearest": true})", "nearest"},
       }) {
    std::string said;
    try {
      inputs.read(text);
    } catch (const Error& error) {
      said = error.what();
    }
    INFO(text, " -> ", said);
    CHECK(said.find(named) != std::string::npos);
    CHECK(said.find('\n') == std::string::npos);
  }
}

TEST_CASE("batch: observations are one figure a row, without what differs from run to run") {
  const std::string report = R"({"schema": "limber-report/1", "seconds": {"total": 3.5}, "peak_memory_mb": 9,
    "tissues": [{"label": 1, "name": "skin, \"thin\"", "mm3_after": 2.5}], "total": {"voxels_after": 7},
    "mesh": {"stretch_by_label": {"8": {"least": [0.5, 1]}}}, "whole_body": true, "bands": []})";
  const std::string cell = R"({"cpu_seconds": 1.25, "machine": "m"})";
  const std::vector<Observed> cells = {{{"man", "sit"}, report, cell, ""}, {{"man", "a,b"}, "", "", "no such bone"}};
  CHECK(observations_csv({"body", "pose"}, cells) ==
        "body,pose,group,item,quantity,value\r\n"
        "man,sit,tissues,\"skin, \"\"thin\"\"\",label,1\r\n"
        "man,sit,tissues,\"skin, \"\"thin\"\"\",mm3_after,2.5\r\n"
        "man,sit,total,,voxels_after,7\r\n"
        "man,sit,mesh,,stretch_by_label.8.least.0,0.5\r\n"
        "man,sit,mesh,,stretch_by_label.8.least.1,1\r\n"
        "man,sit,whole_body,,whole_body,1\r\n"
        "man,\"a,b\",cell,,failure,no such bone\r\n");
  CHECK(times_csv({"body", "pose"}, cells) ==
        "body,pose,machine,quantity,value\r\n"
        "man,sit,m,total_s,3.5\r\n"
        "man,sit,m,cpu_s,1.25\r\n"
        "man,sit,m,peak_memory_mb,9\r\n");
}

TEST_CASE("work folder: it appears whole or not at all, one program at a time, and what the dead left is removed") {
  const test::TemporaryFolder folder;
  const Path place = folder / "cell";
  const auto hidden = [&] {
    int count = 0;
    for (const auto& entry : std::filesystem::directory_iterator(folder.path()))
      count += entry.path().filename().string().starts_with('.');
    return count;
  };
  {
    WorkFolder first(place, no_progress());
    std::ofstream(first / "half") << "x";
    WorkFolder second(place, no_progress(), IfBusy::Leave);
    CHECK(second.busy());
    CHECK_FALSE(second.made());
  }
  CHECK_FALSE(std::filesystem::exists(place));
  CHECK(hidden() == 0);
  // Simulates a killed program on this machine: its lock folder and its working folder are left behind.
  std::filesystem::path left;
  {
    WorkFolder one(place, no_progress());
    left = one / "";
    std::filesystem::copy(folder / ".cell.lock", folder / "copy");
  }
  std::filesystem::rename(folder / "copy", folder / ".cell.lock");
  std::filesystem::create_directory(left.parent_path());
  std::ofstream(left / "half") << "x";
  {
    WorkFolder again(place, no_progress(), IfBusy::Leave);
    CHECK_FALSE(again.busy());
    CHECK_FALSE(std::filesystem::exists(again / "half"));
    std::ofstream(again / "whole") << "x";
    again.commit();
  }
  CHECK(std::filesystem::exists(place / "whole"));
  CHECK(hidden() == 0);
  const WorkFolder late(place, no_progress());
  CHECK(late.made());
  CHECK_FALSE(late.busy());
}

TEST_CASE("work folder: where two machines do the same work, the first result stays") {
  const test::TemporaryFolder folder;
  const Path place = folder / "cell";
  WorkFolder mine(place, no_progress());
  std::ofstream(mine / "mine") << "x";
  // Simulates a folder made by another machine, whose locks this machine cannot see.
  std::filesystem::create_directory(place);
  std::ofstream(place / "theirs") << "x";
  mine.commit();
  CHECK(mine.made());
  CHECK(std::filesystem::exists(place / "theirs"));
  CHECK_FALSE(std::filesystem::exists(place / "mine"));
}
