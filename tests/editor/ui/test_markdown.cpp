// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/context/operator.h"
#include "editor/input/keymap.h"
#include "editor/ui/markdown.h"

#include <filesystem>

#include "editor/dialogs/text_viewer.h"
#include "editor/ui/asset_path.h"
#include "tests/editor/small_editor.h"

using namespace limber;
using namespace limber::editor;
using namespace limber::test;

TEST_CASE("markdown: headings, paragraphs over several lines, points, marks and keys") {
  const auto blocks = parse_markdown("# A\n\nOne **two**\nthree `four`.\n- five {view.xray}\n- six * seven\n## B\n",
                                     [](const std::string& id) { return "<" + id + ">"; });
  REQUIRE(blocks.size() == 5);
  CHECK(blocks[0] == Block{Block::Kind::Title, {{Run::Style::Plain, "A"}}});
  CHECK(blocks[1] == Block{Block::Kind::Paragraph,
                           {{Run::Style::Plain, "One "},
                            {Run::Style::Strong, "two"},
                            {Run::Style::Plain, " three "},
                            {Run::Style::Code, "four"},
                            {Run::Style::Plain, "."}}});
  CHECK(blocks[2] == Block{Block::Kind::Point, {{Run::Style::Plain, "five "}, {Run::Style::Key, "<view.xray>"}}});
  CHECK(plain_text(blocks[3]) == "six * seven");
  CHECK(blocks[4].kind == Block::Kind::Heading);
}

TEST_CASE("markdown: steps with their numbers, pictures on lines of their own, links with their targets") {
  const auto blocks =
      parse_markdown("1. One\n2. Two [a page](b.md), three\nmore\n\n![It *bends*](images/x.png)\n12th. [no link\n",
                     [](const std::string& id) { return id; });
  REQUIRE(blocks.size() == 4);
  CHECK(blocks[0] == Block{Block::Kind::Step, {{Run::Style::Plain, "One"}}, 1});
  CHECK(blocks[1] ==
        Block{Block::Kind::Step,
              {{Run::Style::Plain, "Two "}, {Run::Style::Link, "a page", "b.md"}, {Run::Style::Plain, ", three more"}},
              2});
  CHECK(blocks[2] == Block{Block::Kind::Picture, {{Run::Style::Plain, "It *bends*"}}, 0, "images/x.png"});
  CHECK(blocks[3] == Block{Block::Kind::Paragraph, {{Run::Style::Plain, "12th. [no link"}}});
}

namespace {

std::vector<std::string> documents() {
  std::vector<std::string> names{"docs/guide.md", "docs/new.md"};
  for (const auto& entry : std::filesystem::directory_iterator(asset("docs/guide")))
    if (entry.path().extension() == ".md") names.push_back("docs/guide/" + entry.path().filename().string());
  return names;
}

}  // namespace

TEST_CASE("user guide: its lists of formats, exporters and brushes are the program's tables") {
  std::string guide;
  for (const std::string& name : documents()) guide += with_tables(read_file(asset(name)));
  CHECK(guide.find("{table.") == std::string::npos);
  for (const char* word : {"VTK image", ".gprmax.h5 (gprMax geometry)", "Smear: Drags weights along the stroke."})
    CHECK(guide.find(word) != std::string::npos);
}

TEST_CASE("markdown: what is new has no links, because its viewer follows none") {
  for (const Block& block : parse_markdown(read_file(asset("docs/new.md")), [](const std::string& id) { return id; }))
    for (const Run& run : block.runs) CHECK_MESSAGE(run.style != Run::Style::Link, run.text);
}

TEST_CASE("user guide: it names only operators that exist and have a key") {
  SmallEditor test({1280, 720});
  test.play("click \"Help/What is new\"\n expect \"text:What is new\"\n key Escape");
  CHECK(documents().size() > 40);
  for (const std::string& name : documents())
    parse_markdown(with_tables(read_file(asset(name))), [&](const std::string& id) {
      INFO(name, ": ", id);
      CHECK(find_operator(test.editor->operators, id));
      CHECK(test.editor->keymap->chord_of(id));
      return id;
    });
}
