// SPDX-License-Identifier: AGPL-3.0-or-later
// The user guide as a book. assets/docs/guide.md is its cover and its table of contents: a heading for each chapter,
// and below it a link to each page of the chapter. A page is a Markdown file of assets/docs/guide, and tells of one
// task. Pictures lie in assets/docs/guide/images; scripts of the same names in assets/docs/guide/scripts make them.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "editor/ui/markdown.h"

namespace limber::editor {

struct Page {
  std::string name;  // the file's name without its folder and ending; the cover's is "guide"
  std::string title;
  std::vector<Block> blocks;  // as in the file: the first one is the title
};

struct Chapter {
  std::string title;
  std::vector<int> pages;  // indices into Book::pages
};

struct Book {
  std::vector<Page> pages;  // in reading order; the first one is the cover
  std::vector<Chapter> chapters;
};

// Reads the guide. `key_of` as in parse_markdown(). Throws Error where a page is missing or has no title.
Book read_guide(const std::function<std::string(const std::string& operator_id)>& key_of);

// Returns the index of the page that a link such as "guide/paint.md" or "paint.md" leads to; -1: to none.
int page_of(const Book& book, const std::string& target);

// Splits a text where a full stop or a question mark is followed by a blank and a capital.
std::vector<std::string> sentences_of(const std::string& text);

// A page that was found, and the sentence in it that fits best.
struct Found {
  int page = 0, block = 0;
  std::string sentence;
};
// Returns the pages that contain every word of the query, ignoring case. Pages with the words in their titles come
// first, then those with all of them in a heading, in one sentence, and last those that have them in several sentences.
// Pages of one kind stay in reading order. A query without words finds nothing.
std::vector<Found> find_in(const Book& book, const std::string& query);

}  // namespace limber::editor
