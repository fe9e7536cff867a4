// SPDX-License-Identifier: AGPL-3.0-or-later
// Tests the tool header of a window that gets narrower.
#include <doctest/doctest.h>

#include "editor/context/operator.h"
#include "editor/context/screen.h"
#include "editor/ui/ui.h"
#include "tests/editor/small_editor.h"
#include "tests/editor/small_limb.h"

using namespace limber;
using namespace limber::editor;
using namespace limber::test;

TEST_CASE("tool header: as a window gets narrower, groups of the Resample workspace lose their labels one by one") {
  std::vector<std::size_t> counts;
  for (int width = 1700; width >= 1180; width -= 40) {
    LimbEditor test({width, 760});
    test.play("key Ctrl+4\nwait-idle");
    const Rect& header = test.editor->screen->layout.tool_header;
    std::size_t labelled = 0;
    for (const char* id : {"compare.side_by_side", "result.overlap", "fem.tets", "report.open", "file.export"}) {
      const Operator* op = find_operator(test.editor->operators, id);
      for (const Widget& widget : test.editor->ui->widgets.widgets())
        if (widget.region == Region::ToolHeader && widget.name.ends_with(id)) {
          CHECK(widget.rect.high.x <= header.high.x);
          labelled += widget.rect.width() > 44;
        }
      REQUIRE(op);
    }
    counts.push_back(labelled);
  }
  CHECK(counts.front() == 5);
  for (std::size_t i = 1; i < counts.size(); ++i) {
    CHECK(counts[i] <= counts[i - 1]);
    CHECK(counts[i - 1] - counts[i] <= 1);
  }
  CHECK(counts.back() < 5);
}

TEST_CASE("tool header: no button of the Rig workspace moves when a rig is fitted") {
  LimbEditor test({1280, 720});
  const auto places = [&] {
    std::vector<std::pair<std::string, float>> all;
    for (const Widget& widget : test.editor->ui->widgets.widgets())
      if (widget.region == Region::ToolHeader) all.emplace_back(widget.name, widget.rect.low.x);
    return all;
  };
  const auto with_rig = places();
  REQUIRE(with_rig.size() > 6);
  Document bare = test.editor->document();
  bare.armature = nullptr;
  bare.pose = nullptr;
  test.editor->history->reset(bare, "Without a rig");
  test.play("wait-idle");
  CHECK(places() == with_rig);
}
