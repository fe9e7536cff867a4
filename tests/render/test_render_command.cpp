// SPDX-License-Identifier: AGPL-3.0-or-later
#include <algorithm>
#include <cstdlib>
#include <filesystem>

#include <epoxy/gl.h>

#include "core/project/project_io.h"
#include "core/volume_io/volume_io.h"
#include "render/gl/egl_context.h"
#include "render/image_io.h"
#include "tests/render/studio.h"
#include "tests/support/program.h"

namespace fs = std::filesystem;
using namespace limber;
using namespace limber::test;

namespace {

// A temporary folder with a small volume.
class Folder {
 public:
  Folder() {
    const auto volume = painted(grid_of({24, 24, 24}), [](const glm::dvec3& p) -> Label {
      return glm::length(p - glm::dvec3(12)) < 9 ? 7 : 0;
    });
    write_volume(*volume, folder_ / "ball.nrrd", TissueTable{{{.label = 7, .file_value = 7, .name = "ball"}}, "test"},
                 FileType{});
  }
  std::string operator/(const char* name) const { return (folder_ / name).string(); }

 private:
  TemporaryFolder folder_;
};

}  // namespace

TEST_CASE("render command: a picture has the size asked for, and shows the body before the background") {
  const Folder folder;
  const auto run = run_limber({"render", folder / "ball.nrrd", "-o", folder / "ball.png", "--size", "160x120"});
  CHECK(run.exit_code == 0);
  const render::Image image = render::read_png(folder / "ball.png");
  CHECK(image.size == glm::ivec2(160, 120));
  CHECK(pixel_of(image, {80, 60}) != pixel_of(image, {2, 60}));
}

TEST_CASE("render command: a turntable writes numbered pictures, a slice one") {
  const Folder folder;
  CHECK(run_limber({"render", folder / "ball.nrrd", "-o", folder / "turn.png", "--size", "64x64", "--turntable", "3",
                    "--display", "xray"})
            .exit_code == 0);
  for (const char* name : {"turn-0000.png", "turn-0001.png", "turn-0002.png"}) CHECK(fs::exists(folder / name));
  CHECK_FALSE(fs::exists(folder / "turn-0003.png"));
  CHECK(run_limber({"render", folder / "ball.nrrd", "-o", folder / "slice.png", "--size", "64x64", "--slice", "axial",
                    "--at", "12"})
            .exit_code == 0);
  CHECK(fs::exists(folder / "slice.png"));
}

TEST_CASE("render command: a project is drawn with what it hides") {
  const Folder folder;
  const auto body = painted(grid_of({24, 24, 24}), [](const glm::dvec3& p) -> Label {
    return glm::length(p - glm::dvec3(12)) < 9 ? (p.x < 12 ? 1 : 2) : 0;
  });
  auto tissues = std::make_shared<TissueTable>();
  tissues->tissues = {{.label = 1, .file_value = 1, .name = "one"}, {.label = 2, .file_value = 2, .name = "two"}};
  Project project;
  project.document.volume = body;
  project.document.tissues = tissues;
  Visibility visibility;
  visibility.looks[2].visible = false;
  project.document.visibility = std::make_shared<const Visibility>(visibility);
  DocumentWriter writer;
  create_project(project, folder / "body.limber", writer);
  const auto run =
      run_limber({"render", folder / "body.limber", "-o", folder / "body.png", "--size", "80x80", "--transparent"});
  INFO(run.err);
  REQUIRE(run.exit_code == 0);
  const render::Image image = render::read_png(folder / "body.png");
  CHECK(pixel_of(image, {30, 40}).a == 255);
  CHECK(pixel_of(image, {52, 40}).a == 0);
  CHECK(run_limber({"render", folder / "body.limber", "-o", folder / "none.png", "--rig", "x.json"}).exit_code == 1);
}

TEST_CASE(
    "render command: a pose is drawn by either method, as a preview from where the resampled volume is seen, and much "
    "like it") {
  const TemporaryFolder folder;
  const std::string arm = (folder / "arm").string();
  REQUIRE(run_limber({"phantom", "arm", "--spacing", "5", "-o", arm}).exit_code == 0);
  const auto picture = [&](const char* name, const std::vector<std::string>& more) {
    const std::string png = (folder / name).string();
    std::vector<std::string> arguments = {"render",
                                          arm + "/volume.nrrd",
                                          "--tissues",
                                          arm + "/tissues.json",
                                          "--rig",
                                          arm + "/rig.json",
                                          "--flex",
                                          "Forearm=50",
                                          "--size",
                                          "200x200",
                                          "--view",
                                          "left",
                                          "--armature",
                                          "none",
                                          "--transparent",
                                          "-o",
                                          png};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const auto run = run_limber(arguments);
    INFO(run.err);
    REQUIRE(run.exit_code == 0);
    return render::read_png(png);
  };
  for (const char* method : {"lbs", "dqs"}) {
    const render::Image whole = picture("whole.png", {"--method", method}),
                        preview = picture("preview.png", {"--method", method, "--preview"});
    int apart = 0;
    for (size_t i = 3; i < whole.rgba.size(); i += 4) apart += (whole.rgba[i] > 127) != (preview.rgba[i] > 127);
    CHECK(covered(whole) > 1000);
    CHECK(apart < covered(whole) / 50);  // voxels of 5 mm make the outlines differ a little
  }
}

TEST_CASE("render command: what cannot be drawn is refused in one line, and leaves no picture") {
  const Folder folder;
  const std::vector<std::vector<std::string>> requests = {
      {"--size", "0x10"},   {"--size", "99999x10"},          {"--size", "10"},     {"--hide", "99"},
      {"--opacity", "7=2"}, {"--clip-plane", "0,0,0,0,0,0"}, {"--flex", "Bone=20"}};
  for (const auto& request : requests) {
    std::vector<std::string> arguments = {"render", folder / "ball.nrrd", "-o", folder / "none.png"};
    arguments.insert(arguments.end(), request.begin(), request.end());
    const auto run = run_limber(arguments);
    INFO(request[0], " ", request[1]);
    CHECK(run.exit_code == 1);
    CHECK(run.err.starts_with("limber: "));
    CHECK(std::count(run.err.begin(), run.err.end(), '\n') == 1);
    CHECK_FALSE(fs::exists(folder / "none.png"));
  }
}

TEST_CASE("render command: a driver older than OpenGL 3.3 is named in one line") {
  // Only Mesa can simulate an older OpenGL version.
  const std::string driver = [] {
    const render::HeadlessContext context;
    return std::string(reinterpret_cast<const char*>(glGetString(GL_VERSION)));
  }();
  if (driver.find("Mesa") == std::string::npos) {
    MESSAGE("SKIPPED: the driver is ", driver);
    return;
  }
  const Folder folder;
  ::setenv("MESA_GL_VERSION_OVERRIDE", "3.0", 1);
  const auto run = run_limber({"render", folder / "ball.nrrd", "-o", folder / "none.png"});
  ::setenv("MESA_GL_VERSION_OVERRIDE", "3.3", 1);
  CHECK(run.exit_code == 1);
  CHECK(run.err.find("OpenGL 3.3") != std::string::npos);
  CHECK(std::count(run.err.begin(), run.err.end(), '\n') == 1);
}
