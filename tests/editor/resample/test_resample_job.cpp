// SPDX-License-Identifier: AGPL-3.0-or-later
// Resamples a volume to a posed one in the real editor, also with workers that fail.
#include <chrono>
#include <csignal>
#include <fstream>
#include <thread>

#include <unistd.h>

#include "core/resample/glide_joints.h"
#include "core/resample/posed_voxels.h"
#include "core/resample/resample.h"
#include "editor/context/operator.h"
#include "editor/context/resampling_settings.h"
#include "editor/context/screen.h"
#include "editor/files/export.h"
#include "editor/resample/results.h"
#include "editor/screen/job_progress.h"
#include "editor/screen/workflow_steps.h"
#include "tests/editor/small_limb.h"
#include "tests/support/program.h"

using namespace limber;
using namespace limber::editor;
using namespace limber::test;

namespace {

// Writes a shell script that stands in for the worker program.
Path script(const TemporaryFolder& folder, const std::string& text) {
  const Path path = folder / "worker";
  std::ofstream(path) << "#!/bin/sh\n" << text;
  std::filesystem::permissions(path, std::filesystem::perms::owner_all);
  return path;
}

// Returns the posed body that a job must make of the document. Like the job, first shifts bones that overlap at a joint
// by less than a voxel.
Posed resampled(const Document& document, const Method& method, const ResampleSettings& settings = {}) {
  const glm::dvec3 spacing = document.volume->grid.spacing;
  const GlidedPose glided = glide_joints(
      *document.volume, TissueVoxels(*document.volume), LabelSets(*document.tissues).bone, *document.weights,
      *document.armature, *document.pose, {.whole_mm = 0.99 * std::max({spacing.x, spacing.y, spacing.z})});
  return resample(*document.volume, *document.tissues, *document.armature, *document.weights, glided.pose, method,
                  settings);
}

void bend(LimbEditor& test) {
  test.play(R"(
    click Steps/Skin/Compute
    wait-job
    click Steps/Pose/Flex...
    double-click "Angle/value"
    type "30"
    key Return
    key Return
    expect edit "Flex Fore"
  )");
}

std::string next_step(const Context& editor) {
  for (const Step& step : steps(editor))
    if (step.state == StepState::Next) return step.title;
  return "none";
}

// Runs a failing job, checks that the document is unchanged, and returns the message.
std::string failure(LimbEditor& test) {
  const Document before = test.editor->document();
  run(*test.editor, "resample.run");
  test.play("wait-job");
  CHECK(test.editor->document() == before);
  REQUIRE_FALSE(test.editor->messages->toasts.empty());
  CHECK(test.editor->messages->toasts.back().severity == Severity::Error);
  return test.editor->messages->last_failure;
}

}  // namespace

TEST_CASE("resampling: what a report tells the command line to add, the editor tells where to find") {
  for (const std::string fit : {"the command limber fit-joint moves the axis of a joint",
                                "limber fit-joint, a command of its own, moves the axis of a joint"}) {
    const ResultFacts facts = facts_of_report(
        R"({"warnings": ["501 voxels are covered by two bones: Fore still overlaps Upper by 2.1 mm after a shif)"
        R"(t of 2.0 mm: --glide MM allows longer shifts; )" +
        fit + R"("]})");
    REQUIRE(facts.warnings.size() == 1);
    CHECK(
        facts.warnings[0] ==
        "501 voxels are covered by two bones: Fore still overlaps Upper by 2.1 mm after a shift of 2.0 mm: Keep bones "
        "apart allows longer shifts; Fit joint axis in the Rig workspace moves the axis of a joint");
  }
}

TEST_CASE("steps: the list names what is missing next, from nothing to a posed volume") {
  {
    SmallEditor empty({1280, 720}, {}, false);
    CHECK(next_step(*empty.editor) == "Prepare");
  }
  {
    SmallEditor body({1280, 720});
    CHECK(next_step(*body.editor) == "Rig");
  }

  LimbEditor test;
  CHECK(next_step(*test.editor) == "Skin");
  run(*test.editor, "skin.heat");
  test.play("wait-job");
  CHECK(next_step(*test.editor) == "Pose");
  bend(test);
  CHECK(next_step(*test.editor) == "Resample");
  test.play(R"(
    click Steps/Resample/Resample
    wait-job
  )");
  CHECK(next_step(*test.editor) == "none");
  CHECK(steps(*test.editor)[4].state == StepState::Done);
  CHECK(steps(*test.editor)[4].line == "Fore 30\u00b0, Mixed");
  run(*test.editor, "resample.lbs");
  run(*test.editor, "resample.run");
  test.play("wait-job");
  CHECK(steps(*test.editor)[4].line == "Fore 30\u00b0, LBS");  // the newest result
}

