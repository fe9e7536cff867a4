// SPDX-License-Identifier: AGPL-3.0-or-later
// Draws the blocks of a document (markdown.h) in a dialog, word by word, wrapped between two x coordinates.
#pragma once

#include <functional>
#include <string>

#include <glm/glm.hpp>

#include "editor/ui/markdown.h"

namespace limber::editor {

struct Ui;

// A picture of a document as an OpenGL texture. The texture is 0 if the picture cannot be shown.
struct DocumentPicture {
  unsigned texture = 0;
  glm::vec2 size{0};  // width and height, pixels
};

struct BlockPlace {
  float left = 0, right = 0;  // x coordinates between which lines are wrapped
  std::string name;           // prefix of the names of the block's widgets; differs for each block
  std::function<DocumentPicture(const std::string& file)> picture = {};
  std::string clicked = {};  // set by draw_block(): the target of the link that was clicked in this frame
  bool marked = false;       // true: the block gets a highlighted background, because a search has led to it
};

// Draws a block with its upper end at the y coordinate `y`. Returns the y coordinate of its lower end.
float draw_block(Ui& ui, const Block& block, BlockPlace& place, float y);
// Returns the distance from this block to the next one, pixels at scale 1.
float gap_below(const Block& block);

}  // namespace limber::editor
