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

  // Returns the width of a text in UTF-8, in units of the font's size.
  double width(const std::string& text, bool bold) const;
  // Breaks a text into lines no wider than `most`, in units of the font's size: between words, or within a word that is
  // wider than a line.
  std::vector<std::string> lines(const std::string& text, bool bold, double most) const;
  // Draws a text over a picture.
  //   left, base  where the text begins, on its base line, pixels
  //   size        of the font, pixels
  //   grey        0 to 255
  void draw(render::Image& image, const std::string& text, bool bold, const glm::dvec2& left_base, double size,
            int grey) const;

 private:
  struct Faces;
  std::unique_ptr<Faces> faces_;
};

// Draws a colour over a pixel of a picture that may be transparent.
void draw_over(std::uint8_t* rgba, const glm::ivec3& colour, int alpha);

}  // namespace limber::editor
