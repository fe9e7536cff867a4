// SPDX-License-Identifier: AGPL-3.0-or-later
// Tests figures and videos that the command line makes.
#include <cstdlib>

#include <doctest/doctest.h>

#include "core/tissue/tissue_table.h"
#include "core/volume_io/volume_io.h"
#include "render/image_io.h"
#include "tests/support/program.h"

using namespace limber;
using namespace limber::test;

namespace {

// Writes four posts whose edges are 100 mm apart in x and in y. Each has one tissue above another.
std::string write_posts(const TemporaryFolder& folder) {
  LabelVolume volume;
  volume.grid.size = {65, 65, 60};
  volume.grid.spacing = glm::dvec3(2);
  volume.voxels.assign(static_cast<std::size_t>(volume.grid.voxel_count()), 0);
  for (int z = 5; z < 55; ++z)
    for (int y = 5; y < 60; ++y)
      for (int x = 5; x < 60; ++x)
        if ((x < 10 || x >= 55) && (y < 10 || y >= 55)) volume.at({x, y, z}) = z < 30 ? 1 : 2;
  TissueTable tissues;
  tissues.tissues = {{.label = 1, .file_value = 1, .name = "lower half", .colour = {0.2f, 0.4f, 0.9f}},
                     {.label = 2, .file_value = 2, .name = "upper half", .colour = {0.9f, 0.4f, 0.2f}}};
  const std::string path = (folder / "posts.nrrd").string();
  write_volume(volume, path, tissues, FileType{});
  return path;
}

// Returns true for pure black, which no shadow on the posts has.
bool is_ink(const render::Image& image, int x, int y) {
  const std::uint8_t* p = image.rgba.data() + (std::size_t(y) * image.size.x + x) * 4;
  return p[0] == 0 && p[1] == 0 && p[2] == 0;
}
bool is_colour(const render::Image& image, int x, int y) {
  const std::uint8_t* p = image.rgba.data() + (std::size_t(y) * image.size.x + x) * 4;
  return std::max({p[0], p[1], p[2]}) - std::min({p[0], p[1], p[2]}) > 40;
}

// Returns the length of the longest row of black pixels.
int bar_length(const render::Image& image) {
  int longest = 0;
  for (int y = 0; y < image.size.y; ++y)
    for (int x = 0, run = 0; x < image.size.x; ++x) {
      run = is_ink(image, x, y) ? run + 1 : 0;
      longest = std::max(longest, run);
    }
  return longest;
}

// Returns the distance in pixels between the left edges of two posts in the upper part of the picture.
int post_distance(const render::Image& image) {
  for (int y = image.size.y / 10; y < image.size.y / 2; ++y) {
    std::vector<int> edges;
    for (int x = 1; x < image.size.x; ++x)
      if (is_colour(image, x, y) && !is_colour(image, x - 1, y)) edges.push_back(x);
    if (edges.size() == 2) return edges[1] - edges[0];
  }
  return 0;
}

}  // namespace

TEST_CASE("render figure: the scale bar is as long as the same length of a body beside it, in 3D and in slices") {
  const TemporaryFolder folder;
  const std::string posts = write_posts(folder);
  for (const std::vector<std::string>& view : {std::vector<std::string>{"--orthographic"},
                                               {"--orthographic", "--view", "left", "--zoom", "0.6"},
                                               {"--slice", "axial"},
                                               {"--slice", "coronal", "--at", "15", "--zoom", "0.7"}})
    for (const char* dpi : {"150", "400"}) {
      const std::string png = (folder / "figure.png").string();
      std::vector<std::string> arguments = {"render", posts,   "-o", png,       "--figure",
                                            "80x80",  "--dpi", dpi,  "--title", "Posts"};
      arguments.insert(arguments.end(), view.begin(), view.end());
      const auto run = run_limber(arguments);
      INFO(view[0], " ", dpi, " dpi ", run.err);
      REQUIRE(run.exit_code == 0);
      const render::Image image = render::read_png(png);
      CHECK(image.size == glm::ivec2(std::lround(80 * std::atof(dpi) / 25.4)));
      const int posts_pixels = post_distance(image), bar_pixels = bar_length(image);
      // Finds the round length that the bar stands for: the other round lengths are at least twice or half of it.
      const double millimetres = 100.0 * bar_pixels / posts_pixels;
      const double round = millimetres > 35 ? 50 : millimetres > 15 ? 20 : 10;
      INFO("posts ", posts_pixels, " pixels, bar ", bar_pixels, " for ", round, " mm");
      CHECK(posts_pixels > 100);
      CHECK(std::abs(bar_pixels - round / 100 * posts_pixels) <= 1.0);
    }
}

