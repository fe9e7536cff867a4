// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/context/dialogs.h"
#include "editor/dialogs/block_drawing.h"
#include "editor/ui/ui.h"

#include "tests/editor/small_editor.h"

namespace limber::editor {
// Declared again here, as dialog.h includes ImGui and tests are built without its headers.
Rect begin_dialog(Context& editor, const std::string& title, float width, float height,
                  const std::function<void()>& close);
void end_dialog(Context& editor);
}  // namespace limber::editor

using namespace limber;
using namespace limber::editor;
using namespace limber::test;

namespace {

constexpr float kColumn = 200;  // width of the column, pixels

// Shows one block in a narrow column.
class OneBlock final : public Dialog {
 public:
  explicit OneBlock(Block block) : block_(std::move(block)) {}
  void draw(Context& editor) override {
    const Rect rect = begin_dialog(editor, "One block", 600, 400, {});
    BlockPlace place{rect.low.x, rect.low.x + kColumn, "block"};
    height_ = draw_block(editor.ui, block_, place, rect.low.y) - rect.low.y;
    left_ = rect.low.x;
    end_dialog(editor);
  }
  float height() const { return height_; }
  float left() const { return left_; }

 private:
  Block block_;
  float height_ = 0, left_ = 0;
};

// Shows a link with this text in the narrow column. Returns the rectangles of its words.
//   left    out: position of the column's left edge, pixels
//   height  out: height of the link's block, pixels
std::vector<Rect> words_of(const std::string& text, float& left, float& height) {
  SmallEditor test;
  auto dialog = std::make_unique<OneBlock>(
      parse_markdown("[" + text + "](page.md)\n", [](const std::string& id) { return id; }).at(0));
  const OneBlock& shown = *dialog;
  test.editor->dialogs->open(std::move(dialog));
  test.player.settle();
  left = shown.left();
  height = shown.height();
  std::vector<Rect> words;
  while (const Widget* word = test.editor->ui->widgets.find("block/" + std::to_string(words.size())))
    words.push_back(word->rect);
  return words;
}

}  // namespace

TEST_CASE("block drawing: a word that is wider than the column goes on in the next lines, and keeps every character") {
  float left = 0, height = 0;
  const std::vector<Rect> pieces = words_of("short " + std::string(80, 'm'), left, height);
  REQUIRE(pieces.size() >= 4);
  float widths = 0;
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    INFO(i);
    CHECK(pieces[i].low.x >= left);
    CHECK(pieces[i].high.x <= left + kColumn + 1);
    if (i > 0) CHECK(pieces[i].low.y > pieces[i - 1].low.y);
    if (i > 0) widths += pieces[i].width();
  }
  CHECK(pieces.back().high.y - pieces.front().low.y <= height + 1);
  const std::vector<Rect> half = words_of(std::string(10, 'm'), left, height);
  REQUIRE(half.size() == 1);
  CHECK(widths == doctest::Approx(8 * half[0].width()).epsilon(0.02));
}
