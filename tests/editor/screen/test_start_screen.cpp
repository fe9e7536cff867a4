// SPDX-License-Identifier: AGPL-3.0-or-later
#include <fstream>

#include "editor/context/screen.h"
#include "editor/context/start_screen_state.h"
#include "editor/files/tour.h"
#include "editor/ui/ui.h"
#include "tests/editor/sitting.h"

using namespace limber;
using namespace limber::test;

TEST_CASE(
    "start screen: it shows recent files with pictures, opens one, and keeps those that are gone with a way to find "
    "them") {
  const Home home;
  { Sitting sitting(home.folder.path(), {home / "scans/ball.nrrd"}); }
  std::filesystem::copy_file(home / "scans/ball.nrrd", home / "other.nrrd");
  {
    Sitting sitting(home.folder.path(), {home / "other.nrrd"});
    CHECK_FALSE(sitting.editor().start_screen->shown);
  }
  std::filesystem::rename(home / "scans/ball.nrrd", home / "scans/moved.nrrd");
  Sitting sitting(home.folder.path());
  CHECK(sitting.editor().start_screen->shown);
  CHECK(sitting.editor().start_screen->facts.at(home / "other.nrrd").picture);
  CHECK(sitting.editor().start_screen->facts.at(home / "scans/ball.nrrd").missing);
  sitting.play(R"(
    expect text:Samples
    expect "text:moved or deleted"
    click "recent ball"
    expect dialog yes
    type scans
    key Return
    key Return
    wait-job
    expect volume yes
    expect name moved
  )");
  CHECK_FALSE(sitting.editor().start_screen->shown);
  CHECK(sitting.editor().recent_files->recents.size() == 2);
}

TEST_CASE("start screen: arrows and Return choose a recent file, the menu lists them too") {
  const Home home;
  { Sitting sitting(home.folder.path(), {home / "scans/ball.nrrd"}); }
  {
    Sitting sitting(home.folder.path());
    sitting.play("key Down\n key Up\n key Return\n wait-job\n expect name ball");
  }
  Sitting sitting(home.folder.path());
  sitting.play("click \"File/Open recent/ball.nrrd\"\n wait-job\n expect name ball");
}

TEST_CASE("start screen: a key that is a command closes it and runs, Escape closes it, it can be told to stay away") {
  const Home home;
  {
    Sitting sitting(home.folder.path());
    sitting.play("key Ctrl+3\n expect workspace pose");
    CHECK_FALSE(sitting.editor().start_screen->shown);
    sitting.play("key Ctrl+Shift+O\n expect text:Samples\n key Escape\n expect text:Samples absent");
    sitting.play("key Ctrl+Shift+O\n click \"Show at start\"");
  }
  Sitting sitting(home.folder.path());
  CHECK_FALSE(sitting.editor().start_screen->shown);
}

TEST_CASE("start screen: nothing covers anything, in a large window, a small one and at scale 2") {
  const Home home;
  { Sitting sitting(home.folder.path(), {home / "scans/ball.nrrd"}); }
  for (const glm::ivec2 size : {glm::ivec2(1600, 900), glm::ivec2(1024, 640), glm::ivec2(800, 520)}) {
    Sitting sitting(home.folder.path(), {}, size);
    sitting.play("wait-idle");
    const auto& widgets = sitting.editor().ui->widgets.widgets();
    int found = 0;
    for (std::size_t i = 0; i < widgets.size(); ++i) {
      if (widgets[i].region != editor::Region::Start) continue;
      ++found;
      for (std::size_t j = i + 1; j < widgets.size(); ++j) {
        if (widgets[j].region != editor::Region::Start) continue;
        INFO(size.x, "x", size.y, ": ", widgets[i].name, " and ", widgets[j].name);
        CHECK_FALSE(widgets[i].rect.overlaps(widgets[j].rect));
      }
    }
    CHECK(found >= 9);
  }
}

