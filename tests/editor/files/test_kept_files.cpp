// SPDX-License-Identifier: AGPL-3.0-or-later
// Files that version 0.1.0 wrote (tests/kept) are still read in full: a project, settings, keys, a recording, a job, a
// report and the operators' ids. They are never rewritten; files of later versions are added beside them.
#include <algorithm>
#include <fstream>
#include <sstream>

#include <nlohmann/json.hpp>

#include "core/base/file.h"
#include "editor/context/keep_preferences.h"
#include "editor/context/operator.h"
#include "tests/editor/sitting.h"

using namespace limber;
using namespace limber::editor;
using namespace limber::test;

namespace {

using Json = nlohmann::json;

Path kept(const std::string& name) { return Path(LIMBER_SOURCE_DIR) / "tests/kept" / name; }

// Adds the keys of `before` that `after` lacks, or whose value has another type. Lists are compared by their first
// entry.
void add_lost_keys(const Json& before, const Json& after, const std::string& place, std::vector<std::string>& lost) {
  const auto kind = [](const Json& json) { return json.is_number() ? "number" : json.type_name(); };
  if (std::string(kind(before)) != kind(after)) return lost.push_back(place);
  if (before.is_array() && !before.empty() && !after.empty()) add_lost_keys(before[0], after[0], place + "[0]", lost);
  if (!before.is_object()) return;
  for (const auto& [key, value] : before.items()) {
    if (after.contains(key)) add_lost_keys(value, after[key], place + "/" + key, lost);
    else lost.push_back(place + "/" + key);
  }
}

}  // namespace

TEST_CASE("kept: a project of version 0.1.0 opens with all that it holds, and as it was looked at") {
  const Home home;
  std::filesystem::copy_file(kept("arm.limber"), home / "arm.limber");
  Sitting sitting(home.folder.path(), {home / "arm.limber"});
  sitting.play("wait-job\n expect unsaved no\n expect layout four\n expect display xray\n expect workspace resample");
  const Document& document = sitting.editor().document();
  REQUIRE(document.volume);
  CHECK(document.volume->grid.size == glm::ivec3(22, 42, 99));
  CHECK(std::count_if(document.volume->voxels.begin(), document.volume->voxels.end(),
                      [](Label label) { return label != 0; }) == 6877);
  CHECK(document.tissues->tissues.size() == 20);
  REQUIRE(document.armature);
  CHECK(document.armature->bones.size() == 22);
  REQUIRE(document.weights);
  CHECK(document.weights->bones().size() == 22);
  REQUIRE(document.pose);
  const int forearm = static_cast<int>(require_bone(*document.armature, "Forearm"));
  CHECK(glm::degrees(2 * std::acos(std::abs(document.pose->rotation[forearm].w))) == doctest::Approx(60).epsilon(1e-3));
  REQUIRE(document.results.size() == 1);
  CHECK(document.results[0]->method == "dqs");
  CHECK(Json::parse(document.results[0]->report)["schema"] == "limber-report/1");
}

TEST_CASE("kept: preferences, recent files and keys of version 0.1.0 act as they did") {
  std::string problem;
  const Preferences preferences = preferences_from_json(read_file(kept("preferences.json")), problem);
  CHECK(problem.empty());
  CHECK(preferences.theme == "light");
  CHECK(preferences.scale == 1.25);
  CHECK(preferences.keymap == "maya");
  CHECK(preferences.undo_limit_mb == 512);
  CHECK(preferences.worker_minutes == 30);
  CHECK(preferences.display == "tissue");
  CHECK(preferences.keys.at({"global", "edit.undo"}) == std::vector<std::string>{"Ctrl+U"});
  CHECK(preferences.command_counts.at("view.four") == 3);

  const TemporaryFolder folder;
  std::filesystem::copy_file(kept("remembered.json"), folder / "remembered.json");
  const RecentFiles recent = read_recent_files(folder / "remembered.json", problem);
  CHECK(problem.empty());
  REQUIRE_FALSE(recent.recents.empty());
  CHECK(recent.recents[0].path.filename() == "arm.limber");

  SmallEditor test({1280, 720});
  import_keymap(*test.editor, kept("keys.json"));
  CHECK(test.editor->preferences->keys == KeyChanges{{{"global", "edit.undo"}, {"Ctrl+U"}}});
  test.play("click Muscle/17/eye\n expect hidden 1\n key Ctrl+U\n expect hidden 0");
}

TEST_CASE("kept: an exported key map says which commands have no keys, and brings that back") {
  const TemporaryFolder folder;
  SmallEditor test({1024, 640}, {}, false);
  const KeyChanges none = {{{"global", "edit.undo"}, {}}, {{"slice", "image.drag_window"}, {}}};
  test.editor->preferences->keys = none;
  apply_preferences(*test.editor);
  export_keymap(*test.editor, folder / "mine.json");
  test.editor->preferences->keys.clear();
  apply_preferences(*test.editor);
  import_keymap(*test.editor, folder / "mine.json");
  CHECK(test.editor->preferences->keys == none);
}

TEST_CASE("kept: operators have the ids that key maps and recordings of version 0.1.0 name") {
  SmallEditor test({1024, 640}, {}, false);
  std::istringstream ids(read_file(kept("operators.txt")));
  int count = 0;
  for (std::string id; std::getline(ids, id); ++count) {
    CAPTURE(id);
    CHECK(find_operator(test.editor->operators, id) != nullptr);
  }
  CHECK(count > 350);
}

TEST_CASE("kept: a recording of version 0.1.0 plays to its end") {
  const Home home;
  REQUIRE(run_limber({"phantom", "arm", "--spacing", "8", "-o", (home / "arm").string()}).exit_code == 0);
  const ProgramRun created =
      run_limber({"project", (home / "arm.limber").string(), "create", (home / "arm/volume.nrrd").string(), "--tissues",
                  (home / "arm/tissues.json").string(), "--rig", (home / "arm/rig.json").string()});
  REQUIRE(created.exit_code == 0);
  Sitting sitting(home.folder.path(), {home / "arm.limber"});
  sitting.editor().background->worker_program = LIMBER_PROGRAM;
  sitting.play(read_file(kept("recording.txt")));
  CHECK(sitting.editor().document().results.size() == 1);
  CHECK(sitting.editor().document().results[0]->method == "dqs");
}

TEST_CASE("kept: a job of version 0.1.0 runs, and its report has every key that it had") {
  const TemporaryFolder folder;
  for (const char* name : {"prepare-job.json", "weights-job.json", "job.json"})
    std::filesystem::copy_file(kept(name), folder / name);
  for (const char* name : {"prepare-job.json", "weights-job.json", "job.json"}) {
    const ProgramRun run = run_limber({"job", (folder / name).string()});
    INFO(name, ": ", run.err);
    REQUIRE(run.exit_code == 0);
  }
  std::vector<std::string> lost;
  add_lost_keys(Json::parse(read_file(kept("report.json"))), Json::parse(read_file(folder / "report.json")), "", lost);
  // These keys exist only if skin comes near other skin, which depends on the mesh.
  for (const char* key : {"/mesh/contact_nodes", "/mesh/min_gap_mm", "/mesh/median_gap_mm"}) std::erase(lost, key);
  for (const std::string& key : lost) FAIL_CHECK("the report lost ", key);
}
