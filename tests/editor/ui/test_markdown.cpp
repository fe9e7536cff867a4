// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/ui/markdown.h"

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

TEST_CASE("user guide: its lists of formats, exporters and brushes are the program's tables") {
  const std::string guide = with_tables(read_file(asset("docs/guide.md")));
  CHECK(guide.find("{table.") == std::string::npos);
  for (const char* word : {"VTK image", ".gprmax.h5 (gprMax geometry)", "Smear: Drags weights along."})
    CHECK(guide.find(word) != std::string::npos);
}

TEST_CASE("user guide: it opens by F1, goes to a chapter, and names only operators that exist and have a key") {
  SmallEditor test({1280, 720});
  test.play(R"(
    key F1
    expect "text:User guide"
    expect text:Alt+Z
    click "chapters/5 Resample"
    key Home
    key End
    key Escape
    expect dialog no
    click "Help/What is new"
    expect "text:What is new"
    key Escape
  )");
  for (const char* name : {"docs/guide.md", "docs/new.md"})
    parse_markdown(with_tables(read_file(asset(name))), [&](const std::string& id) {
      INFO(name, ": ", id);
      CHECK(find_operator(*test.editor, id));
      CHECK(test.editor->keymap.chord_of(id));
      return id;
    });
}
