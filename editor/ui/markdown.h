// SPDX-License-Identifier: AGPL-3.0-or-later
// Reads the few things of Markdown that the program's own documents use: headings, paragraphs, lists, **strong**,
// *names* and `code`. "{view.xray}" is the key of that operator, as the reader of the document has it.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace limber::editor {

struct Run {
  enum class Style { Plain, Strong, Name, Code, Key } style = Style::Plain;
  std::string text;

  bool operator==(const Run&) const = default;
};

struct Block {
  enum class Kind { Title, Heading, Paragraph, Point } kind = Kind::Paragraph;
  std::vector<Run> runs;

  bool operator==(const Block&) const = default;
};

// `key_of` gives the text of an operator's key.
std::vector<Block> parse_markdown(std::string_view text,
                                  const std::function<std::string(const std::string& operator_id)>& key_of);
std::string plain_text(const Block& block);

}  // namespace limber::editor
