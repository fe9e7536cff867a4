// SPDX-License-Identifier: AGPL-3.0-or-later
// The pictures of the user guide are what the scripts of the same names show: assets/docs/guide/scripts/NAME.play makes
// assets/docs/guide/images/NAME.png. The scripts play in a folder with bodies that the program makes:
//   limber phantom arm --spacing 3 -o arm
//   limber phantom body --spacing 6 -o body
//
// The test plays every script with coarse bodies, which takes a fraction of the time, and checks that it shows about
// what the kept picture shows: the same window, workspace and view. `./run pictures` makes the pictures anew, with fine
// bodies; look at each one that changed.
#include <cstdlib>
#include <filesystem>

#include "core/base/file.h"
#include "render/image_io.h"
#include "tests/editor/sitting.h"

using namespace limber;
using namespace limber::editor;
using namespace limber::test;
using render::Image;
namespace fs = std::filesystem;

namespace {

constexpr glm::ivec2 kWindow{960, 600};
constexpr double kMostMean = 6;  // of 255: coarse bodies give up to 3, another workspace or an open dialog 10 and more
const fs::path kGuide = fs::path(LIMBER_SOURCE_DIR) / "assets/docs/guide";

enum class Bodies { Coarse, Fine };

// Colours in steps of four make small files.
Image in_steps(Image image) {
  for (std::size_t i = 0; i < image.rgba.size(); ++i)
    image.rgba[i] = static_cast<std::uint8_t>(i % 4 == 3 ? 255 : std::min(255, (image.rgba[i] + 2) / 4 * 4));
  return image;
}

double mean_difference(const Image& a, const Image& b) {
  if (a.size != b.size) return 255;
  double sum = 0;
  for (std::size_t i = 0; i < a.rgba.size(); ++i) sum += std::abs(int(a.rgba[i]) - int(b.rgba[i]));
  return sum / (static_cast<double>(a.size.x) * a.size.y * 3);
}

Image picture_of(const std::string& name, Bodies bodies) {
  const Home home;
  const std::string script = read_file(kGuide / "scripts" / (name + ".play"));
  for (const auto& [subject, fine, coarse] : {std::tuple{"arm", "3", "5"}, {"body", "6", "10"}})
    if (script.find(std::string("drop ") + subject) != std::string::npos)
      REQUIRE(
          run_limber({"phantom", subject, "--spacing", bodies == Bodies::Fine ? fine : coarse, "-o", home / subject})
              .exit_code == 0);

  Sitting sitting(home.folder.path(), {}, kWindow);
  sitting.editor().worker_program = LIMBER_PROGRAM;
  sitting.editor().preferences.reduce_motion = true;
  if (bodies == Bodies::Fine) sitting.editor().views->renderer.average_at_rest(6);
  sitting.editor().views->renderer.light_at_rest(render::Light::Draft);
  std::vector<ScriptLine> lines = parse_script(script);
  // Messages take seconds to disappear, which a coarse picture need not wait for.
  if (bodies == Bodies::Coarse) std::erase_if(lines, [](const ScriptLine& line) { return line.words[0] == "wait"; });
  sitting.test.player.play(lines, home.folder.path());
  return in_steps(render::read_png(home / (name + ".png")));
}

}  // namespace

TEST_CASE("guide pictures: each script plays, and shows about what the kept picture shows") {
  const bool renew = std::getenv("LIMBER_GOLDEN_REFRESH") != nullptr;
  int pictures = 0;
  for (const auto& entry : fs::directory_iterator(kGuide / "scripts")) {
    const std::string name = entry.path().stem().string();
    const fs::path kept = kGuide / "images" / (name + ".png");
    INFO(name);
    if (renew) render::write_png(picture_of(name, Bodies::Fine), kept);
    const double mean = mean_difference(picture_of(name, Bodies::Coarse), render::read_png(kept));
    CHECK(mean < kMostMean);
    ++pictures;
  }
  CHECK(pictures >= 8);
}
