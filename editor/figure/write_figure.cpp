// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/figure/write_figure.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "core/base/error.h"
#include "core/base/utf8.h"
#include "core/study/text.h"
#include "render/tiff.h"

namespace limber::editor {

namespace {

using Paper = FigureOptions::Paper;

std::string ending_of(const Path& path) {
  std::string ending = path.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(), [](unsigned char c) { return std::tolower(c); });
  return ending;
}

glm::ivec3 bytes_of(const glm::vec3& colour) { return glm::ivec3(glm::round(glm::clamp(colour, 0.0f, 1.0f) * 255.0f)); }

void draw_box(render::Image& image, const FigureBox& box, double per_mm) {
  const glm::ivec2 low = glm::clamp(glm::ivec2(glm::round(box.low * per_mm)), glm::ivec2(0), image.size),
                   high = glm::clamp(glm::max(glm::ivec2(glm::round(box.high * per_mm)), low + 1), low, image.size);
  for (int y = low.y; y < high.y; ++y)
    for (int x = low.x; x < high.x; ++x)
      draw_over(image.rgba.data() + (static_cast<std::size_t>(y) * image.size.x + x) * 4, bytes_of(box.colour), 255);
}

std::string svg_box(const glm::dvec2& low, const glm::dvec2& high, const glm::vec3& colour) {
  const glm::ivec3 rgb = bytes_of(colour);
  char text[200];
  std::snprintf(text, sizeof text,
                "<rect x=\"%.4f\" y=\"%.4f\" width=\"%.4f\" height=\"%.4f\" fill=\"#%02x%02x%02x\"/>\n", low.x, low.y,
                high.x - low.x, high.y - low.y, rgb.x, rgb.y, rgb.z);
  return text;
}

}  // namespace

void check_figure_path(const Path& path) {
  const std::string ending = ending_of(path);
  if (std::find(std::begin(kFigureEndings), std::end(kFigureEndings), ending) == std::end(kFigureEndings))
    throw Error("a figure cannot be written in this format", path.string(),
                "use a name that ends in .png, .tif or .svg");
}

render::Image figure_image(const FigureLayout& layout, const render::Image& picture, const Lettering& lettering) {
  const Paper paper = layout.options.paper;
  render::Image image{layout.pixels, std::vector<std::uint8_t>(static_cast<std::size_t>(layout.pixels.x) *
                                                                   static_cast<std::size_t>(layout.pixels.y) * 4,
                                                               paper == Paper::White ? 255 : 0)};
  if (paper == Paper::Black)
    for (std::size_t i = 3; i < image.rgba.size(); i += 4) image.rgba[i] = 255;
  for (int y = 0; y < picture.size.y; ++y)
    for (int x = 0; x < picture.size.x; ++x) {
      const std::uint8_t* from = picture.rgba.data() + (static_cast<std::size_t>(y) * picture.size.x + x) * 4;
      const glm::ivec2 at = layout.picture_low + glm::ivec2(x, y);
      draw_over(image.rgba.data() + (static_cast<std::size_t>(at.y) * image.size.x + at.x) * 4,
                {from[0], from[1], from[2]}, from[3]);
    }
  const double per_mm = layout.options.dots_per_inch / 25.4;
  if (layout.bar_millimetres > 0) draw_box(image, layout.bar, per_mm);
  for (const FigureBox& box : layout.boxes) draw_box(image, box, per_mm);
  for (const FigureText& text : layout.texts)
    lettering.draw(image, text.text, text.bold, text.left_base * per_mm, text.size * per_mm,
                   paper == Paper::Black ? 255 : 0);
  return image;
}

std::string figure_svg(const FigureLayout& layout, const render::Image& picture) {
  const FigureOptions& options = layout.options;
  char text[400];
  std::snprintf(text, sizeof text,
                "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%gmm\" height=\"%gmm\" viewBox=\"0 0 %g %g\">\n",
                options.size.x, options.size.y, options.size.x, options.size.y);
  std::string svg = std::string("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n") + text;
  if (options.paper != Paper::Transparent)
    svg += svg_box({0, 0}, options.size, glm::vec3(options.paper == Paper::White ? 1.0f : 0.0f));
  const double pixel = 25.4 / options.dots_per_inch;
  std::snprintf(text, sizeof text, "<image x=\"%.4f\" y=\"%.4f\" width=\"%.4f\" height=\"%.4f\" ",
                layout.picture_low.x * pixel, layout.picture_low.y * pixel, layout.picture_pixels.x * pixel,
                layout.picture_pixels.y * pixel);
  svg += text + std::string("preserveAspectRatio=\"none\" href=\"data:image/png;base64,") +
         base64(render::png_of(picture, options.dots_per_inch)) + "\"/>\n";
  if (layout.bar_millimetres > 0) svg += svg_box(layout.bar.low, layout.bar.high, layout.bar.colour);
  for (const FigureBox& box : layout.boxes) svg += svg_box(box.low, box.high, box.colour);
  // The attribute textLength gives the width of each text. A program without the font fits another font into this
  // width, so that nothing is cut off.
  for (const FigureText& line : layout.texts) {
    std::snprintf(text, sizeof text,
                  "<text x=\"%.4f\" y=\"%.4f\" font-size=\"%.4f\" font-weight=\"%d\" textLength=\"%.4f\" "
                  "lengthAdjust=\"spacingAndGlyphs\" font-family=\"Inter, Helvetica, Arial, sans-serif\" "
                  "fill=\"%s\">",
                  line.left_base.x, line.left_base.y, line.size, line.bold ? 600 : 400, line.width,
                  options.paper == Paper::Black ? "#ffffff" : "#000000");
    svg += text + escaped(valid_utf8(line.text)) + "</text>\n";
  }
  return svg + "</svg>\n";
}

void write_figure(const FigureLayout& layout, const render::Image& picture, const Lettering& lettering,
                  const Path& path) {
  check_figure_path(path);
  const std::string ending = ending_of(path);
  if (ending == ".svg") return write_file_atomically(path, figure_svg(layout, picture));
  const render::Image image = figure_image(layout, picture, lettering);
  if (ending == ".png") return render::write_png(image, path, layout.options.dots_per_inch);
  write_file_atomically(path, render::tiff_of(image, layout.options.dots_per_inch));
}

}  // namespace limber::editor
