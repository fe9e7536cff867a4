// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/guide/book.h"

#include <algorithm>
#include <cctype>
#include <optional>
#include <sstream>

#include "core/base/error.h"
#include "core/base/file.h"
#include "editor/dialogs/text_viewer.h"
#include "editor/ui/asset_path.h"
#include "editor/ui/fuzzy_match.h"

namespace limber::editor {

namespace {

using KeyOf = std::function<std::string(const std::string&)>;

std::string name_of(const std::string& target) { return Path(target).stem().string(); }

Page read_page(const std::string& file, const KeyOf& key_of) {
  Page page{name_of(file), "", parse_markdown(with_tables(read_file(asset(file))), key_of)};
  if (page.blocks.empty() || page.blocks[0].kind != Block::Kind::Title)
    throw Error("a page of the guide has no title", file, "begin the page with \"# Title\"");
  page.title = plain_text(page.blocks[0]);
  return page;
}

std::vector<std::string> words_of(const std::string& query) {
  std::istringstream in(query);
  std::vector<std::string> words;
  for (std::string word; in >> word;) words.push_back(word);
  return words;
}

std::size_t count_in(const std::vector<std::string>& words, const std::string& text) {
  return static_cast<std::size_t>(
      std::count_if(words.begin(), words.end(), [&](const auto& word) { return contains_ignoring_case(text, word); }));
}

struct Ranked {
  Found found;
  int rank = 0;  // rank of the match; pages with a lower rank are listed first
};

std::optional<Ranked> rank_page(const Page& page, int index, const std::vector<std::string>& words) {
  std::string all;
  for (const Block& block : page.blocks) all += plain_text(block) + "\n";
  if (count_in(words, all) < words.size()) return std::nullopt;

  Ranked best{{index, 0, ""}, 4};
  std::size_t most = 0;
  std::string first;  // the page's first sentence, which is shown if only the title matches
  for (int b = 1; b < std::ssize(page.blocks); ++b) {
    const Block& block = page.blocks[b];
    for (const std::string& sentence : sentences_of(plain_text(block))) {
      if (first.empty()) first = sentence;
      const std::size_t count = count_in(words, sentence);
      const int rank = count < words.size() ? 3 : block.kind == Block::Kind::Heading ? 1 : 2;
      if (count == 0 || rank > best.rank || (rank == best.rank && count <= most)) continue;
      best = {{index, b, sentence}, rank};
      most = count;
    }
  }
  if (count_in(words, page.title) == words.size()) return Ranked{{index, 0, first}, 0};
  return best;
}

}  // namespace

std::vector<std::string> sentences_of(const std::string& text) {
  std::vector<std::string> sentences{""};
  for (std::size_t i = 0; i < text.size(); ++i) {
    sentences.back() += text[i];
    const bool ends = i + 2 < text.size() && (text[i] == '.' || text[i] == '?') && text[i + 1] == ' ' &&
                      std::isupper(static_cast<unsigned char>(text[i + 2]));
    if (!ends) continue;
    sentences.emplace_back();
    ++i;
  }
  return sentences;
}

Book read_guide(const KeyOf& key_of) {
  Book book;
  book.pages.push_back(read_page("docs/guide.md", key_of));
  const std::vector<Block> contents = book.pages[0].blocks;
  for (const Block& block : contents) {
    if (block.kind == Block::Kind::Heading) book.chapters.push_back({plain_text(block), {}});
    if (block.kind != Block::Kind::Point || book.chapters.empty()) continue;
    for (const Run& run : block.runs) {
      if (run.style != Run::Style::Link) continue;
      book.chapters.back().pages.push_back(static_cast<int>(book.pages.size()));
      book.pages.push_back(read_page("docs/" + run.target, key_of));
    }
  }
  return book;
}

int page_of(const Book& book, const std::string& target) {
  if (!target.ends_with(".md")) return -1;
  const auto found = std::find_if(book.pages.begin(), book.pages.end(),
                                  [&](const Page& page) { return page.name == name_of(target); });
  return found == book.pages.end() ? -1 : static_cast<int>(found - book.pages.begin());
}

std::vector<Found> find_in(const Book& book, const std::string& query) {
  const std::vector<std::string> words = words_of(query);
  if (words.empty()) return {};
  std::vector<Ranked> ranked;
  for (int p = 1; p < std::ssize(book.pages); ++p)  // skips the cover, which only lists the titles of the other pages
    if (const auto one = rank_page(book.pages[p], p, words)) ranked.push_back(*one);
  std::stable_sort(ranked.begin(), ranked.end(), [](const Ranked& a, const Ranked& b) { return a.rank < b.rank; });
  std::vector<Found> found;
  for (Ranked& one : ranked) found.push_back(std::move(one.found));
  return found;
}

}  // namespace limber::editor
