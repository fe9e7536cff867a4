// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/study/study.h"

#include <algorithm>
#include <fstream>

#include <doctest/doctest.h>

#include "core/base/error.h"
#include "core/base/file.h"
#include "core/batch/computing_sources.h"
#include "core/study/run_study.h"
#include "tests/support/program.h"

using namespace limber;

TEST_CASE("study: the paper's has 48 cells, spacing by spacing, each named once") {
  const Study study = paper_study();
  CHECK(study.phantom == "arm");
  const std::vector<StudyCell> cells = cells_of(study);
  REQUIRE(cells.size() == 48);
  CHECK(text_of(study, cells.front()) == "2 mm, +0°, Linear blend");
  CHECK(text_of(study, cells.back()) == "4 mm, +90°, FEM with contact");
  std::vector<std::string> names;
  for (const StudyCell& cell : cells) names.push_back(text_of(study, cell));
  std::sort(names.begin(), names.end());
  CHECK(std::adjacent_find(names.begin(), names.end()) == names.end());
}

TEST_CASE("study: the real arm's folder brings its volumes and its armature, and joints are fitted") {
  const test::TemporaryFolder folder;
  const auto refused = [&] {
    try {
      paper_study(folder.path());
    } catch (const Error& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  CHECK(refused().find("no arm in the folder") != std::string::npos);
  for (const char* name : {"man-arm-2mm.mha", "man-arm-2mm-skinned.mha", "man-arm-4mm.nrrd", "man-arm-3mm.txt"})
    std::ofstream(folder / name) << "x";
  CHECK(refused().find("no armature") != std::string::npos);
  std::ofstream(folder / "man-arm-2mm-armature.vtk") << "x";
  const Study study = paper_study(folder.path());
  CHECK(study.volume.filename() == "man-arm-2mm.mha");
  REQUIRE(study.ready.size() == 2);
  CHECK(study.ready.at(4).filename() == "man-arm-4mm.nrrd");
  CHECK(study.fit_joints);
}

TEST_CASE("study: a description says body, poses, techniques and spacings, and what it leaves out has defaults") {
  const test::TemporaryFolder folder;
  std::ofstream(folder / "body.nrrd") << "x";
  std::ofstream(folder / "rig.json") << "x";
  std::ofstream(folder / "study.json")
      << R"({"name": "Knee", "volume": "body.nrrd", "rig": "rig.json", "bones": [3, 4], "spacings_mm": [1.5, null],
        "methods": ["dqs", "fem-contact"],
    "poses": [{"name": "rest"}, {"name": "bent", "flex": ["Shin=60", "Foot=-10"]},
      {"name": "seated", "pose_name": "sit", "joints": "left elbow flexion=30"}], "quality": "draft",
        "weights": "geodesic", "fit_joints": true, "gates": {"tissue_percent": 0.5}})";
  const Study study = read_study(folder / "study.json");
  CHECK(study.name == "Knee");
  CHECK(study.volume == folder / "body.nrrd");
  CHECK(study.bones == std::vector<double>{3, 4});
  REQUIRE(study.spacings.size() == 2);
  CHECK(study.spacings[0] == 1.5);
  CHECK_FALSE(study.spacings[1].has_value());
  CHECK(study.techniques == std::vector<Technique>{{"dqs"}, {"fem", true}});
  CHECK(study.poses[1].flex == std::vector<std::string>{"Shin=60", "Foot=-10"});
  CHECK(study.poses[2].body.name == "sit");
  CHECK(study.poses[2].body.joints == std::vector<std::string>{"left elbow flexion=30"});
  CHECK(study.gates.tissue_percent == 0.5);
  CHECK(study.gates.least_voxels == 500);
  CHECK(study.repeats == 1);
  CHECK(cells_of(study).size() == 12);

  std::ofstream(folder / "short.json") << R"({"phantom": "arm", "poses": [{"name": "rest"}]})";
  const Study few = read_study(folder / "short.json");
  CHECK(few.name == "short");
  CHECK(cells_of(few).size() == 4);
}

