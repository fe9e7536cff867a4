// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/context/keep_preferences.h"
#include "editor/context/operator.h"
#include "editor/context/preferences.h"
#include "editor/context/preferences_state.h"

#include <fstream>

#include "core/base/error.h"
#include "core/base/file.h"
#include "editor/input/keymap_overrides.h"
#include "tests/editor/small_editor.h"

using namespace limber;
using namespace limber::editor;
using namespace limber::test;

namespace {

Chord chord(const char* text) { return *chord_from_text(text); }

Keymap small_keymap() {
  Keymap keymap;
  keymap.contexts["select"] = {{chord("A"), "all"}, {chord("Alt+A"), "none"}, {chord("LMB"), "pick"}};
  return keymap;
}

}  // namespace

TEST_CASE("preferences: what is written reads back as the same") {
  Preferences preferences;
  preferences.theme = "light";
  preferences.scale = 1.75;
  preferences.reduce_motion = true;
  preferences.display = "xray";
  preferences.letters = false;
  preferences.undo_limit_mb = 64;
  preferences.worker_minutes = 2.5;
  preferences.scratch_folder = "/big/\"disk\"";
  preferences.keys[{"global", "edit.undo"}] = {"Ctrl+U"};
  preferences.keys[{"rig", "workspace.pose"}] = {};
  preferences.recent_commands = {"view.four", "view.one"};
  preferences.command_counts = {{"view.four", 3}};
  std::string problem;
  CHECK(preferences_from_json(to_json(preferences), problem) == preferences);
  CHECK(problem.empty());
}

TEST_CASE(
    "preferences: a damaged file gives the program's own and says so, wrong values are brought into range or left "
    "out") {
  std::string problem;
  for (const char* text : {"", "{", "[1]", "null", "{\"schema\": 3}", "{}"}) {
    problem.clear();
    CHECK(preferences_from_json(text, problem) == Preferences{});
    CHECK_FALSE(problem.empty());
  }
  problem.clear();
  const Preferences odd = preferences_from_json(
      R"({"schema": "limber-preferences/1", "interface": {"scale": 900, "theme": "pink", "tooltip_delay": "long"},
    "undo": {"limit_mb": -5}, "view": 7, "jobs": {"at_once": 1e300}, "keys": [3, {"context": "global",
      "operator": "x", "keys": ["Nonsense", "F5"]}],
    "recent_commands": [1, "a"], "command_counts": {"a": -3, "b": "many"}})",
      problem);
  CHECK(problem.empty());
  CHECK(odd.scale == 3);
  CHECK(odd.theme == "dark");
  CHECK(odd.tooltip_delay == Preferences{}.tooltip_delay);
  CHECK(odd.undo_limit_mb == 64);
  CHECK(odd.jobs_at_once == 8);
  CHECK(odd.keys.at({"global", "x"}) == std::vector<std::string>{"F5"});
  CHECK(odd.recent_commands == std::vector<std::string>{"a"});
  CHECK(odd.command_counts == std::map<std::string, int>{{"a", 0}});
}

TEST_CASE(
    "preferences: a file that is nested a million deep, wherever, is set aside and said, and the program's own are "
    "used") {
  std::string deep;
  for (int i = 0; i < 1'000'000; ++i) deep += '[';
  for (int i = 0; i < 1'000'000; ++i) deep += ']';
  const TemporaryFolder folder;
  for (const char* key : {"schema", "keys", "arrangements", "recent_commands", "interface"}) {
    CAPTURE(key);
    const std::string schema = key == std::string("schema") ? "" : R"("schema": "limber-preferences/1", )";
    write_file_atomically(folder / "preferences.json", "{" + schema + "\"" + key + "\": " + deep + "}");
    std::string problem;
    CHECK(read_preferences(folder / "preferences.json", problem) == Preferences{});
    CHECK(problem.find("preferences.json.damaged") != std::string::npos);
    CHECK_FALSE(std::filesystem::exists(folder / "preferences.json"));
    CHECK(std::filesystem::file_size(folder / "preferences.json.damaged") > 2'000'000);
  }
}

TEST_CASE("preferences: a changed key takes the place of the old one, and a clash is told of both") {
  KeyChanges changes;
  rebind(changes, small_keymap(), "select", "none", {chord("A")});
  const Keymap keymap = changed(small_keymap(), changes);
  CHECK(chords_of(keymap, "select", "none") == std::vector<Chord>{chord("A")});
  CHECK_FALSE(keymap.find(chord("Alt+A"), {"select"}));
  CHECK(*keymap.find(chord("A"), {"select"}) == "all");
  REQUIRE(clashes(keymap).size() == 1);
  CHECK(clashes(keymap)[0].operators == std::vector<std::string>{"all", "none"});
  CHECK(clashes(small_keymap()).empty());

  rebind(changes, small_keymap(), "select", "none", {chord("Alt+A")});  // the default key again, so no change remains
  CHECK(changes.empty());
}

