// SPDX-License-Identifier: AGPL-3.0-or-later
// Every reader refuses JSON that is nested too deeply or that holds a key twice, with an error of one line.
#include "core/base/json_text.h"

#include <doctest/doctest.h>

#include "core/base/file.h"
#include "core/phantom/phantom.h"
#include "core/rig_io/rig_io.h"
#include "core/volume_io/volume_io.h"
#include "tests/support/program.h"

using namespace limber;
using namespace limber::test;

namespace {
std::string nested(int depth, const std::string& open = "[", const std::string& close = "]") {
  std::string text;
  for (int i = 0; i < depth; ++i) text += open;
  for (int i = 0; i < depth; ++i) text += close;
  return text;
}
}  // namespace

TEST_CASE("JSON text: what is nested too deeply or names a key twice has a problem, whatever else has none") {
  CHECK(json_problem(nested(kDeepestJson)).empty());
  CHECK(json_problem(nested(kDeepestJson + 1)).find("nested more than 64 levels") != std::string::npos);
  CHECK(json_problem(nested(1'000'000)).find("nested") != std::string::npos);
  CHECK(json_problem(nested(1'000'000, "{\"a\":[", "]}")).find("nested") != std::string::npos);
  CHECK(json_problem(R"({"a": 1, "b": {"a": 2}, "c": [{"a": 3}, {"a": 4}]})").empty());
  CHECK(json_problem(R"({"b": {"a": 2, "\u0061": 3}})") == "the key \"a\" occurs twice in one object");
  CHECK(json_problem("{\"a\": ").empty());  // json_problem leaves incomplete JSON to the parser, which reports it
  CHECK(json_problem("").empty());
  CHECK(sound_json(nested(1000)) == "");
  CHECK_THROWS_WITH(checked_json(nested(1000), "rig.json"),
                    "the JSON is nested more than 64 levels deep: rig.json: correct the file");
}

TEST_CASE("JSON text: every command refuses a file that is nested a million deep, and a key that is there twice" *
          doctest::test_suite("slow")) {
  const TemporaryFolder folder;
  const Phantom phantom = make_arm_phantom(10);
  write_volume(phantom.volume, folder / "volume.nrrd", phantom.tissues);
  write_armature(phantom.armature, folder / "rig.json");
  write_bvh(phantom.motion, folder / "motion.bvh");
  const std::string volume = folder / "volume.nrrd", rig = folder / "rig.json", motion = folder / "motion.bvh",
                    bad = folder / "bad.json";
  const std::string deep = nested(1'000'000), out = folder / "out.nrrd";
  const std::vector<std::vector<std::string>> commands = {
      {"info", bad},
      {"fk", bad},
      {"job", bad},
      {"skin-points", bad, "--method", "lbs"},
      {"experiment", bad, "-o", folder / "study"},
      {"convert", bad, folder / "rig2.json"},
      {"weights", volume, "--rig", bad, "-o", out},
      {"weights", volume, "--rig", rig, "--tissues", bad, "-o", out},
      {"weights", volume, "--rig", rig, "--bone-map", bad, "-o", out},
      {"fk", rig, "--pose", bad},
      {"fk", rig, "--motion", motion, "--map", bad},
      {"fit-rig", volume, "--template", bad, "-o", folder / "rig3.json"},
  };
  for (const std::string& text :
       {deep, "{\"bones\": " + deep + ", \"schema\": " + deep + ", \"command\": " + deep + ", \"1\": " + deep + "}",
        std::string(
            R"({"bones": [], "bones": {}, "command": "x", "command": "y", "schema": "a", "schema": "b", "1": "Skin",
             "1": "Fat", "name": "a", "name": "b"})")}) {
    write_file_atomically(bad, text);
    for (const auto& words : commands) {
      const ProgramRun run = run_limber(words);
      CAPTURE(words[0]);
      CAPTURE(words.back());
      CAPTURE(text.substr(0, 60));
      CAPTURE(run.err);
      CHECK(run.exit_code == 1);
      CHECK(std::count(run.err.begin(), run.err.end(), '\n') == 1);
      CHECK(run.err.find("internal error") == std::string::npos);
      CHECK(run.peak_mb < 300);
    }
  }
}
