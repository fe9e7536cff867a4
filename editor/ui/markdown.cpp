// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/ui/markdown.h"

#include <algorithm>
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

std::vector<Run> runs_of(std::string_view text, const std::function<std::string(const std::string&)>& key_of) {
  std::vector<Run> runs;
  std::string plain;
  while (!text.empty()) {
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

}  // namespace

std::vector<Block> parse_markdown(std::string_view text, const std::function<std::string(const std::string&)>& key_of) {
  std::vector<Block> blocks;
  std::string open;  // text of the block that is being read: the block's lines, joined by spaces
  Block::Kind kind = Block::Kind::Paragraph;
  const auto end_block = [&] {
    if (!open.empty()) blocks.push_back({kind, runs_of(open, key_of)});
    open.clear();
    kind = Block::Kind::Paragraph;
  };
  while (!text.empty()) {
    const auto end = std::min(text.find('\n'), text.size());
    std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    while (!line.empty() && (line.back() == ' ' || line.back() == '\r')) line.remove_suffix(1);
    const bool title = line.starts_with("# "), heading = line.starts_with("## "), point = line.starts_with("- ");
    if (line.empty() || title || heading || point) end_block();
    if (line.empty()) continue;
    kind = title ? Block::Kind::Title : heading ? Block::Kind::Heading : point ? Block::Kind::Point : kind;
    line.remove_prefix(heading ? 3 : title || point ? 2 : 0);
    open += (open.empty() ? "" : " ") + std::string(line);
    if (title || heading) end_block();
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