TEST_CASE("study: its own JSON describes it again, with volumes that are ready at some spacings") {
  const test::TemporaryFolder folder;
  for (const char* file : {"v.nrrd", "v2.nrrd", "r.json", "p.json"}) std::ofstream(folder / file) << "x";
  std::ofstream(folder / "study.json") << R"({"volume": "v.nrrd", "rig": "r.json", "spacings_mm": [2, 4], "repeats": 7,
    "volumes": [{"spacing_mm": 2, "volume": "v2.nrrd"}], "poses": [{"name": "a", "pose": "p.json"}]})";
  const Study study = read_study(folder / "study.json");
  CHECK(study.ready.at(2) == folder / "v2.nrrd");
  CHECK(study.repeats == 7);
  std::ofstream(folder / "again.json") << to_json(study);
  CHECK(to_json(read_study(folder / "again.json")) == to_json(study));
}

TEST_CASE("study: each method has a mass-exact variant, which is there only where it is asked for") {
  for (const Technique& technique : paper_study().techniques) CHECK_FALSE(technique.mass_exact);
  std::vector<std::string> words;
  for (const Technique& technique : plain_techniques()) {
    words.push_back(word_of(technique));
    words.push_back(words.back() + "-mass-exact");
  }
  CHECK(words.size() == 2 * (deformation_methods().size() + 1));
  const std::vector<Technique> all = techniques_of(words, "");
  REQUIRE(all.size() == words.size());
  for (std::size_t i = 0; i < all.size(); ++i) {
    CHECK(word_of(all[i]) == words[i]);
    CHECK(all[i].mass_exact == (i % 2 == 1));
    CHECK(all[i].plain() == all[i - i % 2]);
  }
  CHECK(title_of(techniques_of({"fem-contact-mass-exact"}, "")[0]) == "FEM with contact, mass-exact");
  CHECK_THROWS_AS(techniques_of({"lbs-contact"}, ""), Error);
}

TEST_CASE(
    "study: cells are kept by the sources that compute them: a change of any of them is another hash, the order in "
    "which they are named is not") {
  CHECK(std::string(computing_sources()).size() == 64);
  if (!test::has_program("cmake")) {
    MESSAGE("SKIPPED: cmake is not installed");
    return;
  }
  const test::TemporaryFolder folder;
  const auto hash = [&](const std::string& a, const std::string& b, const std::string& files) {
    std::ofstream(folder / "a.h") << a;
    std::ofstream(folder / "b.cpp") << b;
    REQUIRE(test::run_program("cmake", {"-DFOLDER=" + folder.path().string(), "-DOUT=" + (folder / "out.cpp").string(),
                                        "-DFILES=" + files, "-P", LIMBER_SOURCE_DIR "/core/batch/hash_sources.cmake"})
                .exit_code == 0);
    return read_file(folder / "out.cpp");
  };
  const std::string first = hash("int a;", "int b;", "a.h,b.cpp");
  CHECK(hash("int a;", "int b;", "b.cpp,a.h") == first);
  CHECK(hash("int a; ", "int b;", "a.h,b.cpp") != first);
  CHECK(hash("int b;", "int a;", "a.h,b.cpp") != first);
  CHECK(hash("int a;", "int b;", "a.h") != first);
}

TEST_CASE("study: the file that says how to cite the program has its version") {
  CHECK(read_file(LIMBER_SOURCE_DIR "/assets/CITATION.cff").find("\nversion: " LIMBER_VERSION "\n") !=
        std::string::npos);
}

