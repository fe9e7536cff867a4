// SPDX-License-Identifier: AGPL-3.0-or-later
// Tests file names that are longer than the file system allows.
#include <fstream>
#include <string>

#include <doctest/doctest.h>

#include "tests/support/program.h"

using namespace limber::test;

TEST_CASE("long names: a name that no file can have is refused in one clear line, wherever it is given") {
  const TemporaryFolder folder;
  const std::string arm = (folder / "arm").string(), name(300, 'a'), out = (folder / "out.nrrd").string();
  REQUIRE(run_limber({"phantom", "arm", "--spacing", "6", "-o", arm}).exit_code == 0);
  const std::string volume = arm + "/volume.nrrd", rig = arm + "/rig.json";
  const std::string study = (folder / "study.json").string(), batch = (folder / "batch.json").string();
  std::ofstream(study) << R"({"volume": ")" << name << R"(.nrrd"})";
  std::ofstream(batch) << R"({"bodies": [{"name": "a", "volume": ")" << name << R"(.nrrd", "rig": "rig.json"}]})";
  const std::vector<std::vector<std::string>> lines = {
      {"info", name},
      {"info", name + ".raw"},
      {"info", name + ".json"},
      {"info", name + ".limber"},
      {"prepare", name + ".nrrd", "-o", out},
      {"prepare", volume, "-o", name + ".nrrd"},
      {"convert", volume, name + ".nii.gz"},
      {"weights", volume, "--rig", name + ".json", "-o", out},
      {"weights", volume, "--rig", rig, "--tissues", name + ".json", "-o", out},
      {"weights", volume, "--rig", rig, "-o", name + ".nrrd"},
      {"resample", volume, "--rig", rig, "--pose", name + ".json", "-o", out},
      {"resample", volume, "--rig", rig, "--weights", name + ".nrrd", "--flex", "Forearm=10", "-o", out},
      {"resample", volume, "--rig", rig, "--flex", "Forearm=10", "-o", out, "--report", name + ".json"},
      {"fk", name + ".bvh"},
      {"report", volume, name + ".nrrd"},
      {"project", name + ".limber", "create", volume},
      {"project", (folder / "p.limber").string(), "create", name + ".nrrd"},
      {"render", name + ".nrrd", "-o", (folder / "p.png").string()},
      {"experiment", study, "-o", (folder / "study").string()},
      {"batch", batch, "-o", (folder / "batch").string()},
  };
  for (const std::vector<std::string>& line : lines) {
    const ProgramRun run = run_limber(line);
    INFO(line[0], " ", line.size() > 2 ? line[2] : "", ": ", run.err);
    CHECK(run.exit_code == 1);
    CHECK(run.err.find("filesystem error") == std::string::npos);
    CHECK(run.err.find("internal error") == std::string::npos);
    CHECK(run.err.find(name) != std::string::npos);
    CHECK_FALSE(std::filesystem::exists(out));
  }
}
