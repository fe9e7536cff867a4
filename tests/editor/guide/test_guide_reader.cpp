// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/guide/guide_reader.h"

#include <sstream>

#include "editor/guide/book.h"
#include "tests/editor/small_editor.h"

using namespace limber;
using namespace limber::editor;
using namespace limber::test;

TEST_CASE("guide reader: F1 opens it, and its pages are turned, clicked and searched") {
  SmallEditor test({1280, 720});
  test.play(R"(
    key F1
    expect "text:User guide"
    click "pages/Look inside"
    expect text:Alt+Z
    key Home
    key End
    click next
    expect "text:Measure"
    expect "text:Measure distance needs two clicks."
    key Alt+Left
    key Alt+Left
    expect "text:Turn, shift and zoom"
    click previous
    key Escape
    expect dialog no
  )");
  test.play(R"(
    key F1
    key Ctrl+F
    type "feet that stand"
    expect "text:Clean a take"
    click "found/Clean a take"
    expect "text:A take from a camera or a suit trembles, and its feet slide."
    click clear
    key End
    key Home
    key Escape
  )");
  CHECK(test.fact("dialog") == "no");
}

TEST_CASE("guide reader: the first page that is found opens by Return, and words that no page has say so") {
  SmallEditor test({1280, 720});
  test.play(R"(
    key F1
    key Ctrl+F
    type "girth"
    key Return
    expect "text:Measure distance needs two clicks."
    click clear
    key Ctrl+F
    type "xylophone"
    expect "text:No page has these words"
    click "Clear search"
    expect "text:First steps"
    key Escape
  )");
}

TEST_CASE("guide reader: a link leads to its page") {
  SmallEditor test({1280, 720});
  test.play("key F1\n click \"pages/Open a file\"\n");
  const Book book = read_guide([](const std::string& id) { return id; });
  int block = -1, word = 0;
  const Page& page = book.pages[page_of(book, "open.md")];
  for (int b = 0; b < std::ssize(page.blocks) && block < 0; ++b) {
    word = 0;
    for (const Run& run : page.blocks[b].runs) {
      if (run.style == Run::Style::Link) {
        block = b;
        break;
      }
      std::istringstream in(run.text);
      for (std::string one; in >> one;) ++word;
    }
  }
  REQUIRE(block >= 0);
  test.play("key PageDown\n click \"link " + std::to_string(block) + "/" + std::to_string(word) + "\"");
  test.play("expect \"text:A grey image is shown below the tissues, and follows the pose.\"\n key Escape");
}