TEST_CASE("resample: the result is what the core computes, is undone, shown, and has its figures") {
  LimbEditor test;
  bend(test);
  test.play(R"(
    key Ctrl+4
    key Ctrl+Return
    wait-job
    expect "text:Fore 30" shown
    expect edit "Resample Fore 30°"
  )");
  const Document& document = test.editor->document();
  REQUIRE(document.results.size() == 1);
  const Result& result = *document.results[0];
  CHECK(result.name == "Fore 30\u00b0, Mixed");
  const Posed expected = resampled(document, Blend::Mixed);
  CHECK(result.volume->grid == expected.volume.grid);
  CHECK(result.volume->voxels == expected.volume.voxels);
  const auto facts = facts_of(*test.editor, document.results[0]);
  CHECK(facts->tissues.size() == 4);
  CHECK(facts->change_percent);
  CHECK(facts->seconds > 0);
  // The result has the voxels that `limber resample --overlap` marks.
  const auto marked = resampled(document, Blend::Mixed, {.overlap = true}).overlap;
  REQUIRE(result.overlap);
  CHECK(std::ssize(result.overlap->tissue) == std::count(marked.begin(), marked.end(), 1));
  CHECK(std::ssize(result.overlap->bones) == std::count(marked.begin(), marked.end(), 2));
  CHECK(facts->overlap_voxels >= std::ssize(result.overlap->tissue));

  // The result replaces the volume in the view while it is selected.
  test.play("click \"Fore 30\u00b0, Mixed/row\"");
  CHECK(test.editor->views->scene.volume == result.volume);
  test.play("click \"At rest/row\"");
  CHECK(test.editor->views->scene.volume == document.volume);

  run(*test.editor, "resample.lbs");
  run(*test.editor, "resample.run");
  test.play("wait-job");
  CHECK(test.editor->document().results.size() == 2);
  run(*test.editor, "edit.undo");
  CHECK(test.editor->document().results.size() == 1);

  // A mass-exact result, too, has the voxels that core computes. Its name and its list of settings say "mass-exact".
  run(*test.editor, "resample.dqs");
  test.play("key Ctrl+4\n click Resample/Mass-exact\n key Ctrl+Return\n wait-job");
  REQUIRE(test.editor->document().results.size() == 2);
  const Document now = test.editor->document();
  const auto exact = now.results[1];
  CHECK(exact->name == "Fore 30\u00b0, DQ, mass-exact");
  CHECK(exact->volume->voxels == resampled(now, Blend::DualQuaternion, {.mass_exact = true}).volume.voxels);
  const auto& settings = facts_of(*test.editor, exact)->settings;
  CHECK(std::any_of(settings.begin(), settings.end(),
                    [](const auto& line) { return line.name == "Mass exact" && line.value == "yes"; }));

  // All results go into one page, made by the writer of study reports.
  const TemporaryFolder folder;
  export_report(*test.editor, exact, folder / "both.html");
  test.play("wait-job");
  const std::string page = read_file(folder / "both.html");
  for (const char* part :
       {"Limber results", "2 results: 1 pose, 2 techniques", "Fore 30\u00b0", "Dual quaternions, mass-exact",
        "data:image/png;base64,", "elapsed time", "Joint limits", "covered by two bones"}) {
    INFO(std::string(part));
    CHECK(page.find(part) != std::string::npos);
  }
  for (const char* part : {"CPU s", "cells.csv", "limber job", "no pictures"}) {
    INFO(std::string(part));
    CHECK(page.find(part) == std::string::npos);
  }

  // The file's name decides whether a volume, surfaces or a simulation's input is written, as on the command line.
  for (const char* name : {"posed.mha", "posed.obj", "posed.dat"}) export_result(*test.editor, exact, folder / name);
  test.play("wait-job");
  CHECK(read_volume(folder / "posed.mha").volume.voxels == exact->volume->voxels);
  CHECK(read_file(folder / "posed.obj").find("\nf ") != std::string::npos);
  CHECK(std::filesystem::exists(folder / "posed_organs.dat"));
  export_result(*test.editor, exact, folder / "posed.xml");
  test.play(
      "wait-idle\n expect \"text:Frequency\"\n double-click Frequency/value\n type 450\n key Return\n key Return\n "
      "wait-job");
  const std::string xml = read_file(folder / "posed.xml");
  CHECK(xml.find("450000000") != std::string::npos);
  CHECK(xml.find("<Box") != std::string::npos);
  // A result of blending has no mesh to write.
  CHECK_THROWS_AS(export_result(*test.editor, exact, folder / "posed.node"), Error);
  CHECK(std::distance(std::filesystem::directory_iterator(folder.path()), {}) == 7);
}