TEST_CASE("preferences: they act at once, are kept, and the next start finds them") {
  const TemporaryFolder folder;
  const Path file = folder / "limber" / "preferences.json";
  {
    SmallEditor test({1280, 720});
    test.editor->preferences_state->path = file;
    test.play(R"(
      key Ctrl+,
      expect dialog yes
      click Interface/Light
      expect theme light
      click "Reduce motion"
      click dialog/View
      click "Scale bar"
      click "Soft shadows when idle"
      click "Refine the volume at rest"
      click "dialog/Undo and saving"
      double-click "Memory limit for undo"
      type "64"
      key Return
      click dialog/Keymap
      click dialog/search
      type "nothing"
      click "select/select.none/keys"
      expect "text:Press a key" shown
      key A
      expect "text:also Select all" shown
      expect "text:1 clash" shown
      key Escape
      expect dialog no
    )");
    CHECK_FALSE(test.editor->views->scale_bar);
    CHECK(test.editor->history->limit() == std::int64_t{64} << 20);
  }
  std::string problem;
  const Preferences kept = read_preferences(file, problem);
  CHECK(problem.empty());
  CHECK(kept.theme == "light");
  CHECK(kept.reduce_motion);
  CHECK_FALSE(kept.scale_bar);
  CHECK_FALSE(kept.fine_light);
  CHECK_FALSE(kept.refine_at_rest);
  CHECK(kept.undo_limit_mb == 64);
  CHECK(kept.keys.at({"select", "select.none"}) == std::vector<std::string>{"A"});

  SmallEditor next({1280, 720}, kept);
  CHECK(next.fact("theme") == "light");
  CHECK_FALSE(next.editor->views->scale_bar);
  CHECK(chords_of(next.editor->keymap, "select", "select.none") == std::vector<Chord>{chord("A")});
}

TEST_CASE("preferences: Escape gives up waiting for a key, Delete takes it away, Blender brings all back") {
  SmallEditor test({1280, 720});
  test.play(R"(
    key F3
    type "frame all"
    key Ctrl+K
    expect dialog yes
    click "view3d/view.frame_all/keys"
    key Escape
    expect dialog yes
    expect "text:Press a key" absent
    click "view3d/view.frame_all/keys"
    key Delete
    expect "text:no key" shown
    click dialog/Blender
    expect "text:no key" absent
  )");
  CHECK(test.editor->preferences->keys.empty());
}

TEST_CASE("preferences: Maya's keys have no clash, name only operators that exist, and act at once") {
  const Keymap maya = keymap_preset("maya");
  CHECK(clashes(maya).empty());
  SmallEditor test({1280, 720});
  for (const auto& [context, bindings] : maya.contexts)
    for (const Binding& binding : bindings) {
      INFO(context, ": ", binding.operator_id);
      CHECK((find_operator(test.editor->operators, binding.operator_id) ||
             keymap_preset("blender").chord_of(binding.operator_id)));
    }
  test.play(R"(
    click Edit/Preferences...
    click dialog/Keymap
    click dialog/Maya
    key Escape
    click Muscle/17/name
    move "3D view/view"
    key Ctrl+H
    expect hidden 1
    key Z
    expect hidden 0
  )");
  CHECK(test.editor->preferences->keymap == "maya");
}

TEST_CASE("preferences: keys are exported and imported as a file, a file that is no key map changes nothing") {
  const TemporaryFolder folder;
  SmallEditor test({1280, 720});
  test.editor->preferences->keys[{"select", "select.none"}] = {"A"};
  test.editor->preferences->keys[{"global", "edit.undo"}] = {"Ctrl+U"};
  const KeyChanges mine = test.editor->preferences->keys;
  keep_preferences(*test.editor);
  const std::string file = "type \"" + (folder / "keys.json").string() + "\"\nkey Return\n";
  test.play("click \"Edit/Change keys...\"\nclick dialog/Export...\n" + file +
            "expect error none\nclick \"Restore all\"");
  CHECK(test.editor->preferences->keys.empty());
  test.play("click dialog/Import...\nkey Escape\nexpect \"text:No key runs two commands\"\nclick dialog/Import...\n" +
            file + "expect error none\nexpect \"text:1 clash\"");
  CHECK(test.editor->preferences->keys == mine);
  std::ofstream(folder / "keys.json") << "{}";
  test.play("click dialog/Import...\n" + file + "expect error \"This is not a keymap\"\nkey Return\nkey Escape");
  CHECK(test.editor->preferences->keys == mine);
}

TEST_CASE("preferences: a folder that cannot be written is one warning, not an error") {
  SmallEditor test;
  test.editor->preferences_state->path = "/proc/limber/preferences.json";
  keep_preferences(*test.editor);
  keep_preferences(*test.editor);
  CHECK(test.editor->messages->toasts.size() == 1);
  CHECK(test.editor->messages->errors.empty());
}
