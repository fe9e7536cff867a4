// SPDX-License-Identifier: AGPL-3.0-or-later
// Reads the written figures with other programs.
#include "editor/figure/write_figure.h"

#include <doctest/doctest.h>

#include "core/base/error.h"
#include "render/tiff.h"
#include "tests/support/program.h"

using namespace limber;
using namespace limber::editor;
using namespace limber::test;

namespace {

FigureLayout small_layout(const Lettering& lettering, FigureOptions::Paper paper) {
  FigureSource source;
  source.legend = [](const glm::ivec2&) {
    return std::vector<LegendEntry>{{"skin & fat", {0.9f, 0.6f, 0.5f}}, {"<bone>", {0.9f, 0.9f, 0.8f}}};
  };
  source.millimetres_per_pixel = [](const glm::ivec2&) { return 0.5; };
  FigureOptions options{
      .size = {60, 50}, .dots_per_inch = 200, .letter = "b", .title = "Gr\u00f6\u00dfe", .paper = paper};
  return figure_layout(options, source, lettering);
}

// Draws a disc of one colour with a soft edge on a transparent background.
render::Image disc(const glm::ivec2& size) {
  render::Image image{size, std::vector<std::uint8_t>(std::size_t(size.x) * size.y * 4)};
  for (int y = 0; y < size.y; ++y)
    for (int x = 0; x < size.x; ++x) {
      const double off = glm::length(glm::dvec2(x, y) + 0.5 - glm::dvec2(size) / 2.0) - size.y / 3.0;
      std::uint8_t* pixel = image.rgba.data() + (std::size_t(y) * size.x + x) * 4;
      pixel[0] = 200, pixel[1] = 90, pixel[2] = 40;
      pixel[3] = std::uint8_t(std::clamp(0.5 - off, 0.0, 1.0) * 255);
    }
  return image;
}

// Returns what ImageMagick's `identify` prints of a file.
std::string identified(const std::filesystem::path& path, const std::string& format) {
  const auto run = run_program("identify", {"-format", format, path.string()});
  INFO(run.err);
  CHECK(run.exit_code == 0);
  return run.out;
}

// Converts a picture to PNG by ImageMagick and reads it.
render::Image converted(const std::filesystem::path& path, const TemporaryFolder& folder) {
  const std::string png = (folder / "converted.png").string();
  const auto run = run_program("convert", {path.string(), "PNG32:" + png});
  INFO(run.err);
  REQUIRE(run.exit_code == 0);
  return render::read_png(png);
}

constexpr FigureOptions::Paper kPapers[] = {FigureOptions::Paper::White, FigureOptions::Paper::Black,
                                            FigureOptions::Paper::Transparent};

}  // namespace

TEST_CASE("figure file: PNG and TIFF have the figure's pixels and resolution, as ImageMagick reads them") {
  NEEDS_PROGRAM("identify");
  NEEDS_PROGRAM("convert");
  const TemporaryFolder folder;
  const Lettering lettering;
  for (const auto paper : kPapers) {
    const FigureLayout layout = small_layout(lettering, paper);
    const render::Image picture = disc(layout.picture_pixels), whole = figure_image(layout, picture, lettering);
    CHECK(whole.size == glm::ivec2(472, 394));
    for (const char* name : {"figure.png", "figure.tif"}) {
      INFO(name);
      write_figure(layout, picture, lettering, folder / name);
      const std::string told = identified(folder / name, "%w %h %x %U");
      int width = 0, height = 0;
      double resolution = 0;
      char unit[40] = "";
      REQUIRE(std::sscanf(told.c_str(), "%d %d %lf %39s", &width, &height, &resolution, unit) == 4);
      CHECK(glm::ivec2(width, height) == whole.size);
      CHECK(resolution * (std::string(unit) == "PixelsPerCentimeter" ? 2.54 : 1) == doctest::Approx(200).epsilon(1e-4));
      CHECK(converted(folder / name, folder).rgba == whole.rgba);
    }
  }
}

TEST_CASE("figure file: a TIFF of any size keeps every pixel, with opacity only where it is needed") {
  NEEDS_PROGRAM("convert");
  const TemporaryFolder folder;
  for (const glm::ivec2 size : {glm::ivec2(1, 1), glm::ivec2(7, 63), glm::ivec2(130, 64), glm::ivec2(33, 129)})
    for (const bool opaque : {true, false}) {
      render::Image image{size, std::vector<std::uint8_t>(std::size_t(size.x) * size.y * 4)};
      for (std::size_t i = 0; i < image.rgba.size(); ++i)
        image.rgba[i] = opaque && i % 4 == 3 ? 255 : std::uint8_t(i * 2654435761u >> 13);
      if (!opaque) image.rgba[3] = 100;
      const std::string bytes = render::tiff_of(image, 300);
      write_file_atomically(folder / "a.tif", bytes);
      INFO(size.x, " x ", size.y);
      CHECK(converted(folder / "a.tif", folder).rgba == image.rgba);
      // Tag 338 (ExtraSamples) describes the alpha channel.
      CHECK((bytes.find(std::string("\x52\x01\x03\x00", 4)) == std::string::npos) == opaque);
    }
}

