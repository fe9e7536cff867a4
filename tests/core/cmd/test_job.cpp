// SPDX-License-Identifier: AGPL-3.0-or-later
#include <algorithm>
#include <fstream>

#include <doctest/doctest.h>

#include "core/base/file.h"
#include "tests/support/program.h"

using namespace limber;
using namespace limber::test;

TEST_CASE("job: a resampling described in a file gives the same bytes as the command line, paths relative to the job") {
  const TemporaryFolder folder;
  REQUIRE(run_limber({"phantom", "arm", "--spacing", "8", "-o", folder.path()}).exit_code == 0);
  const std::string volume = folder / "volume.nrrd", rig = folder / "rig.json", tissues = folder / "tissues.json";
  const auto direct = run_limber({"resample", volume, "--rig", rig, "--tissues", tissues, "--flex", "Forearm=60",
                                  "--flex", "IndexProximal=20", "--method", "dqs", "-o", folder / "direct.nrrd"});
  INFO(direct.err);
  REQUIRE(direct.exit_code == 0);

  std::ofstream(folder / "job.json")
      << R"({"command": "resample", "volume": "volume.nrrd", "rig": "rig.json", "tissues": "tissues.json",
    "flex": ["Forearm=60", "IndexProximal=20"], "method": "dqs", "nearest": false, "output": "job.nrrd"})";
  const auto job = run_limber({"job", folder / "job.json"});
  INFO(job.err);
  REQUIRE(job.exit_code == 0);
  CHECK(read_file(folder / "job.nrrd") == read_file(folder / "direct.nrrd"));
}

TEST_CASE("job: poses by joints' names are given as in a report") {
  const TemporaryFolder folder;
  REQUIRE(run_limber({"phantom", "arm", "--spacing", "8", "-o", folder.path()}).exit_code == 0);
  const std::string volume = folder / "volume.nrrd", rig = folder / "rig.json", tissues = folder / "tissues.json";
  const auto direct =
      run_limber({"resample", volume, "--rig", rig, "--tissues", tissues, "--pose-name", "sit", "--joint",
                  "elbow flexion=40", "--joint", "index flexion=20", "--method", "dqs", "-o", folder / "direct.nrrd"});
  INFO(direct.err);
  REQUIRE(direct.exit_code == 0);

  std::ofstream(folder / "job.json")
      << R"({"command": "resample", "volume": "volume.nrrd", "rig": "rig.json", "tissues": "tissues.json",
    "pose_name": "sit", "joints": ["elbow flexion=40", "index flexion=20"], "method": "dqs", "output": "job.nrrd"})";
  const auto job = run_limber({"job", folder / "job.json"});
  INFO(job.err);
  REQUIRE(job.exit_code == 0);
  CHECK(read_file(folder / "job.nrrd") == read_file(folder / "direct.nrrd"));
}

TEST_CASE("job: what is not a job, or asks for what resample does not know, is refused in one line") {
  const TemporaryFolder folder;
  for (const char* text :
       {"", "[]", "{", R"({"command": "resample"})", R"({"command": "format", "volume": "a"})",
        R"({"command": "resample", "volume": "a", "no-such": 1})",
        R"({"command": "resample", "volume": "a", "rig": {}})", R"({"command": 1, "volume": "a"})"}) {
    std::ofstream(folder / "job.json") << text;
    const auto run = run_limber({"job", folder / "job.json"});
    INFO(text, " -> ", run.err);
    CHECK(run.exit_code == 1);
    CHECK(run.err.starts_with("limber: "));
    CHECK(std::count(run.err.begin(), run.err.end(), '\n') == 1);
  }
}
