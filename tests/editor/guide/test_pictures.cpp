// SPDX-License-Identifier: AGPL-3.0-or-later
// Tests the pictures of the user guide. The script assets/docs/guide/scripts/NAME.play makes the picture
// assets/docs/guide/images/NAME.png. Scripts play in a folder with bodies that the program makes:
//   limber phantom arm --spacing 3 -o arm
//   limber phantom body --spacing 6 -o body
//
// The test plays every script with coarse bodies, which takes a fraction of the time, and checks that it shows about
// the same as the stored picture: the same window, workspace and view. Pictures are compared by the tile that differs
// most, because most of any picture is background. `./run pictures` makes the pictures again with fine bodies; look at
// each one that changed.
#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <map>

#include "core/base/file.h"
#include "editor/ui/messages.h"
#include "render/image_io.h"
#include "tests/editor/sitting.h"

using namespace limber;
using namespace limber::editor;
using namespace limber::test;
using render::Image;
namespace fs = std::filesystem;

namespace {

constexpr glm::ivec2 kWindow{960, 600};
constexpr int kTile = 60;  // pixels; both sides of the window are multiples of it
// Limit of the mean colour difference, 0 to 255, in the tile that differs most. Coarse bodies differ by up
// to 37, pictures of other scenes by 45 to 128.
constexpr double kMostInTile = 41;
const fs::path kGuide = fs::path(LIMBER_SOURCE_DIR) / "assets/docs/guide";

enum class Bodies { Coarse, Fine };

// Rounds colours to steps of four, which makes small files.
Image in_steps(Image image) {
  for (std::size_t i = 0; i < image.rgba.size(); ++i)
    image.rgba[i] = static_cast<std::uint8_t>(i % 4 == 3 ? 255 : std::min(255, (image.rgba[i] + 2) / 4 * 4));
  return image;
}

// Returns the mean difference of colours, 0 to 255, in the tile where it is largest.
double worst_tile(const Image& a, const Image& b) {
  if (a.size != b.size || a.size != kWindow) return 255;
  std::map<std::pair<int, int>, double> sums;
  for (int y = 0; y < a.size.y; ++y)
    for (int x = 0; x < a.size.x; ++x)
      for (int c = 0; c < 3; ++c) {
        const std::size_t i = (static_cast<std::size_t>(y) * a.size.x + x) * 4 + c;
        sums[{x / kTile, y / kTile}] += std::abs(int(a.rgba[i]) - int(b.rgba[i]));
      }
  double worst = 0;
  for (const auto& [tile, sum] : sums) worst = std::max(worst, sum / (kTile * kTile * 3));
  return worst;
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
  sitting.editor().background->worker_program = LIMBER_PROGRAM;
  sitting.editor().preferences->reduce_motion = true;
  if (bodies == Bodies::Fine) sitting.editor().views->renderer.average_at_rest(6);
  sitting.editor().views->renderer.light_at_rest(render::Light::Draft);
  std::vector<ScriptLine> lines = parse_script(script);
  // Messages disappear after seconds. A coarse picture need not wait for that.
  const auto is_wait = [](const ScriptLine& line) { return line.words[0] == "wait"; };
  if (const auto wait = std::find_if(lines.begin(), lines.end(), is_wait);
      bodies == Bodies::Coarse && wait != lines.end()) {
    sitting.test.player.play({lines.begin(), wait}, home.folder.path());
    sitting.editor().messages->toasts.clear();
    lines.erase(lines.begin(), wait + 1);
  }
  sitting.test.player.play(lines, home.folder.path());
  return in_steps(render::read_png(home / (name + ".png")));
}

}  // namespace

TEST_CASE("guide pictures: each script plays, and shows about what its kept picture shows, and no other one") {
  const bool renew = std::getenv("LIMBER_GOLDEN_REFRESH") != nullptr;
  std::map<std::string, Image> kept;
  for (const auto& entry : fs::directory_iterator(kGuide / "scripts")) {
    const std::string name = entry.path().stem().string();
    const fs::path file = kGuide / "images" / (name + ".png");
    if (renew) render::write_png(picture_of(name, Bodies::Fine), file);
    kept[name] = render::read_png(file);
  }
  CHECK(kept.size() >= 8);
  for (const auto& [name, picture] : kept) {
    INFO(name);
    const Image played = picture_of(name, Bodies::Coarse);
    const double own = worst_tile(played, picture);
    CHECK(own < kMostInTile);
    for (const auto& [other, shown] : kept)
      if (other != name) CHECK_MESSAGE(worst_tile(played, shown) > own, "it looks like ", other);
  }
}