TEST_CASE("figure file: an SVG drawn by librsvg is the figure, with real text and the size in millimetres") {
  NEEDS_PROGRAM("rsvg-convert");
  const TemporaryFolder folder;
  const Lettering lettering;
  for (const auto paper : kPapers) {
    const FigureLayout layout = small_layout(lettering, paper);
    const render::Image picture = disc(layout.picture_pixels), whole = figure_image(layout, picture, lettering);
    const std::filesystem::path svg = folder / "figure.svg", png = folder / "figure.png";
    write_figure(layout, picture, lettering, svg);
    const std::string text = read_file(svg);
    CHECK(text.find("width=\"60mm\" height=\"50mm\"") != std::string::npos);
    CHECK(text.find(">skin &amp; fat</text>") != std::string::npos);
    CHECK(text.find(">&lt;bone&gt;</text>") != std::string::npos);
    const auto run = run_program("rsvg-convert", {"-w", std::to_string(whole.size.x), "-h",
                                                  std::to_string(whole.size.y), svg.string(), "-o", png.string()});
    INFO(run.err);
    REQUIRE(run.exit_code == 0);
    const render::Image drawn = render::read_png(png);
    REQUIRE(drawn.size == whole.size);
    double sum = 0;
    int far = 0;
    for (std::size_t i = 0; i < whole.rgba.size(); i += 4)
      for (std::size_t c = i; c < i + 3; ++c) {  // compares colours as they look on grey paper
        const auto seen = [&](const render::Image& image) {
          return (image.rgba[c] * image.rgba[i + 3] + 128 * (255 - image.rgba[i + 3])) / 255.0;
        };
        const double apart = std::abs(seen(whole) - seen(drawn));
        sum += apart;
        far += apart > 100;
      }
    INFO("mean difference ", sum / double(whole.rgba.size()), ", ", far, " channels far apart");
    CHECK(sum / double(whole.rgba.size()) < 1.5);
    CHECK(far < 0.01 * double(whole.rgba.size()));
  }
}

TEST_CASE("figure file: characters that XML forbids do not reach an SVG") {
  const TemporaryFolder folder;
  const Lettering lettering;
  FigureSource source;
  source.legend = [](const glm::ivec2&) {
    return std::vector<LegendEntry>{{"A\uffffB\ufffeC\x01\x0b\ufffdD\u0416", glm::vec3(0.5f)}};
  };
  source.millimetres_per_pixel = [](const glm::ivec2&) { return 0.5; };
  const FigureLayout layout = figure_layout({.size = {60, 50}, .dots_per_inch = 100}, source, lettering);
  write_figure(layout, disc(layout.picture_pixels), lettering, folder / "figure.svg");
  const std::string text = read_file(folder / "figure.svg");
  CHECK(text.find(">A\ufffdB\ufffdC \ufffdD\u0416</text>") != std::string::npos);
}

TEST_CASE("figure file: names that are not UTF-8 leave an SVG that other programs read") {
  NEEDS_PROGRAM("rsvg-convert");
  const TemporaryFolder folder;
  const Lettering lettering;
  FigureSource source;
  source.legend = [](const glm::ivec2&) {
    return std::vector<LegendEntry>{
        {"Gr\xf6\xdf"
         "e",
         glm::vec3(0.5f)}};
  };
  source.millimetres_per_pixel = [](const glm::ivec2&) { return 0.5; };
  const FigureLayout layout = figure_layout({.size = {60, 50}, .dots_per_inch = 100}, source, lettering);
  write_figure(layout, disc(layout.picture_pixels), lettering, folder / "figure.svg");
  CHECK(read_file(folder / "figure.svg").find(">Gr\ufffd\ufffde</text>") != std::string::npos);
  const auto run =
      run_program("rsvg-convert", {(folder / "figure.svg").string(), "-o", (folder / "figure.png").string()});
  INFO(run.err);
  CHECK(run.exit_code == 0);
}

TEST_CASE("figure file: another ending is refused in one line") {
  CHECK_THROWS_AS(check_figure_path("figure.jpg"), Error);
  CHECK_THROWS_AS(check_figure_path("figure"), Error);
  CHECK_NOTHROW(check_figure_path("figure.TIFF"));
}
