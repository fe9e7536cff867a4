// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/context/operator.h"
#include "editor/input/keymap.h"

#include <set>

#include <doctest/doctest.h>

#include "editor/app/editor.h"
#include "editor/screen/menus.h"
#include "editor/ui/asset_path.h"

using namespace limber::editor;

TEST_CASE("keymap: every binding starts an operator that exists, and no key has two meanings in one place") {
  const Keymap keymap = read_keymap(asset("keymap.json"));  // throws if two keys clash
  std::set<std::string> known;
  for (const Operator& op : gather_operators()) known.insert(op.id);
  for (const auto& [context, bindings] : keymap.contexts)
    for (const Binding& binding : bindings) {
      INFO(context, " ", to_text(binding.chord), " ", binding.operator_id);
      CHECK(known.contains(binding.operator_id));
    }
}

TEST_CASE("operators: each has a name of its own, words and a description") {
  std::set<std::string> ids;
  for (const Operator& op : gather_operators()) {
    INFO(op.id);
    CHECK(ids.insert(op.id).second);
    CHECK_FALSE(op.label.empty());
    CHECK_FALSE(op.category.empty());
    CHECK(op.description.ends_with('.'));
    CHECK(op.run);
  }
}

TEST_CASE("keymap: the first context that knows a chord gives its meaning") {
  Keymap keymap;
  keymap.contexts["slice"] = {{*chord_from_text("Wheel"), "slice.step"}};
  keymap.contexts["global"] = {{*chord_from_text("Wheel"), "view.zoom_step"}};
  CHECK(*keymap.find(*chord_from_text("Wheel"), {"slice", "global"}) == "slice.step");
  CHECK(*keymap.find(*chord_from_text("Wheel"), {"view3d", "global"}) == "view.zoom_step");
  CHECK(keymap.find(*chord_from_text("G"), {"slice", "global"}) == nullptr);
}
