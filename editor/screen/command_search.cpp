// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/screen/command_search.h"

#include <algorithm>

#include "core/base/error.h"
#include "editor/context/context.h"
#include "editor/context/dialogs.h"
#include "editor/context/operator_registry.h"
#include "editor/context/pointer_context.h"
#include "editor/context/preferences.h"
#include "editor/context/screen.h"
#include "editor/guide/guide_reader.h"
#include "editor/screen/preferences_dialog.h"
#include "editor/ui/fuzzy_match.h"
#include "editor/ui/icons.h"
#include "editor/ui/input_fields.h"
#include "editor/ui/messages.h"
#include "editor/ui/tooltip.h"

namespace limber::editor {

namespace {

constexpr int kMostRows = 8, kLastUsed = 5;
constexpr std::size_t kMostPages = 4;  // pages of the guide that are listed
// Amounts subtracted from a command's score if the query matches the command's category (kPlacePenalty) or description
// (kSentencePenalty) instead of its label.
constexpr int kPlacePenalty = 30, kSentencePenalty = 60;
constexpr std::size_t kLeastForSentence = 3;  // a query with fewer letters does not search descriptions

bool can_be_searched(const Keymap& keymap, const Operator& op) {
  return op.id != "search.commands" && !needs_pointer(keymap, op);
}

// Returns the sort key of a command in the list that is shown while the query is empty. Commands with smaller keys come
// first: those used last, then those used often, then unused commands.
std::size_t place_by_use(const Preferences& preferences, const std::string& id) {
  const auto& recent = preferences.recent_commands;
  const auto last = recent.begin() + static_cast<std::ptrdiff_t>(std::min<std::size_t>(kLastUsed, recent.size()));
  const auto found = std::find(recent.begin(), last, id);
  if (found != last) return static_cast<std::size_t>(found - recent.begin());
  const auto count = preferences.command_counts.find(id);
  return count == preferences.command_counts.end() ? 2'000'000 : static_cast<std::size_t>(1'100'000 - count->second);
}

// Returns true if every word of the query matches the beginning of a word in the text.
bool begins_words(const std::string& query, const std::string& text) {
  const auto match = fuzzy_match(query, text);
  if (!match) return false;
  for (std::size_t i = 0, words = 0, last = std::string::npos; i < match->letters.size(); ++i) {
    words += match->letters[i] != last + 1;
    last = match->letters[i];
    if (words > 1 + static_cast<std::size_t>(std::count(query.begin(), query.end(), ' '))) return false;
  }
  return true;
}

struct Ranked {
  FoundCommand command;
  int score;
  std::size_t order;
};

std::optional<Ranked> rank(const Operator& op, const std::string& query) {
  if (auto match = fuzzy_match(query, op.label))
    return Ranked{{&op, std::move(match->letters), ""}, match->score, op.label.size()};
  if (auto match = fuzzy_match(query, op.category + " " + op.label))
    return Ranked{{&op, {}, ""}, match->score - kPlacePenalty, op.label.size()};
  if (query.size() < kLeastForSentence || !begins_words(query, op.description)) return std::nullopt;
  return Ranked{{&op, {}, "", false}, -kSentencePenalty, op.label.size()};
}

// A row of the list: a command, or a page of the guide.
struct FoundRow {
  std::optional<FoundCommand> command;
  Found page;
};

class CommandSearch final : public Dialog {
 public:
  // Makes a search for commands and for pages of this guide; without a guide, for commands only.
  explicit CommandSearch(std::optional<Book> guide) : guide_(std::move(guide)) {}
  void draw(Context& context) override;
  bool key(Context& context, const Chord& chord) override;

 private:
  void draw_field(Context& context, const Rect& rect);
  void draw_row(Context& context, const Rect& rect, int index);
  void draw_page_row(Context& context, const Rect& rect, const Found& page, bool chosen);
  void draw_foot(Context& context, const Rect& rect);
  void search(Context& context);
  void run_chosen(Context& context);
  std::string title_of(const FoundRow& row) const;

