// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/guide/guide_reader.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include "core/base/error.h"
#include "editor/context/context.h"
#include "editor/context/dialogs.h"
#include "editor/dialogs/block_drawing.h"
#include "editor/dialogs/dialog.h"
#include "editor/guide/book.h"
#include "editor/input/keymap.h"
#include "editor/ui/asset_path.h"
#include "editor/ui/icons.h"
#include "editor/ui/input_fields.h"
#include "editor/ui/keyboard.h"
#include "editor/ui/messages.h"
#include "editor/ui/section.h"
#include "editor/ui/texture_cache.h"
#include "render/image_io.h"

namespace limber::editor {

namespace {

constexpr float kWidth = 1040, kHeight = 680, kContents = 268, kMargin = 28, kFoot = 44, kSearch = 48;

class GuideReader final : public Dialog {
 public:
  GuideReader(Book book, int page, int block) : book_(std::move(book)) {
    if (page > 0 && page < std::ssize(book_.pages)) target_ = Target{page, block};
  }
  void draw(Context& context) override;
  bool key(Context& context, const Chord& chord) override;

 private:
  void take_scroll_keys(Context& context, float height);
  void draw_search(Context& context, const Rect& rect);
  void draw_contents(Context& context, const Rect& rect);
  void draw_found(Context& context, const Rect& rect);
  void draw_page(Context& context, const Rect& rect);
  void draw_foot(Context& context, const Rect& rect);
  DocumentPicture picture(Context& context, const std::string& file);
  void go_to(Context& context, int page, int block = 0);
  void go_along(Context& context, int step);
  void turn_to_target(Context& context);
  int next_page() const { return target_ ? target_->page : page_; }  // the page of the next frame
  bool ends_list(int block) const;

  struct Target {
    int page = 0, block = 0;
    bool seen_before = false;  // true: the user goes back to the page, so it is shown without a marked block
  };

