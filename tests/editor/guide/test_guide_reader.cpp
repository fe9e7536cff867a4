// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/guide/guide_reader.h"
#include "editor/ui/ui.h"

#include <filesystem>
#include <sstream>

#include "editor/guide/book.h"
#include "tests/editor/small_editor.h"

using namespace limber;
using namespace limber::editor;
using namespace limber::test;
namespace fs = std::filesystem;

TEST_CASE("guide reader: F1 opens it, and its pages are turned, clicked and searched") {
  SmallEditor test({1280, 720});
  test.play(R"(
    key F1
    expect "text:User guide"
    click "pages/Look inside"
    expect text:Alt+Z
    click next
    expect "text:Measure distance needs two clicks."
    click previous
    expect text:Alt+Z
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
    key Escape
  )");
  CHECK(test.fact("dialog") == "no");
}

TEST_CASE("guide reader: Home and End go to the ends of a page, Space and PageUp a window along it") {
  SmallEditor test({1280, 720});
  test.play("key F1\n key Alt+Right\n expect \"text:Five steps from a sample to a bent arm.\"");
  // Returns the visible part of the page's picture; empty if it is scrolled out of view.
  const auto picture = [&] {
    const Widget* shown = test.editor->ui->widgets.find("picture images/first-pose.png");
    return shown ? std::pair(shown->rect.low.y, shown->rect.high.y) : std::pair(0.0f, 0.0f);
  };
  const auto top = picture();
  test.play("key End");
  const auto bottom = picture();
  CHECK(bottom != top);
  test.play("key Down");
  CHECK(picture() == bottom);
  test.play("key Home");
  CHECK(picture() == top);
  test.play("key Space");
  CHECK(picture() != top);
  test.play("key PageUp");
  CHECK(picture() == top);
}

TEST_CASE("guide reader: Alt+Left goes back to the page before, Alt+Right forward again, and both on by the order") {
  SmallEditor test({1280, 720});
  const char* measure = "expect \"text:Measure distance needs two clicks.\"\n";
  const char* inside = "expect text:Alt+Z\n";
  test.play("key F1\n click \"pages/Measure\"\n click \"pages/Look inside\"\n");
  test.play(std::string(inside) + "key Alt+Left\n" + measure + "key Alt+Right\n" + inside);
  // Opening a page clears the forward history. Then Alt+Right turns to the next page of the book.
  test.play(std::string("key Alt+Left\n click \"pages/Look inside\"\n key Alt+Right\n") + measure);
  test.play(std::string("key Alt+Left\n") + inside + "key Alt+Left\n" + measure);
  // Before the first visited page comes the cover, and nothing comes before the cover.
  test.play(
      "key Alt+Left\n expect \"text:Limber changes the pose of labelled voxel anatomy.\"\n key Alt+Left\n"
      "expect \"text:Limber changes the pose of labelled voxel anatomy.\"\n");
}

TEST_CASE("guide reader: a page that one comes back to stands where it was left") {
  SmallEditor test({1280, 720});
  test.play("key F1\n key Alt+Right\n key End");
  const auto shown = [&] {
    const Widget* picture = test.editor->ui->widgets.find("picture images/first-pose.png");
    return picture ? std::pair(picture->rect.low.y, picture->rect.high.y) : std::pair(0.0f, 0.0f);
  };
  const auto left = shown();
  test.play("key Home");
  CHECK(shown() != left);
  test.play("key End\n click next\n key Alt+Left");
  CHECK(shown() == left);
}

TEST_CASE("guide reader: Return opens the first hit only while it is typed in the field") {
  SmallEditor test({1280, 720});
  test.play(R"(
    key F1
    key Ctrl+F
    type "girth"
    key Return
    expect "text:Measure distance needs two clicks."
    click next
    expect "text:Each of these is one edit that can be undone"
    key Return
    expect "text:Each of these is one edit that can be undone"
    key Escape
  )");
}

TEST_CASE("guide reader: a missing page is told in a message, and the program goes on") {
  const TemporaryFolder folder;
  fs::create_directories(folder.path() / "bin");
  fs::create_directories(folder.path() / "share/limber/docs");
  fs::copy_file(LIMBER_PROGRAM, folder / "bin/limber");  // this copy looks for its files beside itself first
  write_file_atomically(folder / "share/limber/docs/guide.md", "# User guide\n\n## One\n\n- [Gone](guide/gone.md)\n");
  write_file_atomically(folder / "script", "key F1\nexpect dialog no\nexpect text:docs/guide/gone.md\n");
  const std::string home = folder.path().string();
  const ProgramRun run = run_program(
      "/usr/bin/env", {"HOME=" + home, "XDG_CONFIG_HOME=" + home, "XDG_CACHE_HOME=" + home, "XDG_STATE_HOME=" + home,
                       folder / "bin/limber", "editor", "--size", "1280x720", "--play", folder / "script"});
  CHECK_MESSAGE(run.exit_code == 0, run.err);
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
