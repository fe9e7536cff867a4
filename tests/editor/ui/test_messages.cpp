// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/context/screen.h"
#include "editor/ui/messages.h"
#include "editor/ui/ui.h"

#include "tests/editor/small_editor.h"

using namespace limber;
using namespace limber::editor;
using namespace limber::test;

TEST_CASE("messages: an error's line falls into title, place and advice, and the whole of it can be read and copied") {
  const ErrorMessage message = parts_of("the file ends too early: leg.mha: slice 12: copy it again");
  CHECK(message.what == "The file ends too early");
  CHECK(message.where == "leg.mha: slice 12");
  CHECK(message.what_to_do == "Copy it again");

  SmallEditor test;
  test.editor->messages->show_error("the file ends too early: leg.mha: slice 12: copy it again", "Open leg.mha");
  test.play(R"(
    expect "text:The file ends too early"
    expect "text:Nothing was changed"
    expect "text:During: Open leg.mha" absent
    click Details
    expect "text:During: Open leg.mha"
    click "Copy message"
    key Return
    expect error none
  )");
  const std::string copied = test.host->clipboard();
  CHECK(copied.starts_with(
      "During: Open leg.mha\nthe file ends too early:\nleg.mha:\nslice 12:\ncopy it again\nLimber "));
}

TEST_CASE("messages: notes fade, warnings later, errors stay until they are closed") {
  SmallEditor test;
  test.editor->messages->info("A note");
  test.editor->messages->warn("A warning");
  test.editor->messages->toast_failure("the job broke: in the middle: mend it", "Job");
  test.play(
      "move 10 300\n expect \"text:A note\"\n wait 5\n expect \"text:A note\" absent\n expect \"text:A warning\"\n "
      "wait 4\n expect \"text:A warning\" absent");
  test.play(R"(
    wait 60
    expect "text:The job broke"
    click "toast 0/Details"
    expect error "The job broke"
    expect "text:Mend it"
    key Escape
    expect error none
    expect "text:The job broke"
    click "Close message"
    expect toast none
  )");
}

TEST_CASE("messages: three are seen, the older ones are counted and kept in the console") {
  SmallEditor test;
  for (int i = 1; i <= 5; ++i) test.editor->messages->toast_error("Error " + std::to_string(i));
  test.play(R"(
    expect "text:Error 5"
    expect "text:Error 3"
    expect "text:Error 2" absent
    expect "text:+2 more"
    click toasts/more
    expect toast none
    expect "text:Error 1"
    double-click "bottom/lines/line 2"
    expect error "Error 2"
  )");
}

TEST_CASE("messages: long ones take more lines and stay whole, within the window") {
  SmallEditor test;
  test.editor->messages->warn("Resampled in two hundred and twelve seconds by dual quaternions",
                              std::string(60, 'x') + " " + std::string(60, 'y'));
  test.play("expect \"text:dual quaternions\"");
  const Widget* close = test.editor->ui->widgets.find("Close message");
  REQUIRE(close);
  CHECK(test.editor->screen->layout.views.contains(close->rect));
  test.editor->messages->show_error(std::string(2000, 'w') + ": " + std::string(2000, 'v') + ": " +
                                    std::string(2000, 'u'));
  test.play("click Details");
  for (const char* name : {"Copy message", "dialog/Details"}) {
    const Widget* widget = test.editor->ui->widgets.find(name);
    REQUIRE(widget);
    CHECK(test.editor->screen->layout.window.contains(widget->rect));
  }
}

TEST_CASE("messages: in a small window neither they nor the console lie under or over the sidebar") {
  SmallEditor test({1024, 640});
  test.play("key N\nclick Help/Console");
  test.editor->messages->warn("A warning");
  test.play("wait 0.1");
  for (const char* name : {"Close message", "Close console"}) {
    const Widget* widget = test.editor->ui->widgets.find(name);
    REQUIRE(widget);
    CHECK_FALSE(widget->rect.overlaps(test.editor->screen->layout.sidebar));
  }
}
