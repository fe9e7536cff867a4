// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/guide/book.h"

#include <algorithm>
#include <filesystem>
#include <set>

#include "editor/ui/asset_path.h"
#include "tests/editor/small_editor.h"

using namespace limber;
using namespace limber::editor;
using namespace limber::test;
namespace fs = std::filesystem;

namespace {

const fs::path kGuide = fs::path(LIMBER_SOURCE_DIR) / "assets/docs/guide";

Book guide() {
  return read_guide([](const std::string& id) { return "<" + id + ">"; });
}

std::set<std::string> names_in(const fs::path& folder, const std::string& ending) {
  std::set<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder))
    if (entry.path().extension() == ending) names.insert(entry.path().stem().string());
  return names;
}

std::set<std::string> pictures_of(const Page& page) {
  std::set<std::string> pictures;
  for (const Block& block : page.blocks)
    if (block.kind == Block::Kind::Picture) pictures.insert(block.picture);
  return pictures;
}

// Makes four pages. The word "elbow" is in a title, in one sentence, in two sentences, or only in a heading.
Book small_book() {
  Book book;
  book.pages.resize(4);
  const std::pair<const char*, const char*> pages[] = {
      {"guide", "# Guide\n\nThe elbow and the knee.\n"},
      {"knee", "# The knee\n\nIt bends. An elbow does, too. Look at the hip.\n"},
      {"elbow", "# The elbow\n\nWhat is true of a hinge. The second sentence.\n"},
      {"hip", "# The hip\n\nNo hinge.\n\n## How an elbow differs\n\nIt does.\n"}};
  for (std::size_t i = 0; i < 4; ++i) {
    book.pages[i] = {pages[i].first, "", parse_markdown(pages[i].second, [](const std::string& id) { return id; })};
    book.pages[i].title = plain_text(book.pages[i].blocks[0]);
  }
  return book;
}

}  // namespace

TEST_CASE("guide: every page is in the contents once, in a chapter, and has no other name than its title") {
  const Book book = guide();
  std::set<std::string> names, titles;
  for (const Page& page : book.pages) {
    INFO(page.name);
    CHECK(names.insert(page.name).second);
    CHECK(titles.insert(page.title).second);
    CHECK(std::count_if(page.blocks.begin(), page.blocks.end(),
                        [](const Block& block) { return block.kind == Block::Kind::Title; }) == 1);
  }
  names.erase("guide");
  CHECK(names == names_in(kGuide, ".md"));

  std::size_t in_chapters = 1;  // the cover belongs to no chapter
  for (const Chapter& chapter : book.chapters) {
    CHECK_FALSE(chapter.pages.empty());
    in_chapters += chapter.pages.size();
  }
  CHECK(in_chapters == book.pages.size());
  for (const Block& block : book.pages[0].blocks)
    for (const Run& run : block.runs)
      if (run.style == Run::Style::Link && block.kind == Block::Kind::Point)
        CHECK(book.pages[page_of(book, run.target)].title == run.text);
}

TEST_CASE("guide: links lead to pages, and no mark is left unread") {
  const Book book = guide();
  int links = 0;
  for (const Page& page : book.pages)
    for (const Block& block : page.blocks) {
      INFO(page.name, ": ", plain_text(block));
      for (const Run& run : block.runs) {
        if (run.style == Run::Style::Link) {
          ++links;
          CHECK(page_of(book, run.target) > 0);
          CHECK((run.target ==
                 (page.name == "guide" ? "guide/" : "") + book.pages[page_of(book, run.target)].name + ".md"));
        }
        if (run.style != Run::Style::Code) CHECK(run.text.find("](") == std::string::npos);
        if (run.style == Run::Style::Plain) CHECK(run.text.find_first_of("*`{}") == std::string::npos);
      }
    }
  CHECK(links > 60);
}

TEST_CASE("guide: each picture is there, belongs to a page and to the script that makes it, and is small") {
  std::set<std::string> shown;
  for (const Page& page : guide().pages) shown.merge(pictures_of(page));
  std::set<std::string> named;
  std::uintmax_t bytes = 0;
  for (const std::string& name : names_in(kGuide / "images", ".png")) {
    named.insert("images/" + name + ".png");
    bytes += fs::file_size(kGuide / "images" / (name + ".png"));
  }
  CHECK(shown == named);
  CHECK(names_in(kGuide / "images", ".png") == names_in(kGuide / "scripts", ".play"));
  CHECK(shown.size() >= 8);
  CHECK(bytes < 1'500'000);
}

TEST_CASE("guide: the search puts titles first, then headings, then one sentence, then words that stand apart") {
  const Book book = small_book();
  const std::vector<Found> elbow = find_in(book, "ELBOW");
  REQUIRE(elbow.size() == 3);
  CHECK(book.pages[elbow[0].page].name == "elbow");
  CHECK(elbow[0].sentence == "What is true of a hinge.");
  CHECK(elbow[0].block == 0);
  CHECK(book.pages[elbow[1].page].name == "hip");
  CHECK(elbow[1].sentence == "How an elbow differs");
  CHECK(book.pages[elbow[2].page].name == "knee");
  CHECK(elbow[2].sentence == "An elbow does, too.");

  const std::vector<Found> apart = find_in(book, "bends  hip");
  REQUIRE(apart.size() == 1);
  CHECK(apart[0].page == 1);
  CHECK(apart[0].sentence == "It bends.");
  CHECK(find_in(book, "shoulder").empty());
  CHECK(find_in(book, "  ").empty());
}

TEST_CASE("guide: whoever asks for a task by its own words finds its page") {
  const Book book = guide();
  for (const auto& [words, page] : {std::pair{"clean take", "clean"},
                                    {"seated", "recipe-ct"},
                                    {"two-stroke", "recipe-elbow"},
                                    {"girth", "measure"},
                                    {"--plant-feet", "clean"},
                                    {"leak", "labels"},
                                    {"Krippendorff", "study"}}) {
    const std::vector<Found> found = find_in(book, words);
    INFO(std::string(words));
    CHECK(std::any_of(found.begin(), found.begin() + std::min<std::ptrdiff_t>(4, std::ssize(found)),
                      [&](const Found& one) { return book.pages[one.page].name == page; }));
  }
}
