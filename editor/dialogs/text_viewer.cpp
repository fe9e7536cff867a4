// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/dialogs/text_viewer.h"

#include <utility>

#include "core/export/exporter.h"
#include "core/paint/brush_rule.h"
#include "core/resample/deformation_method.h"
#include "core/volume_io/volume_format.h"
#include "editor/context/context.h"
#include "editor/context/dialogs.h"
#include "editor/dialogs/block_drawing.h"
#include "editor/dialogs/dialog.h"
#include "editor/input/keymap.h"
#include "editor/ui/asset_path.h"
#include "editor/ui/markdown.h"
#include "editor/ui/messages.h"
#include "editor/ui/section.h"

namespace limber::editor {

namespace {

constexpr float kWidth = 760, kHeight = 600, kChapters = 200, kMargin = 22;

}  // namespace

std::string with_tables(std::string text) {
  std::string brushes;
  for (const BrushRule& rule : brush_rules())
    brushes += (brushes.empty() ? "- " : "\n- ") + rule.name + ": " + rule.description;
  for (const auto& [id, words] : {std::pair<std::string, std::string>{"{table.volume_formats}", readable_formats()},
                                  {"{table.volume_endings}", writable_endings()},
                                  {"{table.exporters}", exporter_endings()},
                                  {"{table.methods}", method_summaries(Methods::All)},
                                  {"{table.brushes}", brushes}})
    for (std::size_t place = 0; (place = text.find(id, place)) != std::string::npos; place += words.size())
      text.replace(place, id.size(), words);
  return text;
}

namespace {

class Reader final : public Dialog {
 public:
  Reader(std::string title, std::string text) : title_(std::move(title)), text_(std::move(text)) {}

  void draw(Context& context) override {
    const Look& look = context.ui->look;
    const Rect rect = begin_dialog(context, title_, kWidth, kHeight);
    const Rect body{rect.low - look.px(18) + glm::vec2(look.line(), 0), rect.high + look.px(18) - look.line()};
    if (blocks_.empty())
      blocks_ = parse_markdown(text_, [&](const std::string& id) {
        const auto chord = context.keymap->chord_of(id);
        return chord ? to_text(*chord) : std::string("(no key)");
      });
    take_keys(context, body.height());
    const float middle = body.low.x + look.px(kChapters);
    draw_chapters(context, {body.low, {middle, body.high.y}});
    fill({{middle, body.low.y}, {middle + look.line(), body.high.y}}, look.theme.line2);
    draw_text(context, {{middle + look.line(), body.low.y}, body.high});
    end_dialog(context);
  }

 private:
  bool is_chapter(int block) const { return blocks_[block].kind == Block::Kind::Heading; }

  void take_keys(Context& context, float page) {
    if (!context.messages->errors.empty()) return;
    const float line = context.ui->look.px(48);
    const std::pair<Key, float> moves[] = {{Key::Down, line},
                                           {Key::Up, -line},
                                           {Key::PageDown, page - line},
                                           {Key::PageUp, line - page},
                                           {Key::Space, page - line},
                                           {Key::Home, -1e9f},
                                           {Key::End, 1e9f}};
    for (const auto& [key, by] : moves)
      if (ImGui::IsKeyPressed(static_cast<int>(key))) scroll_by_ += by;
  }

  void draw_chapters(Context& context, const Rect& rect) {
    const Look& look = context.ui->look;
    ImGui::GetWindowDrawList()->AddRectFilled(im(rect.low), im(rect.high), look.theme.head, look.px(8),
                                              ImDrawFlags_RoundCornersBottomLeft);
    Column column(context.ui, "chapters", rect);
    column.space(8);
    for (int b = 0; b < std::ssize(blocks_); ++b) {
      if (!is_chapter(b)) continue;
      const std::string title = plain_text(blocks_[b]);
      const Rect row = column.row(28);
      const Pressed pressed = press_area(context.ui, title, row);
      if (b == seen_chapter_) fill(row, look.theme.accent_soft);
      else if (pressed.hovered) fill(row, look.theme.hover);
      put_text(context.ui, look.fonts.regular, b == seen_chapter_ ? look.theme.accent_text : look.theme.text,
               Rect{{row.low.x + look.px(14), row.low.y}, {row.high.x - look.px(6), row.high.y}}, title);
      if (pressed.clicked) go_to_ = b;
    }
  }

  void draw_text(Context& context, const Rect& rect) {
    const Look& look = context.ui->look;
    Column column(context.ui, "text", rect);
    ImGui::SetScrollY(ImGui::GetScrollY() + std::exchange(scroll_by_, 0.0f));
    const float top = ImGui::GetCursorScreenPos().y, left = rect.low.x + look.px(kMargin),
                right = rect.high.x - look.px(kMargin + 6);
    float y = top + look.px(16);
    seen_chapter_ = -1;
    for (int b = 0; b < std::ssize(blocks_); ++b) {
      const Block& block = blocks_[b];
      if (is_chapter(b)) {
        y += look.px(14);
        if (std::exchange(go_to_, go_to_ == b ? -1 : go_to_) == b) {
          ImGui::SetScrollY(y - top - look.px(10));
          context.ui->touch();
        }
        if (seen_chapter_ < 0 || y < rect.low.y + rect.height() / 3) seen_chapter_ = b;
      }
      BlockPlace place{left, right, "link " + std::to_string(b)};
      y = draw_block(context.ui, block, place, y) + look.px(gap_below(block));
    }
    column.space((y - top) / look.scale + 16);
  }

  std::string title_, text_;
  std::vector<Block> blocks_;
  int go_to_ = -1, seen_chapter_ = -1;
  float scroll_by_ = 0;
};

}  // namespace

std::unique_ptr<Dialog> open_document(const std::string& title, const std::string& asset_name) {
  return std::make_unique<Reader>(title, with_tables(read_file(asset(asset_name))));
}

}  // namespace limber::editor
