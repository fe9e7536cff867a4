// SPDX-License-Identifier: AGPL-3.0-or-later
// Draws the blocks of a document (markdown.h) in a dialog, word by word, wrapped between two x coordinates.
#pragma once

#include <functional>
#include <string>

#include "editor/context/editor.h"
#include "editor/ui/markdown.h"

namespace limber::editor {

// A picture of a document as a texture. The texture is 0 where the picture cannot be shown.
struct DocumentPicture {
  unsigned texture = 0;
  glm::vec2 size{0};  // pixels
};

struct BlockPlace {
  float left = 0, right = 0;  // x coordinates between which lines are wrapped
  std::string name;           // begins the names of the block's widgets; unlike those of other blocks
  std::function<DocumentPicture(const std::string& file)> picture = {};
  std::string clicked = {};  // set by draw_block(): the target of the link that was clicked in this frame
  bool marked = false;       // draws a background that shows where a search has led
};

// Draws a block, whose upper end has the y coordinate `y`. Returns the y coordinate of its lower end.
float draw_block(Editor& editor, const Block& block, BlockPlace& place, float y);
// The distance to the next block, in pixels at scale 1.
float gap_below(const Block& block);

}  // namespace limber::editor