TEST_CASE("resample: a result becomes stale when what it was made from changes, and says why") {
  LimbEditor test;
  bend(test);
  run(*test.editor, "resample.run");
  test.play("wait-job");
  const auto result = test.editor->document().results.at(0);
  CHECK(stale_reason(test.editor->document(), *result).empty());
  run(*test.editor, "pose.clear");
  // A result has its own pose, so clearing the pose does not make the result stale.
  CHECK(stale_reason(test.editor->document(), *result).empty());
  run(*test.editor, "edit.undo");
  run(*test.editor, "skin.geodesic");
  test.play("wait-job");
  CHECK(stale_reason(test.editor->document(), *result) == "weights changed");
  CHECK(steps(*test.editor)[4].state == StepState::Warning);
  test.play(R"(
    key Ctrl+4
    expect "text:stale: weights" shown
  )");
  run(*test.editor, "edit.undo");
  CHECK(stale_reason(test.editor->document(), *result).empty());
  run(*test.editor, "prepare.crop");
  test.play("wait-job");
  CHECK(stale_reason(test.editor->document(), *result) == "volume changed");
  run(*test.editor, "result.delete_stale");
  CHECK(test.editor->document().results.empty());
}

TEST_CASE("resample: a worker that crashes, fails, hangs or eats memory is a message, and the document stays") {
  const TemporaryFolder folder;
  Preferences preferences;
  preferences.worker_minutes = 0.01;
  LimbEditor test({1280, 720}, preferences);
  bend(test);
  test.editor->background->worker_program = script(folder, "kill -SEGV $$\n");
  CHECK(failure(test).find("crashed") != std::string::npos);
  test.editor->background->worker_program = script(folder, "echo 'limber: no room: rig.json: free some' >&2; exit 1\n");
  CHECK(failure(test) == "no room: rig.json: free some");
  test.editor->background->worker_program = script(folder, "sleep 100\n");
  CHECK(failure(test).find("took longer") != std::string::npos);
  test.editor->background->worker_program = "/no/such/program";
  CHECK(failure(test).find("cannot be started") != std::string::npos);
  test.editor->background->worker_program = script(folder, "exit 0\n");  // the worker succeeds, but writes nothing
  CHECK_FALSE(failure(test).empty());

  // The message can be opened again, and the editor goes on.
  test.play(R"(
    click "toast 0/Details"
    expect error "There is no such file"
    key Escape
    expect error none
    key Alt+Z
    expect display xray
  )");
}

TEST_CASE("resample: a limit of memory ends the real worker, with a message") {
  Preferences preferences;
  preferences.worker_memory_mb = 16;
  LimbEditor test({1280, 720}, preferences);
  bend(test);
  CHECK_FALSE(failure(test).empty());
}