TEST_CASE("render figure: the legend names the tissues that the picture shows, and no others") {
  const TemporaryFolder folder;
  const std::string posts = write_posts(folder), svg = (folder / "figure.svg").string();
  const auto drawn = [&](const std::vector<std::string>& more) {
    std::vector<std::string> arguments = {"render", posts, "-o", svg, "--figure", "80x80", "--shading", "draft"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const auto run = run_limber(arguments);
    INFO(run.err);
    REQUIRE(run.exit_code == 0);
    return read_file(svg);
  };
  const auto has = [](const std::string& text, const char* word) { return text.find(word) != std::string::npos; };
  const std::string both = drawn({}), top = drawn({"--view", "top", "--orthographic"}), hidden = drawn({"--hide", "2"}),
                    none = drawn({"--no-legend", "--no-scale-bar"});
  CHECK(has(both, "lower half"));
  CHECK(has(both, "upper half"));
  CHECK(has(both, "at the focus"));
  CHECK_FALSE(has(top, "lower half"));
  CHECK(has(top, "upper half"));
  CHECK_FALSE(has(top, "at the focus"));
  CHECK_FALSE(has(hidden, "upper half"));
  CHECK_FALSE(has(none, "half"));
  CHECK_FALSE(has(none, " mm"));
  CHECK(drawn({}) == both);
}

TEST_CASE("render figure: what cannot be made is refused in one line, and leaves no file") {
  const TemporaryFolder folder;
  const std::string posts = write_posts(folder);
  const auto fails = [&](const std::string& name, const std::vector<std::string>& more, int code) {
    std::vector<std::string> arguments = {"render", posts, "-o", (folder / name).string()};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const auto run = run_limber(arguments);
    INFO(name, ": ", run.err);
    CHECK(run.exit_code == code);
    CHECK(std::count(run.err.begin(), run.err.end(), '\n') >= 1);
    CHECK_FALSE(std::filesystem::exists(folder / name));
    return run.err;
  };
  fails("figure.jpg", {"--figure", "80x80"}, 1);
  fails("figure.png", {"--figure", "80"}, 1);
  fails("figure.png", {"--figure", "8000x80"}, 1);
  fails("figure.png", {"--figure", "800x800", "--dpi", "1200"}, 1);
  fails("figure.png", {"--figure", "80x80", "--size", "100x100"}, 2);
  fails("figure.png", {"--title", "without a figure"}, 2);
  for (const char* video : {"turn.mp4", "turn.MP4", "turn.WebM"}) {
    const auto names = [&](const std::vector<std::string>& more, const char* word) {
      return fails(video, more, 1).find(word) != std::string::npos;
    };
    CHECK(names({}, "add --turntable N"));
    CHECK(names({"--turntable", "6", "--transparent"}, "leave out --transparent"));
  }
}

TEST_CASE("render video: a turntable becomes a video through ffmpeg, and without it one line says so") {
  const TemporaryFolder folder;
  const std::string posts = write_posts(folder);
  for (const std::string name : {"turn.mp4", "turn.webm"}) {
    const std::string path = (folder / name).string();
    const auto run = run_limber(
        {"render", posts, "-o", path, "--turntable", "6", "--size", "161x121", "--shading", "draft", "--light"});
    INFO(run.err);
    if (!has_program("ffmpeg")) {
      CHECK(run.exit_code == 1);
      CHECK(run.err.find("ffmpeg, which is not installed") != std::string::npos);
      CHECK_FALSE(std::filesystem::exists(path));
      continue;
    }
    REQUIRE(run.exit_code == 0);
    const auto played =
        run_program("ffmpeg", {"-nostdin", "-loglevel", "error", "-i", path, (folder / (name + "-%d.png")).string()});
    INFO(played.err);
    CHECK(played.exit_code == 0);
    CHECK(std::filesystem::exists(folder / (name + "-6.png")));
    CHECK_FALSE(std::filesystem::exists(folder / (name + "-7.png")));
    const render::Image first = render::read_png(folder / (name + "-1.png")),
                        other = render::read_png(folder / (name + "-2.png"));
    CHECK(first.size == glm::ivec2(162, 122));
    CHECK(first.rgba != other.rgba);
    int orange = 0;  // pixels of the posts' upper halves
    for (std::size_t i = 0; i < first.rgba.size(); i += 4) orange += first.rgba[i] > first.rgba[i + 2] + 40;
    CHECK(orange > 100);
  }
}