  std::string query_, last_query_ = "\n";  // last_query_ differs from query_ at first, so that the first frame searches
  std::optional<Book> guide_;
  std::vector<FoundRow> found_;
  int chosen_ = 0, first_ = 0;
  bool focus_ = true, accept_ = false, assign_ = false;
};

bool CommandSearch::key(Context&, const Chord& chord) {
  const int count = static_cast<int>(found_.size());
  const auto move = [&](int by) { chosen_ = count ? std::clamp(chosen_ + by, 0, count - 1) : 0; };
  switch (chord.key) {
    case Key::Down: move(1); return true;
    case Key::Up: move(-1); return true;
    case Key::PageDown: move(kMostRows); return true;
    case Key::PageUp: move(-kMostRows); return true;
    // Only remember that Enter was pressed. draw() runs the command, after the text field has read all typed letters.
    case Key::Return:
    case Key::NumEnter: accept_ = true; return true;
    case Key::K: assign_ = chord.modifiers.ctrl; return assign_;
    default: return false;
  }
}

void CommandSearch::run_chosen(Context& context) {
  if (chosen_ >= std::ssize(found_)) return;
  const FoundRow row = found_[chosen_];
  if (!row.command) return context.dialogs->open(open_guide(*guide_, row.page.page, row.page.block));
  const Operator& op = *row.command->op;
  context.dialogs->close();
  run(context, op);
}

// Pages of the guide come after the commands whose label or category matches, and before the commands that match only
// by their description.
void CommandSearch::search(Context& context) {
  found_.clear();
  for (FoundCommand& command : find_commands(context, query_)) found_.push_back({std::move(command), {}});
  last_query_ = query_;
  chosen_ = first_ = 0;
  if (!guide_ || query_.size() < kLeastForSentence) return;
  std::vector<Found> pages = find_in(*guide_, query_);
  pages.resize(std::min(pages.size(), kMostPages));
  auto place = std::find_if(found_.begin(), found_.end(), [](const FoundRow& row) { return !row.command->is_named; });
  for (Found& page : pages) place = std::next(found_.insert(place, {std::nullopt, std::move(page)}));
}

std::string CommandSearch::title_of(const FoundRow& row) const {
  return row.command ? row.command->op->label : "Guide: " + guide_->pages[row.page.page].title;
}

void CommandSearch::draw_field(Context& context, const Rect& rect) {
  const Look& look = context.ui->look;
  put_icon(look.fonts.regular, look.theme.text2,
           Rect{{rect.low.x + look.px(12), rect.low.y}, {rect.low.x + look.px(32), rect.high.y}}, icon::kSearch);
  ImGui::PushStyleColor(ImGuiCol_FrameBg, 0);
  ImGui::PushStyleVar(ImGuiStyleVar_FrameBorderSize, 0);
  text_field(
      context.ui, "query",
      {{rect.low.x + look.px(32), rect.low.y + look.px(6)}, {rect.high.x - look.px(90), rect.high.y - look.px(6)}},
      query_, "Search commands", focus_);
  ImGui::PopStyleVar();
  ImGui::PopStyleColor();
  focus_ = false;
  const auto commands = std::count_if(found_.begin(), found_.end(), [](const FoundRow& row) { return row.command; });
  const std::string count = std::to_string(commands) + " of " + std::to_string(count_commands(context));
  put_text(context.ui, look.fonts.small, look.theme.text2,
           Rect{{rect.high.x - look.px(90), rect.low.y}, {rect.high.x - look.px(14), rect.high.y}}, count,
           Align::Right);
}

// Draws a command's label, with the letters that match the query in bold. Returns the x coordinate of the label's right
// end.
float put_label(Ui& ui, const Rect& rect, const FoundCommand& command, bool chosen) {
  const Look& look = ui.look;
  const std::string& label = command.op->label;
  const Colour plain = chosen ? look.theme.on_accent : command.reason.empty() ? look.theme.text : look.theme.text2;
  const Colour bold = chosen ? look.theme.on_accent : look.theme.accent_text;
  const float y = std::round(rect.centre().y - look.fonts.regular->FontSize / 2);
  float x = rect.low.x;
  for (std::size_t i = 0; i < label.size();) {
    const auto matched = [&](std::size_t k) {
      return std::binary_search(command.letters.begin(), command.letters.end(), k);
    };
    const bool is = matched(i);
    std::size_t end = i + 1;
    while (end < label.size() && matched(end) == is) ++end;
    ImFont* font = is ? look.fonts.semibold : look.fonts.regular;
    const std::string part = label.substr(i, end - i);
    ImGui::GetWindowDrawList()->AddText(font, font->FontSize, {std::round(x), y}, is ? bold : plain, part.c_str());
    x += text_size(font, part).x;
    i = end;
  }
  ui.widgets.add_text(label);
  return x;
}

void CommandSearch::draw_row(Context& context, const Rect& rect, int index) {
  const Look& look = context.ui->look;
  const FoundRow& row = found_[index];
  const Pressed pressed = press_area(context.ui, row.command ? row.command->op->id : title_of(row), rect);
  const bool chosen = index == chosen_;
  if (chosen) fill(rect, look.theme.accent);
  else if (pressed.hovered) fill(rect, look.theme.hover);
  if (pressed.clicked) {
    chosen_ = index;
    accept_ = true;
  }
  if (!row.command) return draw_page_row(context, rect, row.page, chosen);
  const FoundCommand& command = *row.command;
  put_icon(look.fonts.regular, chosen ? look.theme.on_accent : look.theme.text2,
           Rect{{rect.low.x + look.px(12), rect.low.y}, {rect.low.x + look.px(32), rect.high.y}}, command.op->icon);

  const auto chord = context.keymap->chord_of(command.op->id, contexts(context));
  const std::vector<std::string> caps = chord ? key_caps(*chord) : std::vector<std::string>{};
  const float caps_left = rect.high.x - look.px(14) - width_of_key_caps(context.ui, caps);
  const float right =
      put_label(context.ui, {{rect.low.x + look.px(39), rect.low.y}, {caps_left, rect.high.y}}, command, chosen);
  const std::string beside = command.reason.empty() ? command.op->category : command.reason;
  put_text(context.ui, look.fonts.small, chosen ? look.theme.on_accent : look.theme.text3,
           Rect{{right + look.px(9), rect.low.y}, {caps_left - look.px(8), rect.high.y}}, beside);
  put_key_caps(context.ui, caps_left, rect.centre().y, caps);
}

void CommandSearch::draw_page_row(Context& context, const Rect& rect, const Found& page, bool chosen) {
  const Look& look = context.ui->look;
  put_icon(look.fonts.regular, chosen ? look.theme.on_accent : look.theme.text2,
           Rect{{rect.low.x + look.px(12), rect.low.y}, {rect.low.x + look.px(32), rect.high.y}}, icon::kHelp);
  const std::string title = title_of({std::nullopt, page});
  const Rect words{{rect.low.x + look.px(39), rect.low.y}, {rect.high.x - look.px(14), rect.high.y}};
  put_text(context.ui, look.fonts.regular, chosen ? look.theme.on_accent : look.theme.text, words, title);
  const float right = std::min(words.high.x, words.low.x + text_size(look.fonts.regular, title).x);
  put_text(context.ui, look.fonts.small, chosen ? look.theme.on_accent : look.theme.text3,
           Rect{{right + look.px(9), rect.low.y}, words.high}, "Help");
}

void CommandSearch::draw_foot(Context& context, const Rect& rect) {
  const Look& look = context.ui->look;
  fill({rect.low, {rect.high.x, rect.low.y + look.line()}}, look.theme.line2);
  const float left = rect.low.x + look.px(14);
  if (chosen_ < std::ssize(found_)) {
    const FoundRow& row = found_[chosen_];
    put_text(context.ui, look.fonts.semibold, look.theme.text,
             Rect{{left, rect.low.y + look.px(8)}, {rect.high.x - look.px(14), rect.low.y + look.px(28)}},
             title_of(row));
    put_text(context.ui, look.fonts.regular, look.theme.text2,
             Rect{{left, rect.low.y + look.px(28)}, {rect.high.x - look.px(14), rect.low.y + look.px(48)}},
             row.command ? row.command->op->description : row.page.sentence);
  }
  float x = left;
  const float y = rect.high.y - look.px(18);
  const std::pair<std::vector<std::string>, const char*> hints[] = {
      {{"Enter"}, chosen_ < std::ssize(found_) && !found_[chosen_].command ? "read" : "run"},
      {{"Up", "Down"}, "select"},
      {{"Ctrl", "K"}, "assign a key"},
      {{"Esc"}, "close"}};
  for (const auto& [caps, words] : hints) {
    x = put_key_caps(context.ui, x, y, caps) + look.px(7);
    x = put_text(context.ui, look.fonts.small, look.theme.text2, glm::vec2(x, y - look.fonts.small->FontSize / 2),
                 words) +
        look.px(12);
  }
}

void CommandSearch::draw(Context& context) {
  if (query_ != last_query_) search(context);
  const Look& look = context.ui->look;
  const int rows = std::min(kMostRows, std::max(1, static_cast<int>(found_.size())));
  first_ = std::clamp(first_, chosen_ - rows + 1, chosen_);
  first_ = std::clamp(first_, 0, std::max(0, static_cast<int>(found_.size()) - rows));
  const glm::vec2 window = context.screen->layout.window.size();
  const float width = std::min(look.px(600), window.x - look.px(16)), left = std::round((window.x - width) / 2),
              top = look.px(48);
  const Rect rect{{left, top}, {left + width, top + look.px(44 + 8 + 30.0f * rows + 8 + 84)}};

  begin_region(context.ui, Region::Dialog, "dim", context.screen->layout.window, with_alpha(0xFF000000, 0.45f));
  if (press_area(context.ui, "outside", context.screen->layout.window).clicked) context.dialogs->close();
  end_region(context.ui);
  begin_region(context.ui, Region::Dialog, "search", rect, 0);
  fill(rect, look.theme.panel, look.px(8));
  outline(rect, look.theme.line2, look.px(8), look.line());
  const Rect field{rect.low, {rect.high.x, rect.low.y + look.px(44)}};
  draw_field(context, field);
  fill({{rect.low.x, field.high.y - look.line()}, {rect.high.x, field.high.y}}, look.theme.line2);
  float y = field.high.y + look.px(4);
  if (found_.empty())
    put_text(context.ui, look.fonts.regular, look.theme.text2,
             Rect{{rect.low.x + look.px(14), y}, {rect.high.x - look.px(14), y + look.px(30)}},
             "Nothing matches '" + query_ + "'");
  for (int i = first_; i < first_ + rows && i < std::ssize(found_); ++i, y += look.px(30))
    draw_row(context, {{rect.low.x + look.line(), y}, {rect.high.x - look.line(), y + look.px(30)}}, i);
  if (rect.contains(context.ui->input.pointer) && context.ui->input.wheel != 0)
    chosen_ = std::clamp(chosen_ - static_cast<int>(context.ui->input.wheel), 0,
                         std::max(0, static_cast<int>(found_.size()) - 1));
  draw_foot(context, {{rect.low.x, rect.high.y - look.px(84)}, rect.high});
  end_region(context.ui);

  if (query_ != last_query_) {
    context.ui->touch();
    if (!accept_ && !assign_) return;
    search(context);
  }
  if (std::exchange(accept_, false)) run_chosen(context);
  if (std::exchange(assign_, false) && chosen_ < std::ssize(found_) && found_[chosen_].command)
    context.dialogs->open(open_preferences(PreferencesPage::Keymap, found_[chosen_].command->op->label));
}

}  // namespace

int count_commands(const Context& context) {
  return static_cast<int>(std::count_if(context.operators->all.begin(), context.operators->all.end(),
                                        [&](const Operator& op) { return can_be_searched(context.keymap, op); }));
}

std::vector<FoundCommand> find_commands(const Context& context, const std::string& query) {
  const bool any = query.find_first_not_of(' ') != std::string::npos;
  std::vector<Ranked> ranked;
  for (const Operator& op : context.operators->all) {
    if (!can_be_searched(context.keymap, op)) continue;
    auto one = any ? rank(op, query) : Ranked{{&op, {}, ""}, 0, place_by_use(context.preferences, op.id)};
    if (!one) continue;
    one->command.reason = disabled_reason(context, op);
    ranked.push_back(std::move(*one));
  }
  // Commands whose label or category matches come first, even if they cannot run now: the search then shows the
  // reason. Commands that match only by their description come last, because the user most likely wants another
  // command.
  const auto only_speaks_of = [](const Ranked& one) { return one.score == -kSentencePenalty; };
  std::stable_sort(ranked.begin(), ranked.end(), [&](const Ranked& a, const Ranked& b) {
    if (only_speaks_of(a) != only_speaks_of(b)) return only_speaks_of(b);
    if (a.command.reason.empty() != b.command.reason.empty()) return a.command.reason.empty();
    if (a.score != b.score) return a.score > b.score;
    return a.order < b.order;
  });
  std::vector<FoundCommand> found;
  for (Ranked& one : ranked) found.push_back(std::move(one.command));
  return found;
}

std::unique_ptr<Dialog> open_command_search(Context& context) {
  std::optional<Book> guide;
  try {
    guide = read_guide(context);
  } catch (const Error& error) {  // the guide cannot be read, so only commands are searched
    context.messages->warn(error.what());
  }
  return std::make_unique<CommandSearch>(std::move(guide));
}

}  // namespace limber::editor