TEST_CASE("study: a description that is wrong is refused in one line that names the key") {
  const test::TemporaryFolder folder;
  std::ofstream(folder / "v.nrrd") << "x";
  std::ofstream(folder / "r.json") << "x";
  const std::string body = R"("volume": "v.nrrd", "rig": "r.json")", pose = R"("poses": [{"name": "a"}])";
  for (const auto& [text, named] : std::vector<std::pair<std::string, std::string>>{
           {"", "not a description"},
           {"[]", "not a description"},
           {"{", "not a description"},
           {"{}", "one body"},
           {R"({"volume": "v.nrrd", )" + pose + "}", "rig"},
           {R"({"volume": "none.nrrd", "rig": "r.json", )" + pose + "}", "none.nrrd"},
           {R"({"phantom": "leg", )" + pose + "}", "leg"},
           {R"({"phantom": "arm", "rig": "r.json", )" + pose + "}", "phantom"},
           {"{" + body + "}", "no poses"},
           {"{" + body + R"(, "poses": []})", "poses"},
           {"{" + body + R"(, "poses": [{}]})", "number 1"},
           {"{" + body + R"(, "poses": [{"name": "a"}, {"name": "a"}]})", "twice"},
           {"{" + body + R"(, "poses": [{"name": "a", "bend": 3}]})", "bend"},
           {"{" + body + R"(, "poses": [{"name": "a", "frame": 3}]})", "motion"},
           {"{" + body + R"(, "poses": [{"name": "a", "flex": [3]}]})", "flex"},
           {"{" + body + R"(, "poses": [{"name": "a", "flex": "Shin"}]})", "Shin"},
           {"{" + body + R"(, "poses": [{"name": "a", "flex": ["Shin=20", "Shin=nan"]}]})", "Shin=nan"},
           {"{" + body + R"(, "poses": [{"name": "a", "flex": "Shin=1e308"}]})", "Shin=1e308"},
           {"{" + body + R"(, "poses": [{"name": "a", "pose_name": "lie"}]})", "arms-up"},
           {"{" + body + R"(, "poses": [{"name": "a", "joints": ["left hip curl=3"]}]})", "abduction"},
           {"{" + body + R"(, "poses": [{"name": "a", "pose_name": "sit", "pose": "v.nrrd"}]})", "pose_name"},
           {"{" + body + ", " + pose + R"(, "methods": ["spline"]})", "spline"},
           {"{" + body + ", " + pose + R"(, "methods": ["fem-mass"]})", "fem-mass"},
           {"{" + body + ", " + pose + R"(, "methods": ["fem", "dqs", "fem"]})", "twice"},
           {"{" + body + ", " + pose + R"(, "methods": ["dqs-mass-exact"], "nearest": true})", "nearest"},
           {"{" + body + ", " + pose + R"(, "spacings_mm": [0]})", "spacings_mm"},
           {"{" + body + ", " + pose + R"(, "spacings_mm": [2, 2]})", "twice"},
           {"{" + body + ", " + pose + R"(, "spacings_mm": "2"})", "spacings_mm"},
           {"{" + body + ", " + pose + R"(, "gates": {"mass": 1}})", "mass"},
           {"{" + body + ", " + pose + R"(, "colour": "red"})", "colour"},
           {"{" + body + ", " + pose + R"(, "fit_joints": "yes"})", "fit_joints"},
           {"{" + body + ", " + pose + R"(, "repeats": 0})", "repeats"},
           {"{" + body + ", " + pose + R"(, "repeats": 2.5})", "repeats"},
           {"{" + body + ", " + pose + R"(, "volumes": [{"spacing_mm": 2}]})", "spacing and a file"},
           {"{" + body + ", " + pose + R"(, "volumes": [{"spacing_mm": 2, "volume": "none.nrrd"}]})", "none.nrrd"},
           {"{" + body + ", " + pose +
                R"(, "volumes": [{"spacing_mm": 2, "volume": "v.nrrd"}, {"spacing_mm": 2, "volume": "v.nrrd"}]})",
            "twice"},
           {R"({"phantom": "arm", "volumes": [{"spacing_mm": 2, "volume": "v.nrrd"}], )" + pose + "}", "phantom"},
       }) {
    std::ofstream(folder / "study.json") << text;
    std::string said;
    try {
      read_study(folder / "study.json");
    } catch (const Error& error) {
      said = error.what();
    }
    INFO(text, " -> ", said);
    CHECK(said.find(named) != std::string::npos);
    CHECK(said.find("study.json") != std::string::npos);
    CHECK(said.find('\n') == std::string::npos);
  }
}
