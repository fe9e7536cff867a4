// SPDX-License-Identifier: AGPL-3.0-or-later
// The user guide as a book. assets/docs/guide.md is its cover and table of contents: a heading for each chapter, and
// below it a link to each page of the chapter. A page is a Markdown file in assets/docs/guide that describes one task.
// Its pictures are in assets/docs/guide/images; scripts of the same names in assets/docs/guide/scripts make them.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "editor/ui/markdown.h"

namespace limber::editor {

struct Page {
  std::string name;  // the file's name without folder and extension; the cover's name is "guide"
  std::string title;
  std::vector<Block> blocks;  // the page's text in the order of the file; the first block is the title
};

struct Chapter {
  std::string title;
  std::vector<int> pages;  // the chapter's pages, as indices into Book::pages
};

struct Book {
  std::vector<Page> pages;  // in reading order; the first one is the cover
  std::vector<Chapter> chapters;
};

// Reads the guide. `key_of` returns the key of an operator as text. Throws Error if a page is missing or has no title.
Book read_guide(const std::function<std::string(const std::string& operator_id)>& key_of);

// Returns the index of the page to which a link such as "guide/paint.md" or "paint.md" points; -1: there is no such
// page.
int page_of(const Book& book, const std::string& target);

// Splits a text into sentences, wherever a full stop or a question mark is followed by a space and a capital letter.
std::vector<std::string> sentences_of(const std::string& text);

// A page that matches a search, and the sentence in it that matches best.
struct Found {
  int page = 0, block = 0;
  std::string sentence;
};
// Returns the pages that contain every word of the query, ignoring case. Pages with all words in the title come first,
// then pages with all words in a heading, then in one sentence, then in several sentences. Pages with equal rank keep
// the reading order. A query without words finds nothing.
std::vector<Found> find_in(const Book& book, const std::string& query);

}  // namespace limber::editor
