// SPDX-License-Identifier: AGPL-3.0-or-later
// Measures and draws the text of figures, in the editor's own font, by FreeType. Sizes are heights of the font (em).
// The outlines are drawn without hinting, so that a text has the same shape and relative width at any resolution.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "render/image_io.h"

namespace limber::editor {

class Lettering {
 public:
  Lettering();  // throws Error when a font file is missing
  ~Lettering();
  Lettering(const Lettering&) = delete;
  Lettering& operator=(const Lettering&) = delete;

  // Returns the width of a UTF-8 text, in units of the font size.
  double width(const std::string& text, bool bold) const;
  // Breaks a text into lines that are no wider than `most`, in units of the font size. Lines break between words; a
  // word that is wider than a line is split.
  std::vector<std::string> lines(const std::string& text, bool bold, double most) const;
  // Draws a text over a picture.
  //   left_base  start of the text on its baseline, pixels
  //   size       font size, pixels
  //   grey       grey value of the text, 0 to 255
  void draw(render::Image& image, const std::string& text, bool bold, const glm::dvec2& left_base, double size,
            int grey) const;

 private:
  struct Faces;
  std::unique_ptr<Faces> faces_;
};

// Blends a colour over a pixel of a picture, which may be transparent. `alpha` is 0 to 255.
void draw_over(std::uint8_t* rgba, const glm::ivec3& colour, int alpha);

}  // namespace limber::editor