  Book book_;
  std::string search_, searched_;
  std::vector<Found> found_;
  int page_ = 0, marked_ = 0;  // indices of the shown page, and of the block that a search has led to (0: no block)
  std::optional<Target> target_;
  std::vector<int> before_, after_;  // stacks of pages for Alt+Left and Alt+Right; the last page is shown next
  bool focus_ = false, scroll_to_mark_ = false, first_found_ = false, show_row_ = false;
  float scroll_by_ = 0;
  std::map<std::string, glm::vec2> sizes_;  // sizes of the page's pictures, pixels, by file
};

bool GuideReader::key(Context& context, const Chord& chord) {
  if (chord.key == Key::F && chord.modifiers.ctrl) return focus_ = true;
  // Only stores that Return was pressed, because the text field has not read all typed letters yet.
  if ((chord.key == Key::Return || chord.key == Key::NumEnter) && is_typing(context.ui)) return first_found_ = true;
  if (!chord.modifiers.alt || (chord.key != Key::Left && chord.key != Key::Right)) return false;
  go_along(context, chord.key == Key::Right ? 1 : -1);
  return true;
}

// Stores the page to show in the next frame. The current frame already draws the pictures of the old page.
void GuideReader::go_to(Context& context, int page, int block) {
  if (page < 0 || page >= std::ssize(book_.pages)) return;
  if (page != next_page()) {
    before_.push_back(next_page());
    after_.clear();
  }
  target_ = Target{page, block};
  context.ui->touch();
}

// Goes back to the page that was shown before (step -1) or forward again (step 1). If there is no such page, goes to
// the previous or next page in reading order.
void GuideReader::go_along(Context& context, int step) {
  std::vector<int>&from = step < 0 ? before_ : after_, &to = step < 0 ? after_ : before_;
  if (from.empty()) return go_to(context, next_page() + step);
  to.push_back(next_page());
  target_ = Target{from.back(), 0, true};
  from.pop_back();
  context.ui->touch();
}

void GuideReader::turn_to_target(Context& context) {
  const std::optional<Target> target = std::exchange(target_, std::nullopt);
  if (!target) return;
  for (const auto& [file, size] : sizes_) context.pictures->forget("guide " + file);
  sizes_.clear();
  page_ = target->page;
  marked_ = target->block;
  scroll_to_mark_ = !target->seen_before;
  show_row_ = true;
}

// Returns true if this block is not part of a list, but the block before it is.
bool GuideReader::ends_list(int block) const {
  const auto listed = [&](int b) {
    const Block::Kind kind = book_.pages[page_].blocks[b].kind;
    return kind == Block::Kind::Point || kind == Block::Kind::Step;
  };
  return block > 0 && listed(block - 1) && !listed(block);
}

void GuideReader::take_scroll_keys(Context& context, float height) {
  if (!context.messages->errors.empty() || ImGui::GetIO().WantTextInput) return;
  const float line = context.ui->look.px(48);
  const std::pair<Key, float> moves[] = {{Key::Down, line},
                                         {Key::Up, -line},
                                         {Key::PageDown, height - line},
                                         {Key::PageUp, line - height},
                                         {Key::Space, height - line},
                                         {Key::Home, -1e9f},
                                         {Key::End, 1e9f}};
  for (const auto& [key, by] : moves)
    if (ImGui::IsKeyPressed(static_cast<int>(key))) scroll_by_ += by;
}

// Returns a picture of the page, and reads it at the first call. Its texture is deleted when another page is shown.
DocumentPicture GuideReader::picture(Context& context, const std::string& file) {
  const std::string name = "guide " + file;
  render::Image image;
  if (!sizes_.contains(file)) {
    try {
      image = render::read_png(asset("docs/guide/" + file));
    } catch (const Error& error) {  // the page is shown without this picture
      context.messages->warn(error.what());
    }
    sizes_[file] = image.size;
    context.pictures->forget(name);
  }
  return {context.pictures->texture(name, [&] { return image; }), sizes_[file]};
}

void GuideReader::draw_search(Context& context, const Rect& rect) {
  const Look& look = context.ui->look;
  put_icon(look.fonts.regular, look.theme.text2,
           Rect{{rect.low.x + look.px(8), rect.low.y}, {rect.low.x + look.px(34), rect.high.y}}, icon::kSearch);
  const bool any = !search_.empty();
  text_field(context.ui, "search",
             {{rect.low.x + look.px(36), rect.low.y + look.px(11)},
              {rect.high.x - look.px(any ? 40 : 12), rect.high.y - look.px(11)}},
             search_, "Search the guide", std::exchange(focus_, false));
  if (any && button(context.ui, "clear",
                    {{rect.high.x - look.px(36), rect.low.y + look.px(12)},
                     {rect.high.x - look.px(12), rect.high.y - look.px(12)}},
                    {icon::kClose, "", ButtonStyle::Flat}))
    search_.clear();
  if (search_ == searched_) return;
  searched_ = search_;
  found_ = find_in(book_, search_);
  context.ui->touch();
}

void GuideReader::draw_contents(Context& context, const Rect& rect) {
  const Look& look = context.ui->look;
  Column column(context.ui, "pages", rect);
  const auto row = [&](int page, float indent) {
    const Rect area = column.row(26);
    const Page& one = book_.pages[page];
    const Pressed pressed = press_area(context.ui, one.title, area);
    const bool here = page == page_;
    if (here) fill(area, look.theme.accent_soft);
    else if (pressed.hovered) fill(area, look.theme.hover);
    put_text(context.ui, look.fonts.regular, here ? look.theme.accent_text : look.theme.text,
             Rect{{area.low.x + look.px(indent), area.low.y}, {area.high.x - look.px(6), area.high.y}}, one.title);
    if (here && std::exchange(show_row_, false) && (area.low.y < rect.low.y || area.high.y > rect.high.y)) {
      ImGui::SetScrollY(ImGui::GetScrollY() + area.low.y - rect.low.y - rect.height() / 3);
      context.ui->touch();
    }
    if (pressed.clicked) go_to(context, page);
  };
  row(0, 14);
  for (const Chapter& chapter : book_.chapters) {
    column.space(8);
    const Rect head = column.row(24);
    put_text(context.ui, look.fonts.semibold, look.theme.text2,
             Rect{{head.low.x + look.px(14), head.low.y}, {head.high.x - look.px(6), head.high.y}}, chapter.title);
    for (const int page : chapter.pages) row(page, 26);
  }
  column.space(12);
}

void GuideReader::draw_found(Context& context, const Rect& rect) {
  const Look& look = context.ui->look;
  Column column(context.ui, "found", rect);
  if (found_.empty()) {
    if (empty_state(context.ui, column.row(72), "No page has these words", "Clear search")) search_.clear();
    return;
  }
  for (const Found& found : found_) {
    const Page& page = book_.pages[found.page];
    const Rect area = column.row(68);
    const Pressed pressed = press_area(context.ui, page.title, area);
    const bool here = found.page == page_;
    if (here) fill(area, look.theme.accent_soft);
    else if (pressed.hovered) fill(area, look.theme.hover);
    const float left = area.low.x + look.px(14), right = area.high.x - look.px(8);
    put_text(context.ui, look.fonts.semibold, here ? look.theme.accent_text : look.theme.text,
             Rect{{left, area.low.y + look.px(5)}, {right, area.low.y + look.px(25)}}, page.title);
    put_wrapped(context.ui, look.fonts.small, look.theme.text2, {left, area.low.y + look.px(26)}, right - left,
                found.sentence, 2);
    fill({{left, area.high.y - look.line()}, {right, area.high.y}}, look.theme.line2);
    if (pressed.clicked) go_to(context, found.page, found.block);
  }
}

void GuideReader::draw_page(Context& context, const Rect& rect) {
  const Look& look = context.ui->look;
  PathScope of_page(context.ui, "page");
  Column column(context.ui, std::to_string(page_), rect);
  ImGui::SetScrollY(ImGui::GetScrollY() + std::exchange(scroll_by_, 0.0f));
  const float top = ImGui::GetCursorScreenPos().y, left = rect.low.x + look.px(kMargin);
  const float right = std::min(rect.high.x - look.px(kMargin + 6), left + look.px(760));
  float y = top + look.px(16);
  std::string clicked;
  for (int b = 0; b < std::ssize(book_.pages[page_].blocks); ++b) {
    const Block& block = book_.pages[page_].blocks[b];
    if (block.kind == Block::Kind::Heading || ends_list(b)) y += look.px(8);
    if (b == marked_ && std::exchange(scroll_to_mark_, false)) {
      ImGui::SetScrollY(b == 0 ? 0 : y - top - rect.height() / 4);
      context.ui->touch();
    }
    BlockPlace place{left, right, "link " + std::to_string(b),
                     [&](const std::string& file) { return picture(context, file); }};
    place.marked = b > 0 && b == marked_;
    y = draw_block(context.ui, block, place, y) + look.px(gap_below(block));
    if (!place.clicked.empty()) clicked = place.clicked;
  }
  column.space((y - top) / look.scale + 16);
  if (!clicked.empty()) go_to(context, page_of(book_, clicked));
}

void GuideReader::draw_foot(Context& context, const Rect& rect) {
  const Look& look = context.ui->look;
  fill({rect.low, {rect.high.x, rect.low.y + look.line()}}, look.theme.line2);
  const auto turn = [&](const char* name, int page, const char* icon, bool at_left) {
    if (page < 0 || page >= std::ssize(book_.pages)) return;
    const ButtonLook shown{icon, book_.pages[page].title, ButtonStyle::Flat};
    const float width = std::min(width_of_button(context.ui, shown), rect.width() / 2 - look.px(20));
    const float x = at_left ? rect.low.x + look.px(12) : rect.high.x - look.px(12) - width;
    if (button(context.ui, name, {{x, rect.low.y + look.px(9)}, {x + width, rect.high.y - look.px(9)}}, shown))
      go_to(context, page);
  };
  turn("previous", page_ - 1, icon::kBack, true);
  turn("next", page_ + 1, icon::kForward, false);
}

void GuideReader::draw(Context& context) {
  const Look& look = context.ui->look;
  turn_to_target(context);
  const Rect rect = begin_dialog(context, "User guide", kWidth, kHeight);
  const Rect body{rect.low - look.px(18) + glm::vec2(look.line(), 0), rect.high + look.px(18) - look.line()};
  take_scroll_keys(context, body.height() - look.px(kFoot));
  const float middle = body.low.x + std::min(look.px(kContents), std::round(body.width() * 0.36f));
  ImGui::GetWindowDrawList()->AddRectFilled(im(body.low), im({middle, body.high.y}), look.theme.head, look.px(8),
                                            ImDrawFlags_RoundCornersBottomLeft);
  const float list_top = body.low.y + look.px(kSearch);
  draw_search(context, {body.low, {middle, list_top}});
  if (std::exchange(first_found_, false) && !found_.empty()) go_to(context, found_[0].page, found_[0].block);
  const Rect list{{body.low.x, list_top}, {middle, body.high.y - look.px(6)}};
  if (searched_.find_first_not_of(' ') == std::string::npos) draw_contents(context, list);
  else draw_found(context, list);
  fill({{middle, body.low.y}, {middle + look.line(), body.high.y}}, look.theme.line2);
  const float foot = body.high.y - look.px(kFoot);
  draw_page(context, {{middle + look.line(), body.low.y}, {body.high.x, foot}});
  draw_foot(context, {{middle + look.line(), foot}, body.high});
  end_dialog(context);
}

}  // namespace

Book read_guide(const Context& context) {
  return read_guide([&](const std::string& id) {
    const auto chord = context.keymap->chord_of(id);
    return chord ? to_text(*chord) : std::string("(no key)");
  });
}

std::unique_ptr<Dialog> open_guide(Book book, int page, int block) {
  return std::make_unique<GuideReader>(std::move(book), page, block);
}

}  // namespace limber::editor
