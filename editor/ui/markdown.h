// SPDX-License-Identifier: AGPL-3.0-or-later
// Parses the subset of Markdown that the program's own documents use: headings, paragraphs, lists, numbered steps,
// pictures on lines of their own, [links](page.md), **strong**, *names* and `code`. "{view.xray}" is replaced by the
// key of the operator "view.xray" in the user's key map.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace limber::editor {

struct Run {
  enum class Style { Plain, Strong, Name, Code, Key, Link } style = Style::Plain;
  std::string text;
  std::string target = {};  // target of a link, as written in the file; unused in other runs

  bool operator==(const Run&) const = default;
};

struct Block {
  enum class Kind { Title, Heading, Paragraph, Point, Step, Picture } kind = Kind::Paragraph;
  std::vector<Run> runs;     // the block's text; of a picture: its caption
  int number = 0;            // number of a numbered step; unused in other blocks
  std::string picture = {};  // file of a picture, as written in the text; unused in other blocks

  bool operator==(const Block&) const = default;
};

// Splits a Markdown text into blocks. `key_of` returns the key of an operator as text, such as "Ctrl+Z".
std::vector<Block> parse_markdown(std::string_view text,
                                  const std::function<std::string(const std::string& operator_id)>& key_of);
std::string plain_text(const Block& block);

}  // namespace limber::editor
