// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/ui/markdown.h"

#include <algorithm>
#include <charconv>
#include <optional>
#include <utility>

namespace limber::editor {

namespace {

struct Mark {
  std::string_view open, close;
  Run::Style style;
};
constexpr Mark kMarks[] = {{"**", "**", Run::Style::Strong},
                           {"*", "*", Run::Style::Name},
                           {"`", "`", Run::Style::Code},
                           {"{", "}", Run::Style::Key}};

// Parses a link "[text](target)" at the beginning of the text and removes it from the text. Returns nothing if the
// text does not begin with a link.
std::optional<Run> take_link(std::string_view& text) {
  if (!text.starts_with('[')) return std::nullopt;
  const auto middle = text.find("](");
  const auto end = middle == std::string_view::npos ? middle : text.find(')', middle);
  if (end == std::string_view::npos || text.substr(1, middle - 1).find('[') != std::string_view::npos)
    return std::nullopt;
  const Run link{Run::Style::Link, std::string(text.substr(1, middle - 1)),
                 std::string(text.substr(middle + 2, end - middle - 2))};
  text.remove_prefix(end + 1);
  return link;
}

std::vector<Run> runs_of(std::string_view text, const std::function<std::string(const std::string&)>& key_of) {
  std::vector<Run> runs;
  std::string plain;
  while (!text.empty()) {
    if (const auto link = take_link(text)) {
      if (!plain.empty()) runs.push_back({Run::Style::Plain, std::exchange(plain, "")});
      runs.push_back(*link);
      continue;
    }
    bool marked = false;
    for (const Mark& mark : kMarks) {
      if (!text.starts_with(mark.open)) continue;
      const auto end = text.find(mark.close, mark.open.size());
      if (end == std::string_view::npos || end == mark.open.size()) continue;
      if (!plain.empty()) runs.push_back({Run::Style::Plain, std::exchange(plain, "")});
      const std::string inside(text.substr(mark.open.size(), end - mark.open.size()));
      runs.push_back({mark.style, mark.style == Run::Style::Key ? key_of(inside) : inside});
      text.remove_prefix(end + mark.close.size());
      marked = true;
      break;
    }
    if (marked) continue;
    plain += text.front();
    text.remove_prefix(1);
  }
  if (!plain.empty()) runs.push_back({Run::Style::Plain, plain});
  return runs;
}

// The kind of block that a line begins, and the number of characters of its marker ("## ", "- ", "1. ").
struct Beginning {
  Block::Kind kind = Block::Kind::Paragraph;
  std::size_t length = 0;
  int number = 0;
};
Beginning beginning_of(std::string_view line) {
  if (line.starts_with("# ")) return {Block::Kind::Title, 2};
  if (line.starts_with("## ")) return {Block::Kind::Heading, 3};
  if (line.starts_with("- ")) return {Block::Kind::Point, 2};
  int number = 0;
  const auto digits = std::from_chars(line.data(), line.data() + line.size(), number);
  const auto length = static_cast<std::size_t>(digits.ptr - line.data());
  if (digits.ec == std::errc() && number > 0 && line.substr(length).starts_with(". "))
    return {Block::Kind::Step, length + 2, number};
  return {};
}

// Parses a line that is a picture, "![caption](file)". Returns nothing for any other line.
std::optional<Block> picture_of(std::string_view line) {
  if (!line.starts_with('!')) return std::nullopt;
  line.remove_prefix(1);
  const auto link = take_link(line);
  if (!link || !line.empty()) return std::nullopt;
  return Block{Block::Kind::Picture, {{Run::Style::Plain, link->text}}, 0, link->target};
}

}  // namespace

std::vector<Block> parse_markdown(std::string_view text, const std::function<std::string(const std::string&)>& key_of) {
  std::vector<Block> blocks;
  std::string open;  // text of the block that is being read: the block's lines, joined by spaces
  Beginning of_block;
  const auto end_block = [&] {
    if (!open.empty()) blocks.push_back({of_block.kind, runs_of(open, key_of), of_block.number});
    open.clear();
    of_block = {};
  };
  while (!text.empty()) {
    const auto end = std::min(text.find('\n'), text.size());
    std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    while (!line.empty() && (line.back() == ' ' || line.back() == '\r')) line.remove_suffix(1);
    const Beginning beginning = beginning_of(line);
    const auto picture = picture_of(line);
    if (line.empty() || beginning.length > 0 || picture) end_block();
    if (picture) blocks.push_back(*picture);
    if (line.empty() || picture) continue;
    if (beginning.length > 0) of_block = beginning;
    line.remove_prefix(beginning.length);
    open += (open.empty() ? "" : " ") + std::string(line);
    if (beginning.kind == Block::Kind::Title || beginning.kind == Block::Kind::Heading) end_block();
  }
  end_block();
  return blocks;
}

std::string plain_text(const Block& block) {
  std::string text;
  for (const Run& run : block.runs) text += run.text;
  return text;
}

}  // namespace limber::editor