TEST_CASE("tour: it makes the sample, each step ends when it is done, and it goes on where it was left") {
  const Home home;
  {
    Sitting sitting(home.folder.path(), {}, {1280, 720});
    sitting.play(R"(
      click "Take the tour"
      wait-job
      expect volume yes
      expect "text:Turn the view"
      drag "3D view/view" 80 10 MMB
      expect "text:Look inside"
      click view.xray_display
      expect "text:Cut the body open"
      click "Skip step"
      expect "text:Hide a tissue"
      click "End tour"
      expect "text:Hide a tissue" absent
    )");
  }
  Sitting sitting(home.folder.path(), {home / "scans/ball.nrrd"}, {1280, 720});
  CHECK(sitting.editor().recent_files->tour_step == 3);
  sitting.play(R"(
    click Help/Tour
    expect "text:Hide a tissue"
    click Muscle/17/eye
    expect "text:Undo an edit"
    key Ctrl+Z
    expect "text:See slices"
    click view.four
    expect "text:Move the cross-hair"
    click "Skip step"
    expect "text:See tissue statistics"
    click Steps/Prepare/Statistics
    wait-job
    key Escape
    expect "text:Let tissue follow the bones"
    click "Skip step"
    expect "text:See the weights"
    click top/Skin
    expect "text:Pose the body"
    click top/Pose
    expect "text:Bend the elbow"
    click "Skip step"
    expect "text:Writes the posed arm"
    click "Skip step"
    expect "text:See the result"
    click top/Resample
    expect "toast" "The tour is finished"
  )");
  CHECK(sitting.editor().recent_files->tour_step == 0);
}

TEST_CASE("tour: toasts leave its bubble free, and the bubble leaves the middle of a small view free") {
  const Home home;
  Sitting sitting(home.folder.path(), {home / "scans/ball.nrrd"}, {1280, 720});
  sitting.play("click Help/Tour\n wait-idle\n click view.four\n wait-idle");
  const auto rect_of = [&](const char* name) -> editor::Rect {
    const editor::Widget* widget = sitting.editor().ui->widgets.find(name);
    REQUIRE_MESSAGE(widget, name);
    return widget ? widget->rect : editor::Rect{};
  };
  CHECK(!rect_of("tour/box").contains(rect_of("3D view/view").centre()));
  for (int message = 0; message < 3; ++message) sitting.editor().messages->info("A message " + std::to_string(message));
  sitting.play("wait 0.5");
  CHECK(!rect_of("tour/box").overlaps(rect_of("toast 0/box")));
  CHECK(rect_of("3D view/view").contains(rect_of("toast 0/box").centre()));
}

TEST_CASE("tour: the bubble is beside the sidebar and below the header, and hides none of their buttons") {
  const Home home;
  Sitting sitting(home.folder.path(), {home / "scans/ball.nrrd"}, {1280, 720});
  sitting.play("click Help/Tour\n wait-idle");
  const editor::Layout& layout = sitting.editor().screen->layout;
  int in_sidebar = 0, in_header = 0;
  for (int step = 0; step < std::ssize(editor::tour_steps()); ++step) {
    sitting.editor().tour->step = step;
    sitting.play("wait 1");
    const editor::WidgetRegistry& widgets = sitting.editor().ui->widgets;
    const editor::Widget *target = widgets.find(editor::tour_steps()[step].widget), *bubble = widgets.find("tour/box");
    INFO(editor::tour_steps()[step].widget);
    REQUIRE(bubble);
    if (!target) continue;
    if (layout.sidebar.contains(target->rect.centre())) {
      CHECK(bubble->rect.high.x < layout.sidebar.low.x);
      ++in_sidebar;
    } else if (layout.tool_header.contains(target->rect.centre())) {
      CHECK(bubble->rect.low.y > layout.tool_header.high.y - 1);
      ++in_header;
    }
  }
  CHECK(in_sidebar >= 2);
  CHECK(in_header >= 2);
}

TEST_CASE("opened volumes: the project's name has none of the file's two extensions") {
  const Home home;
  const Document body = small_body();
  for (const char* file : {"scan.nii.gz", "scan.seg.nrrd", "scan.nrrd"}) {
    CAPTURE(file);
    write_volume(*body.volume, home / file, *body.tissues);
    Sitting sitting(home.folder.path(), {home / file});
    CHECK(sitting.test.fact("name") == "scan");
  }
}