TEST_CASE("resample: a worker killed from outside is a message") {
  const TemporaryFolder folder;
  LimbEditor test;
  bend(test);
  const Path pid = folder / "pid";
  test.editor->background->worker_program = script(folder, "echo $$ > " + pid.string() + "\nsleep 100\n");
  run(*test.editor, "resample.run");
  const auto killed = [&] {
    std::ifstream in(pid);
    pid_t id = 0;
    return in >> id && ::kill(id, SIGKILL) == 0;
  };
  while (!killed()) {
    test.player.step();
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  test.play("wait-job");
  CHECK(test.editor->messages->last_failure.find("ended by the system") != std::string::npos);
  CHECK(test.editor->document().results.empty());
}

TEST_CASE("jobs: the slot in the status bar opens the list, Cancel stops at once, and nothing moves") {
  const TemporaryFolder folder;
  LimbEditor test;
  bend(test);
  const Rect views = test.editor->screen->layout.views;
  test.editor->background->worker_program =
      script(folder, "echo '{\"stage\": \"deform\", \"fraction\": 0.5}' >&2\nsleep 100\n");
  run(*test.editor, "resample.run");
  for (int i = 0; i < 400 && test.fact("text:deform") == "absent"; ++i) {
    test.player.step();
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  CHECK(test.fact("text:deform") == "shown");
  CHECK(test.editor->screen->layout.views == views);
  test.play(R"(
    click status/Running
    expect "text:50 %" shown
    click Cancel
    wait-job
    expect jobs no
    expect widget:status/Running absent
  )");
  CHECK(test.editor->screen->layout.views == views);
  CHECK(test.editor->document().results.empty());
  CHECK(test.editor->messages->errors.empty());
}

TEST_CASE("jobs: time left is rounded") {
  CHECK(time_left_text(3) == "a few seconds");
  CHECK(time_left_text(31) == "about 35 s");
  CHECK(time_left_text(70) == "about 1 min");
  CHECK(time_left_text(170) == "about 3 min");
  CHECK(time_left_text(7300) == "about 2 h");
}

TEST_CASE("console: messages are filtered by kind and words, and copied") {
  SmallEditor test({1280, 720});
  test.editor->messages->info("First note");
  test.editor->messages->warn("A warning", "with a detail");
  test.editor->messages->show_error("it broke: here: mend it");
  test.play(R"(
    key Escape
    click Help/Console
    expect console yes
    click bottom/Notes
    click "Copy console"
  )");
  CHECK(test.host->clipboard() == "A warning: with a detail\nit broke: here: mend it\n");
  test.play(R"(
    click bottom/search
    type "DETAIL"
    click "Copy console"
  )");
  CHECK(test.host->clipboard() == "A warning: with a detail\n");
}

TEST_CASE("help: pages of keys, licences and system facts") {
  SmallEditor test({1280, 720});
  test.play(R"(
    click Help/Keys
    expect "text:Search commands" shown
    click dialog/search
    type "console"
    key Escape
    click "Help/About and licences"
    expect "text:GNU Affero" shown
    click help.system_facts
    key Escape
    expect dialog no
  )");
  CHECK(test.host->clipboard().find("OpenGL") != std::string::npos);
}

TEST_CASE("resample: finite elements run in the worker as the panel says, and the result says how it was made") {
  LimbEditor test;
  bend(test);
  test.play(R"(
    key Ctrl+4
    click resample.fem
    click Quality/list
    click Fine
  )");
  CHECK(test.editor->resampling->quality == "fine");
  CHECK(test.editor->resampling->contact);
  test.play("click Contact");
  CHECK_FALSE(test.editor->resampling->contact);
  run(*test.editor, "resample.run");
  test.play("wait-job");
  INFO(test.editor->messages->last_failure);
  const Document& document = test.editor->document();
  REQUIRE(document.results.size() == 1);
  CHECK(document.results[0]->name == "Fore 30\u00b0, FEM");
  CHECK(document.results[0]->method == "fem");
  CHECK(document.results[0]->report.find("\"solve\"") != std::string::npos);
  const auto facts = facts_of(*test.editor, document.results[0]);
  REQUIRE(facts->change_percent);
  CHECK(std::abs(*facts->change_percent) < 2);
  CHECK(stale_reason(document, *document.results[0]).empty());
  test.play("click Contact");
  run(*test.editor, "resample.run");
  test.play("wait-job");
  REQUIRE(test.editor->document().results.size() == 2);
  CHECK(test.editor->document().results[1]->name == "Fore 30\u00b0, FEM with contact");
}
