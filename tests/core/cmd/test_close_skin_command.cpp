// SPDX-License-Identifier: AGPL-3.0-or-later
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include "core/volume_io/volume_io.h"
#include "tests/support/program.h"

using namespace limber;
using namespace limber::test;

namespace {

// A ball of flesh (2) around bone (3), with skin (1) around its middle only. The ball touches the lowest z of the
// volume.
LabelVolume ball() {
  LabelVolume volume{{{24, 24, 20}, glm::dvec3(2), glm::dvec3(0), glm::dmat3(1)}, {}};
  volume.voxels = ZeroedVector<Label>(volume.grid.voxel_count());
  glm::ivec3 v;
  for (v.z = 0; v.z < 20; ++v.z)
    for (v.y = 0; v.y < 24; ++v.y)
      for (v.x = 0; v.x < 24; ++v.x) {
        const double r = glm::length(glm::dvec3(v) - glm::dvec3(12, 12, 7));
        if (r < 7.6) volume.at(v) = r < 3 ? 3 : v.z == 7 && r > 6.5 ? 1 : 2;
      }
  return volume;
}

struct Ball {
  TemporaryFolder folder;
  std::string volume = folder / "ball.nrrd", tissues = folder / "tissues.json", out = folder / "out.nrrd";

  explicit Ball(const std::string& table) {
    write_volume(ball(), volume, {}, {"NRRD", "uint8", true});
    std::ofstream(tissues) << table;
  }
  ProgramRun close(const std::vector<std::string>& more) const {
    std::vector<std::string> words{"prepare", volume, "--tissues", tissues, "-o", out};
    words.insert(words.end(), more.begin(), more.end());
    return run_limber(words);
  }
};

}  // namespace

TEST_CASE(
    "prepare: --close-skin says how many voxels of which tissue became skin, and grows the volume where it must") {
  const Ball body(R"({"1": "skin", "2": "muscle", "3": "femur"})");
  const ProgramRun inward = body.close({"--close-skin", "inward"});
  REQUIRE_MESSAGE(inward.exit_code == 0, inward.err);
  CHECK(inward.out.find("voxels of flesh at the air became skin (muscle ") != std::string::npos);
  CHECK(read_volume(body.out).volume.grid.size == glm::ivec3(24, 24, 20));
  CHECK(read_volume(body.out).volume.at({12, 12, 0}) == 1);

  const ProgramRun outward = body.close({"--close-skin", "outward"});
  REQUIRE_MESSAGE(outward.exit_code == 0, outward.err);
  CHECK(outward.out.find("voxels of air became skin, over voxels of muscle ") != std::string::npos);
  CHECK(outward.out.find("the volume was grown by one voxel on every side") != std::string::npos);
  CHECK(read_volume(body.out).volume.grid.size == glm::ivec3(26, 26, 22));
}

TEST_CASE("prepare: --close-skin warns where the volume's border cuts the body") {
  const Ball body(R"({"1": "skin", "2": "muscle", "3": "femur"})");
  LabelVolume post = ball();
  glm::ivec3 v;
  for (v.z = 0; v.z < 20; ++v.z)
    for (v.y = 10; v.y < 14; ++v.y)
      for (v.x = 10; v.x < 14; ++v.x) post.at(v) = 2;
  write_volume(post, body.volume, {}, {"NRRD", "uint8", true});
  const ProgramRun run = body.close({"--close-skin", "inward"});
  CHECK(run.exit_code == 0);
  CHECK(run.err.find("cut by the volume's border at the highest z (16 voxels that are not skin)") != std::string::npos);
  CHECK(read_volume(body.out).volume.at({12, 12, 19}) == 2);
}

TEST_CASE("prepare: without a label of skin --close-skin is refused in one line, and --skin-label names one" *
          doctest::test_suite("slow")) {
  const Ball body(R"({"1": "fat", "2": "muscle", "3": "femur"})");
  const auto refused = [&](const std::vector<std::string>& more, int code = 1) {
    const ProgramRun run = body.close(more);
    CAPTURE(run.err);
    CHECK(run.exit_code == code);
    if (code == 1) CHECK(std::count(run.err.begin(), run.err.end(), '\n') == 1);
    CHECK_FALSE(std::filesystem::exists(body.out));
  };
  refused({"--close-skin", "inward"});
  refused({"--close-skin", "inward", "--skin-label", "femur"});
  refused({"--close-skin", "inward", "--skin-label", "no such"});
  refused({"--close-skin", "inward", "--skin-label", "-3"});
  refused({"--close-skin", "sideways"}, 2);
  refused({"--skin-label", "9"}, 2);
  for (const char* label : {"9", "300", "fat", "1"}) {
    const ProgramRun run = body.close({"--close-skin", "outward", "--skin-label", label});
    CHECK_MESSAGE(run.exit_code == 0, run.err);
    const VolumeFile file = read_volume(body.out);
    const double value = *label == 'f' ? 1 : std::stod(label);
    REQUIRE(file.tissues.find_file_value(value));
    CHECK(file.volume.at({13, 13, 0}) == file.tissues.find_file_value(value)->label);
    std::filesystem::remove(body.out);
  }
}
