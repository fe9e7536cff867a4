// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/guide/book_html.h"

#include <algorithm>
#include <filesystem>
#include <regex>
#include <set>

#include <nlohmann/json.hpp>

#include "tests/editor/small_editor.h"

using namespace limber;
using namespace limber::editor;
using namespace limber::test;
namespace fs = std::filesystem;

namespace {

Book guide() {
  return read_guide([](const std::string& id) { return "<" + id + ">"; });
}

// Returns the first group of each match.
std::vector<std::string> matches(const std::string& text, const std::string& pattern) {
  const std::regex expression(pattern);
  std::vector<std::string> found;
  for (std::sregex_iterator at(text.begin(), text.end(), expression), end; at != end; ++at)
    found.push_back((*at)[1].str());
  return found;
}

}  // namespace

TEST_CASE("guide html: every page is a file, every link leads to one, and elements are closed in order") {
  const Book book = guide();
  const auto files = html_files(book);
  CHECK(files.size() == book.pages.size() + 2);
  for (const auto& [name, text] : files) {
    INFO(name);
    // The page loads nothing from a network: every file that it names belongs to the book.
    CHECK(text.find("@import") == std::string::npos);
    CHECK(text.find("url(") == std::string::npos);
    CHECK(text.find("http") == std::string::npos);
    if (!name.ends_with(".html")) continue;
    for (const std::string& target : matches(text, "(?:href|src)=\"([^\"]*)\""))
      CHECK((files.contains(target) || fs::exists(fs::path(LIMBER_SOURCE_DIR) / "assets/docs/guide" / target)));
    std::vector<std::string> open;
    const std::set<std::string> empty{"meta", "link", "input", "img"};
    for (const std::string& tag : matches(text.substr(text.find("<html")), "<(/?[a-z0-9]+)[ >]")) {
      if (tag[0] != '/') {
        if (!empty.contains(tag)) open.push_back(tag);
        continue;
      }
      REQUIRE_FALSE(open.empty());
      CHECK(open.back() == tag.substr(1));
      open.pop_back();
    }
    CHECK(open.empty());
  }
}

TEST_CASE("guide html: marks of HTML in the text are text, steps keep their numbers, keys are keys") {
  Book book;
  book.pages.push_back({"guide", "A & B",
                        parse_markdown("# A & B\n\n1. One `a<b`\n2. Press {x.y}\n\nEnd \"now\".\n",
                                       [](const std::string&) { return std::string("Ctrl+<"); })});
  const std::string page = html_files(book).at("index.html");
  for (const char* part : {"<h1>A &amp; B</h1>", "<ol>\n<li value=\"1\">One <code>a&lt;b</code></li>\n",
                           "<li value=\"2\">Press <kbd>Ctrl+&lt;</kbd></li>\n</ol>\n<p>End &quot;now&quot;.</p>"})
    CHECK(page.find(part) != std::string::npos);
}

TEST_CASE(
    "guide html: on a narrow screen the list of pages stays away while hits are shown, though the field has focus") {
  const std::string style = html_files(guide()).at("guide.css");
  const std::size_t shows = style.find("nav:focus-within #pages{display:block}"),
                    hides = style.find("#pages[hidden]{display:none!important}");
  CHECK(shows != std::string::npos);
  CHECK(hides != std::string::npos);
}

TEST_CASE("guide html: the search knows each page's title and text") {
  const Book book = guide();
  const std::string script = html_files(book).at("guide.js");
  const std::string begin = "const book=";
  REQUIRE(script.starts_with(begin));
  const auto pages = nlohmann::json::parse(script.substr(begin.size(), script.find(";\n") - begin.size()));
  REQUIRE(pages.size() == book.pages.size() - 1);
  for (std::size_t p = 0; p < pages.size(); ++p) {
    CHECK(pages[p]["title"] == book.pages[p + 1].title);
    CHECK(pages[p]["lines"].size() > 0);
  }
}

TEST_CASE("limber guide: writes the book with its pictures, and says where it begins") {
  const TemporaryFolder folder;
  const ProgramRun run = run_limber({"guide", "--html", folder / "book"});
  CHECK(run.exit_code == 0);
  CHECK(run.out == (folder / "book/index.html").string() + "\n");
  const Book book = guide();
  for (const Page& page : book.pages)
    for (const Block& block : page.blocks)
      if (block.kind == Block::Kind::Picture) CHECK(std::filesystem::exists(folder / "book" / block.picture));
  CHECK(std::filesystem::exists(folder / "book/recipe-take.html"));

  write_file_atomically(folder / "file", "not a folder");
  const ProgramRun refused = run_limber({"guide", "--html", folder / "file"});
  CHECK(refused.exit_code == 1);
  CHECK(refused.err.find("the folder cannot be made") != std::string::npos);
  CHECK(run_limber({"guide"}).exit_code == 2);
}
