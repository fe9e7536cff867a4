// SPDX-License-Identifier: AGPL-3.0-or-later
// Tests finite elements in the worker: the view shows the steps of the solve, the user can go on working, and however
// the worker ends, the document is unchanged.
#include <chrono>
#include <csignal>
#include <fstream>
#include <thread>

#include <unistd.h>

#include <nlohmann/json.hpp>

#include "core/project/project_io.h"
#include "editor/context/comparison.h"
#include "editor/context/operator.h"
#include "editor/context/resampling_settings.h"
#include "editor/files/project_session.h"
#include "editor/pose/live_preview.h"
#include "editor/resample/fem_overlay.h"
#include "editor/resample/results.h"
#include "editor/shown/fem_live_view.h"
#include "tests/editor/paint_editor.h"
#include "tests/support/kuhn_mesh.h"
#include "tests/support/sanitizer.h"

using namespace limber;
using namespace limber::editor;
using namespace limber::test;

namespace {

using Clock = std::chrono::steady_clock;

// The limb with weights and a pose, with a script in place of the worker.
struct SolveEditor : PaintEditor {
  TemporaryFolder folder;

  explicit SolveEditor(double degrees = 30) {
    Document next = editor->document();
    Pose pose = rest_pose(*next.armature);
    flex(pose, *next.armature, 1, degrees);
    next.pose = std::make_shared<const Pose>(pose);
    editor->history->reset(next, "Open posed limb");
    editor->resampling->method = "fem";
    // With larger tets, all of such a small bone would count as joint, and no bone would be held.
    editor->resampling->quality = "normal";
    editor->resampling->contact = false;
    play("key Ctrl+4\nwait-idle");
  }
  void set_worker(const std::string& text) {
    const Path path = folder / "worker";
    std::ofstream(path) << "#!/bin/sh\n" << text;
    std::filesystem::permissions(path, std::filesystem::perms::owner_all);
    editor->background->worker_program = path;
  }
  // Sets a worker that reports a step in which the mesh and both bones are turned by `turn`, and then goes on running.
  void set_worker_at(const RigidTransform& turn) {
    const Grid& grid = editor->document().volume->grid;
    FemMesh mesh{kuhn_mesh(grid, glm::dvec3(-1), glm::dvec3(grid.size), {6, 6, 8}), {}, {}};
    mesh.material.resize(mesh.tets.T.rows());
    mesh.joint.resize(mesh.tets.T.rows());
    FemStep step{0.5, 3, 0.8, {turn, turn}, mesh.tets.V};
    for (Eigen::Index v = 0; v < step.V.rows(); ++v) {
      const glm::dvec3 p = turn * glm::dvec3(step.V(v, 0), step.V(v, 1), step.V(v, 2));
      step.V.row(v) << p.x, p.y, p.z;
    }
    write_fem_mesh(mesh, folder / "turned");
    write_fem_step(step, folder / "turned");
    const std::string pid = folder / "pid", turned = folder / "turned";
    set_worker("echo $$ > " + pid + "\ncp " + turned + ".mesh \"$(dirname \"$2\")/solve.mesh\"\ncp " + turned +
               ".step" + " \"$(dirname \"$2\")/solve.step\"\n" +
               R"(echo '{"stage":"solving","fraction":0.5,"angle_degrees":15,)"
               R"("iteration":3,"residual_mm":0.8,"seconds_left":100}' >&2)" +
               "\nexec sleep 100\n");
  }
  template <class Reached>
  bool step_until(const Reached& reached, double seconds = 120) {
    for (const auto start = Clock::now(); !reached();) {
      if (Clock::now() - start > std::chrono::duration<double>(seconds)) return false;
      player.step();
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    return true;
  }
  bool settles() const { return fact("posed") != "no" && watched_solve(*editor); }
  bool has_result() const { return !editor->document().results.empty(); }
  pid_t worker() const {
    std::ifstream in(folder / "pid");
    pid_t id = 0;
    in >> id;
    return id;
  }
};

}  // namespace

TEST_CASE(
    "settling: while finite elements are solved the Resample workspace shows the tissue where the mesh carries it, and "
    "how far the solve is") {
  SolveEditor test;
  const RigidTransform turn{glm::angleAxis(0.4, glm::dvec3(1, 0, 0)), {3, -2, 5}};
  test.set_worker_at(turn);
  const Document before = test.editor->document();
  test.play("key Ctrl+Return");
  REQUIRE(test.step_until([&] { return test.settles(); }));
  const Grid& grid = before.volume->grid;
  const AffineTransform world = world_from_voxel(grid), voxel = voxel_from_world(grid);
  const auto& scene = test.editor->views->scene;
  CHECK(scene.volume == before.volume);
  for (const glm::dvec3& rest : {glm::dvec3(12, 10, 14), glm::dvec3(8, 11, 20), glm::dvec3(15, 8, 6)}) {
    const auto back = scene.pose->rest_at(voxel * (turn * (world * rest)));
    REQUIRE(back);
    CHECK(glm::distance(*back, rest) < 0.1);
  }
  REQUIRE(scene.posed_from_rest.size() == 2);
  CHECK(glm::distance(scene.posed_from_rest[1] * glm::dvec3(1, 2, 3), turn * glm::dvec3(1, 2, 3)) < 1e-9);
  CHECK(test.fact("text:15.0 of 30.0\u00b0, iteration 3, nodes move up to 0.80 mm") == "shown");
  CHECK(test.fact("text:solving") == "shown");
  test.play("key N\nwait 4");  // opens the sidebar; the remaining time appears after some seconds
  std::this_thread::sleep_for(std::chrono::milliseconds(3100));
  test.player.step();
  CHECK(test.fact("text:about 2 min left") == "shown");

  // Other workspaces work as usual. When the Resample workspace is shown again, it shows the solve again, until another
  // result is selected.
  test.play("key Ctrl+3");
  CHECK_FALSE(watched_solve(*test.editor));
  REQUIRE(test.step_until([&] { return test.fact("posed") != "no" && !test.editor->live->busy(); }));
  const glm::dvec3 still(12, 10, 22);  // above the joint, so that only the solve moves it
  CHECK(glm::distance(*scene.pose->rest_at(still), still) < 0.1);
  test.play("key Ctrl+4");
  REQUIRE(test.step_until([&] { return test.settles(); }));
  run(*test.editor, "result.watch");
  test.player.settle();
  CHECK(test.fact("posed") == "no");
  run(*test.editor, "result.watch");
  REQUIRE(test.step_until([&] { return test.settles(); }));

  // A cancel ends the solve and its worker at once.
  const auto asked = Clock::now();
  test.editor->jobs->cancel(test.editor->fem->watched);
  REQUIRE(test.step_until([&] { return !test.editor->jobs->busy(); }));
  const double milliseconds = std::chrono::duration<double, std::milli>(Clock::now() - asked).count();
  MESSAGE("from a cancel to its end: " << milliseconds << " ms");
  CHECK(::kill(test.worker(), 0) != 0);
  test.player.settle();
  CHECK(test.fact("posed") == "no");
  CHECK(test.editor->document() == before);
  CHECK(test.editor->fem->solves.empty());
}

TEST_CASE(
    "settling: during a solve the pose is changed, weights are painted, edits undone and the project saved, then the "
    "result comes beside all that") {
  SolveEditor test;
  const Path go = test.folder / "go", project = test.folder / "limb.limber";
  // The script starts the program without --parent, because the program is the script's child and not the editor's.
  test.set_worker(std::string(LIMBER_PROGRAM) + " job \"$2\" --progress json\nend=$?\nwhile [ ! -e " + go.string() +
                  " ]; do sleep 0.02; done\nexit $end\n");
  save_project_as(*test.editor, project);
  test.play("wait-job");
  const auto first_save = std::filesystem::last_write_time(project);
  const Document begun = test.editor->document();
  test.play("key Ctrl+Return");
  REQUIRE(test.step_until([&] { return test.settles(); }));
  CHECK(test.editor->views->scene.pose->step == 4);

  test.play("key Ctrl+3\nmove \"3D view/view\"\nkey R\nkey X\nkey 2\nkey 0\nkey Return");
  CHECK(test.editor->document().pose != begun.pose);
  const auto posed = test.editor->document().pose;
  test.play("key Ctrl+2");
  test.player.settle();
  test.stroke(test.at(0, 20), test.at(0, 20));
  CHECK(test.editor->document().weights != begun.weights);
  CHECK(test.last_edit() == "Add Fore");
  test.play("key Ctrl+Z");
  CHECK(test.editor->document().weights == begun.weights);
  CHECK(test.editor->document().pose == posed);
  test.play("key Ctrl+S");
  REQUIRE(test.step_until([&] { return !test.editor->history->unsaved(); }));
  CHECK(std::filesystem::last_write_time(project) > first_save);
  CHECK(*read_project(project).document.pose == *posed);
  CHECK_FALSE(test.has_result());
  CHECK(test.editor->jobs->busy());

  std::ofstream(go) << "go";
  test.play("wait-job");
  REQUIRE(test.has_result());
  const Document& now = test.editor->document();
  CHECK(now.pose == posed);
  CHECK(now.weights == begun.weights);
  const auto result = now.results[0];
  CHECK(result->from_pose == begun.pose);
  CHECK(result->name == "Fore 30\u00b0, FEM");
  REQUIRE(result->solved);
  CHECK(result->solved->V.rows() == result->solved->mesh.tets.V.rows());
  CHECK((result->solved->V - result->solved->mesh.tets.V).rowwise().norm().maxCoeff() > 5);
  test.play("key Ctrl+Z");
  CHECK_FALSE(test.has_result());
  CHECK(test.editor->document().pose == posed);
}

TEST_CASE("settling: a result that was watched to its end is what the views then show, one that was not is not") {
  for (const bool watched : {true, false}) {
    SolveEditor test;
    test.editor->background->worker_program = LIMBER_PROGRAM;
    test.play("key Ctrl+Return");
    if (!watched) run(*test.editor, "result.watch");
    test.play("wait-job");
    REQUIRE(test.has_result());
    CHECK((shown_result(*test.editor) == test.editor->document().results[0]) == watched);
  }
}

TEST_CASE(
    "settling: a result by finite elements becomes stale when weights change, or how stiff tissue is, another one does "
    "not mind stiffness") {
  SolveEditor test;
  test.editor->background->worker_program = LIMBER_PROGRAM;
  test.play("key Ctrl+Return\nwait-job");
  test.editor->resampling->method = "dqs";
  test.play("key Ctrl+Return\nwait-job");
  REQUIRE(test.editor->document().results.size() == 2);
  const auto stale = [&](int i) { return stale_reason(test.editor->document(), *test.editor->document().results[i]); };
  CHECK(stale(0).empty());
  CHECK(stale(1).empty());
  Document next = test.editor->document();
  auto tissues = std::make_shared<TissueTable>(*next.tissues);
  tissues->tissues[0].young_modulus *= 2;
  next.tissues = tissues;
  commit(*test.editor, "Stiffness", next);
  CHECK(stale(0) == "tissues changed");
  CHECK(stale(1).empty());
  run(*test.editor, "edit.undo");
  CHECK(stale(0).empty());
  show_result(*test.editor, "");  // painting needs the volume at rest
  test.play("key Ctrl+2");
  test.player.settle();
  test.stroke(test.at(0, 20), test.at(0, 20));
  CHECK(stale(0) == "weights changed");
  CHECK(stale(1) == "weights changed");
}

TEST_CASE(
    "settling: a worker that is killed amid its solve is one line, and the document and the views are as they were") {
  SolveEditor test(60);
  const Path pid = test.folder / "pid";
  test.editor->resampling->contact = true;
  test.set_worker("echo $$ > " + pid.string() + "\nexec " + LIMBER_PROGRAM + " \"$@\"\n");
  const Document before = test.editor->document();
  test.play("key Ctrl+Return");
  REQUIRE(test.step_until([&] {
    return !test.editor->fem->solves.empty() &&
           test.editor->fem->solves.begin()->second.feed->seen().progress.iteration;
  }));
  REQUIRE(::kill(test.worker(), SIGKILL) == 0);
  test.play("wait-job");
  CHECK(test.editor->messages->last_failure.find("ended by the system") != std::string::npos);
  CHECK(test.editor->messages->last_failure.find('\n') == std::string::npos);
  CHECK(test.editor->document() == before);
  CHECK(test.fact("posed") == "no");
  CHECK(test.editor->fem->solves.empty());
}

#ifndef LIMBER_ADDRESS_SANITIZER
TEST_CASE("settling: a solve that may not take the memory it needs ends with a line that says so") {
  SolveEditor test(60);
  test.editor->background->worker_program = LIMBER_PROGRAM;
  const Document before = test.editor->document();
  int failures = 0;
  // With the first limits, memory runs out when the worker starts, reads, meshes or solves. The last one is enough.
  for (const int megabytes : {16, 60, 75, 90, 105, 120, 160}) {
    test.editor->preferences->worker_memory_mb = megabytes;
    test.editor->messages->last_failure.clear();
    test.play("key Ctrl+Return\nwait-job");
    if (test.has_result()) {
      run(*test.editor, "edit.undo");
      continue;
    }
    INFO(megabytes, " MB: ", test.editor->messages->last_failure);
    ++failures;
    CHECK(test.editor->messages->last_failure.find("memory") != std::string::npos);
    CHECK(test.editor->messages->last_failure.find('\n') == std::string::npos);
  }
  CHECK(failures >= 2);
  CHECK(test.editor->document() == before);
}
#endif

TEST_CASE("settling: several solves queue, others wait for none of them, and each comes to its own result") {
  SolveEditor test;
  test.editor->background->worker_program = LIMBER_PROGRAM;
  const Path go = test.folder / "go";
  const std::string real(LIMBER_PROGRAM);
  test.set_worker("case \"$(cat \"$2\")\" in *fem*) while [ ! -e " + go.string() +
                  " ]; do sleep 0.02; done;; esac\nexec " + real + " \"$@\"\n");
  test.play("key Ctrl+Return\nkey Ctrl+Return\nkey Ctrl+Return");
  int running = 0, queued = 0;
  for (const JobStatus& job : test.editor->jobs->statuses())
    running += job.state == JobState::Running, queued += job.state == JobState::Queued;
  CHECK(running == 1);
  CHECK(queued == 2);
  CHECK(test.editor->fem->solves.size() == 3);
  test.editor->resampling->method = "lbs";
  test.play("key Ctrl+Return");
  REQUIRE(test.step_until([&] { return test.has_result(); }));
  CHECK(test.editor->document().results[0]->method == "lbs");
  std::ofstream(go) << "go";
  test.play("wait-job");
  const auto& results = test.editor->document().results;
  REQUIRE(results.size() == 4);
  CHECK(results[3]->name == "Fore 30\u00b0, FEM (3)");
  for (int i : {2, 3}) CHECK(results[i]->volume->voxels == results[1]->volume->voxels);
}

TEST_CASE(
    "settling: measures of the mesh and its tets are shown while it settles, of the result, and on its side of a "
    "comparison") {
  SolveEditor test;
  test.set_worker_at({glm::angleAxis(0.6, glm::normalize(glm::dvec3(1, 2, 3))), glm::dvec3(8, -6, 12)});
  const render::Scene& scene = test.editor->views->scene;
  run(*test.editor, "fem.show_volume_ratio");  // does nothing but show a message
  CHECK_FALSE(test.editor->fem_overlay->measure);
  test.play("key Ctrl+Return");
  REQUIRE(test.step_until([&] { return test.settles(); }));
  run(*test.editor, "fem.show_volume_ratio");
  run(*test.editor, "fem.tets");
  REQUIRE(test.step_until([&] { return scene.weights && scene.weights->field && scene.mesh; }));
  const MeasuredMesh* shown = shown_measure(*test.editor);
  REQUIRE(shown);
  // The worker's mesh is only turned, so its volume ratio is 1.
  CHECK(shown->least == doctest::Approx(1).epsilon(1e-3));
  CHECK(shown->most == doctest::Approx(1).epsilon(1e-3));
  CHECK(scene.mesh->V == watched_solve(*test.editor)->feed->seen().mesh.posed);
  CHECK(measure_text_at(*test.editor, {12, 10, 14}) == "det F 1.00");
  CHECK(test.fact("text:Volume ratio, det F") == "shown");
  test.editor->jobs->cancel(test.editor->fem->watched);
  REQUIRE(test.step_until([&] { return !test.editor->jobs->busy(); }));
  test.player.settle();
  CHECK_FALSE(scene.weights);
  CHECK_FALSE(scene.mesh);

  // Gives each half its own bone: with the one bone between them, the ball would turn as a whole.
  Document two_bones = test.editor->document();
  auto volume = std::make_shared<LabelVolume>(*two_bones.volume);
  const AffineTransform world = world_from_voxel(volume->grid);
  for (std::int64_t at = 0; at < volume->grid.voxel_count(); ++at) {
    const int x = int(at % volume->grid.size.x), y = int(at / volume->grid.size.x % volume->grid.size.y),
              z = int(at / (std::int64_t{volume->grid.size.x} * volume->grid.size.y));
    const glm::dvec3 p = world * glm::dvec3(x, y, z);
    if (volume->voxels[at] == 111) volume->voxels[at] = 17;
    if (glm::length(glm::dvec3(p.x, p.y, std::abs(p.z) - 20)) < 10) volume->voxels[at] = 111;
  }
  two_bones.volume = volume;
  test.editor->history->reset(two_bones, "Open limb with two bones");
  test.editor->background->worker_program = LIMBER_PROGRAM;
  test.play("key Ctrl+Return\nwait-job\nwait-idle");
  REQUIRE(test.has_result());
  const auto result = test.editor->document().results[0];
  REQUIRE(scene.weights);
  CHECK(scene.volume == result->volume);
  CHECK(scene.mesh->V.get() == &result->solved->V);
  shown = shown_measure(*test.editor);
  REQUIRE(shown);
  CHECK(shown->least < 0.98);
  CHECK(shown->most > 1.01);
  // The shown volume ratio equals that of the result's report.
  const auto json = nlohmann::json::parse(result->report);
  CHECK(shown->least == doctest::Approx(json["mesh"]["min_det_f"].get<double>()).epsilon(1e-3));
  run(*test.editor, "fem.show_energy");
  test.play("wait-idle");
  CHECK(shown_measure(*test.editor)->measure == FemMeasure::EnergyDensity);
  CHECK(shown_measure(*test.editor)->most > 0);

  // Shows the result on the left of a wipe and the volume at rest on the right, then the other way round.
  test.editor->comparison->a = result->name;
  test.editor->comparison->b = "";
  test.editor->comparison->views = Comparison::Views::Wipe;
  test.play("wait-idle");
  REQUIRE(test.editor->views->other_scene);
  CHECK(test.editor->views->other_scene->weights);
  CHECK(test.editor->views->other_scene->mesh);
  CHECK_FALSE(scene.weights);
  CHECK(test.fact("text:Strain energy density, kPa") == "shown");
  run(*test.editor, "compare.swap");
  test.play("wait-idle");
  CHECK(scene.weights);
  CHECK_FALSE(test.editor->views->other_scene->weights);
  test.play("key Ctrl+1\nwait-idle");
  CHECK_FALSE(scene.weights);
}

TEST_CASE("settling: a result keeps its mesh in the project file, and gives it back bit for bit") {
  SolveEditor test;
  test.editor->background->worker_program = LIMBER_PROGRAM;
  test.play("key Ctrl+Return\nwait-job");
  REQUIRE(test.has_result());
  const Path path = test.folder / "limb.limber";
  save_project_as(*test.editor, path);
  test.play("wait-job");
  const Project opened = read_project(path);
  REQUIRE(opened.document.results.size() == 1);
  const auto &kept = opened.document.results[0]->solved, &made = test.editor->document().results[0]->solved;
  REQUIRE(kept);
  CHECK(kept->V == made->V);
  CHECK(kept->mesh.tets.V == made->mesh.tets.V);
  CHECK(kept->mesh.tets.T == made->mesh.tets.T);
  CHECK(kept->mesh.tets.region == made->mesh.tets.region);
}
