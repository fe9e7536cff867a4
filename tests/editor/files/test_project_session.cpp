// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/context/project_life.h"
#include "editor/files/project_session.h"
#include "editor/ui/ui.h"

#include <algorithm>
#include <chrono>
#include <csignal>
#include <fstream>
#include <regex>
#include <thread>

#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "core/project/project_io.h"
#include "editor/files/view_state_json.h"
#include "tests/editor/sitting.h"

using namespace limber;
using namespace limber::test;

namespace {

// Limits the files of this process to a few bytes, as on a full disk.
class FullDisk {
 public:
  FullDisk() {
    ::signal(SIGXFSZ, SIG_IGN);
    ::getrlimit(RLIMIT_FSIZE, &before_);
    rlimit full = before_;
    full.rlim_cur = 64;
    ::setrlimit(RLIMIT_FSIZE, &full);
  }
  ~FullDisk() { ::setrlimit(RLIMIT_FSIZE, &before_); }

 private:
  rlimit before_{};
};

}  // namespace

TEST_CASE("project: saved, closed and opened again it is the same document with the same views") {
  const Home home;
  std::string hash, state;
  {
    Sitting sitting(home.folder.path(), {home / "scans/ball.nrrd"});
    sitting.play(R"(
      expect name ball
      expect unsaved no
      move "3D view/view"
      key Alt+Z
      key Ctrl+Alt+Q
      click Muscle/17/eye
      expect unsaved yes
      key Ctrl+S
      expect dialog yes
      type ball
      key Return
      wait-job
      expect dialog no
      expect unsaved no
      expect name ball.limber
      expect text:Saved
    )");
    hash = sitting.test.fact("document");
    state = editor_state(sitting.editor());
    sitting.play("key Ctrl+Q\n expect quit yes");
  }
  CHECK(verify_project(home / "ball.limber").empty());
  CHECK(read_thumbnail(home / "ball.limber").starts_with("\x89PNG"));
  Sitting sitting(home.folder.path(), {home / "ball.limber"});
  sitting.play("expect layout four\n expect display xray\n expect hidden 1\n expect unsaved no");
  CHECK(sitting.test.fact("document") == hash);
  CHECK(editor_state(sitting.editor()) == state);
  CHECK(sitting.editor().recent_files->recents[0].path == home / "ball.limber");
}

TEST_CASE(
    "project: state of the editor that is nested a million deep is left out with a message, and the project opens") {
  const Home home;
  {
    Sitting sitting(home.folder.path(), {home / "scans/ball.nrrd"});
    Project project{.document = sitting.editor().document()};
    for (const char bracket : {'[', ']'}) project.editor += std::string(1'000'000, bracket);
    project.editor =
        R"({"schema": "limber-editor/1", "method": )" + project.editor + ", \"arrangements\": " + project.editor + "}";
    DocumentWriter writer;
    create_project(project, home / "deep.limber", writer);
  }
  Sitting sitting(home.folder.path(), {home / "deep.limber"});
  sitting.play("expect name deep.limber\n expect toast \"Views and tools were reset\"");
  CHECK(sitting.editor().document().volume != nullptr);
}

TEST_CASE("project: whatever numbers the state of the editor holds, places stay near enough to be drawn") {
  SmallEditor test;
  const std::string sound = editor_state(*test.editor);
  const std::regex numbers("-?[0-9]+(\\.[0-9]+)?(e[-+]?[0-9]+)?");
  std::vector<std::pair<std::ptrdiff_t, std::ptrdiff_t>> places;
  for (std::sregex_iterator at(sound.begin(), sound.end(), numbers), end; at != end; ++at)
    places.emplace_back(at->position(), at->length());
  REQUIRE(places.size() > 30);
  for (const char* number : {"1e308", "-1e308", "1e300", "-1", "4294967296", "1e-300", "null", "[]", "\"1\""})
    for (const auto& [at, length] : places) {
      INFO(number, " at ", at, " of ", sound);
      restore_editor_state(*test.editor, sound.substr(0, at) + number + sound.substr(at + length));
      const editor::Views& views = *test.editor->views;
      for (int axis = 0; axis < 3; ++axis) {
        CHECK(std::abs(views.cross_hair[axis]) <= 1e6);
        CHECK(std::abs(views.body.camera.centre[axis]) <= 1e6);
      }
      CHECK(std::abs(glm::length(views.body.camera.world_from_view) - 1) < 1e-6);
      for (const editor::SliceState& slice : views.slices) CHECK(slice.camera.millimetres_per_pixel > 0);
    }
  test.player.settle();
}

TEST_CASE("project: unsaved edits are asked about before New, Open and Quit, and Cancel changes nothing") {
  const Home home;
  Sitting sitting(home.folder.path(), {home / "scans/ball.nrrd"});
  sitting.play(R"(
    click Muscle/17/eye
    key Ctrl+Q
    expect "text:Save changes to ball?"
    key Escape
    expect quit no
    key Ctrl+N
    click dialog/Cancel
    expect volume yes
    key Ctrl+N
    click "Don't save"
    expect volume no
    expect unsaved no
    expect dialog no
    key Ctrl+Q
    expect quit yes
  )");
}

TEST_CASE("project: quitting can save first") {
  const Home home;
  Sitting sitting(home.folder.path(), {home / "scans/ball.nrrd"});
  sitting.play(R"(
    click Muscle/17/eye
    key Ctrl+Q
    key Return
    type first
    key Return
    wait-job
    expect quit yes
  )");
  CHECK(is_project(home / "first.limber"));
}

TEST_CASE("project: a sitting that ends well leaves nothing to recover, not even after edits that were not wanted") {
  const Home home;
  {
    Sitting sitting(home.folder.path(), {home / "scans/ball.nrrd"});
    sitting.play("click Muscle/17/eye");
    CHECK(sitting.editor().life->session->flush(20));
    CHECK_FALSE(std::filesystem::is_empty(home / "edits"));
    sitting.play("key Ctrl+Q\n click \"Don't save\"\n expect quit yes");
  }
  CHECK(std::filesystem::is_empty(home / "edits"));
}

TEST_CASE("project: after kill -9 of the program its edits are offered on the start screen, and come back") {
  const Home home;
  std::ofstream(home / "script") << "click Muscle/17/eye\nclick Skin/143/eye\nwait 3600\n";
  const std::string script = home / "script", volume = home / "scans/ball.nrrd", folder = home.folder.path();
  const pid_t child = ::fork();
  REQUIRE(child >= 0);
  if (child == 0) {
    for (const char* name : {"HOME", "XDG_CONFIG_HOME", "XDG_CACHE_HOME", "XDG_STATE_HOME"})
      ::setenv(name, folder.c_str(), 1);
    ::execl(LIMBER_PROGRAM, "limber", "editor", "--size", "1280x720", "--play", script.c_str(), volume.c_str(),
            nullptr);
    ::_exit(127);
  }
  std::vector<Recoverable> left;
  for (int i = 0; i < 1200 && ::waitpid(child, nullptr, WNOHANG) == 0; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    std::error_code ignored;
    std::uintmax_t bytes = 0;
    for (const auto& entry : std::filesystem::directory_iterator(home / "limber/edits", ignored))
      bytes += entry.file_size(ignored);
    // Waits until the first edit is stored, and up to a second longer.
    if (bytes > 0 && i % 20 == 19) break;
  }
  std::this_thread::sleep_for(std::chrono::seconds(1));
  ::kill(child, SIGKILL);
  ::waitpid(child, nullptr, 0);

  Sitting sitting(home.folder.path());
  sitting.editor().folders->edits = home / "limber/edits";
  look_for_leftovers(sitting.editor());
  sitting.play(
      "wait-job\n expect \"text:An unsaved project closed unexpectedly\"\n click recovery/Recover\n wait-job\n expect "
      "volume yes\n expect unsaved yes");
  CHECK(std::stoi(sitting.test.fact("hidden")) >= 1);
  CHECK(sitting.editor().life->recoverable.empty());
  sitting.play("key Ctrl+Q\n click \"Don't save\"");
}

TEST_CASE("project: what a crash left of a saved project is offered when it is opened") {
  const Home home;
  {
    Sitting sitting(home.folder.path(), {home / "scans/ball.nrrd"});
    sitting.play("key Ctrl+S\n type ball\n key Return\n wait-job\n click Muscle/17/eye");
    CHECK(sitting.editor().life->session->flush(20));
  }  // ends without a question, like a killed program
  for (const bool wanted : {true, false}) {
    Sitting sitting(home.folder.path(), {home / "ball.limber"});
    sitting.play("expect \"text:ball closed unexpectedly\"");
    if (wanted) sitting.play("key Return\n wait-job\n expect hidden 1\n expect unsaved yes");
    else sitting.play("click Discard\n expect hidden 0\n expect unsaved no");
  }
}

TEST_CASE("project: two editors do not write one project, the second may look at a copy") {
  const Home home;
  {
    Sitting first(home.folder.path(), {home / "scans/ball.nrrd"});
    first.play("key Ctrl+S\n type ball\n key Return\n wait-job");
  }
  Project held;
  const auto other = Session::open(home / "ball.limber", held, no_progress(), {.edits_folder = home / "edits"});
  Sitting second(home.folder.path(), {home / "ball.limber"});
  second.play(R"(
    expect "text:ball.limber is open in another Limber"
    expect volume no
    click "Open a copy"
    wait-job
    expect volume yes
    expect name "Copy of ball"
    expect unsaved yes
  )");
  CHECK(second.editor().project->path.empty());
  second.play("key Ctrl+N\n click \"Don't save\"");
}

TEST_CASE("project: where nothing can be written, one message says so and the edits stay") {
  const Home home;
  Sitting sitting(home.folder.path(), {home / "scans/ball.nrrd"});
  sitting.play(
      "click Muscle/17/eye\n key Ctrl+S\n type /proc/ball\n key Return\n wait-job\n expect unsaved yes\n expect hidden "
      "1");
  CHECK(sitting.test.fact("error") != "none");
  sitting.play("key Escape\n expect error none\n expect name ball");
  CHECK(sitting.editor().project->path.empty());
}

TEST_CASE(
    "project: on a full disk saving fails with a message, the edits stay, and saving works when there is room again") {
  const Home home;
  Sitting sitting(home.folder.path(), {home / "scans/ball.nrrd"});
  sitting.play("key Ctrl+S\n type ball\n key Return\n wait-job\n click Muscle/17/eye");
  {
    const FullDisk full;
    sitting.play("key Ctrl+S\n wait-job\n expect unsaved yes\n expect hidden 1");
    CHECK(sitting.test.fact("error") != "none");
  }
  sitting.play("key Escape\n key Ctrl+S\n wait-job\n expect unsaved no\n expect error none");
  CHECK(verify_project(home / "ball.limber").empty());
}

TEST_CASE(
    "project: a file that is deleted underneath is written anew, and one that another program replaced is not "
    "overwritten") {
  const Home home;
  Sitting sitting(home.folder.path(), {home / "scans/ball.nrrd"});
  sitting.play("key Ctrl+S\n type ball\n key Return\n wait-job\n click Muscle/17/eye");
  std::filesystem::remove(home / "ball.limber");
  sitting.play("key Ctrl+S\n wait-job\n expect unsaved no");
  CHECK(verify_project(home / "ball.limber").empty());
  // After the file was lost and written again, a message with the project's name says that edits are stored again.
  const auto& toasts = sitting.editor().messages->toasts;
  CHECK(std::any_of(toasts.begin(), toasts.end(), [](const auto& toast) { return toast.line == "ball.limber"; }));

  Project other;
  other.document = small_body();
  DocumentWriter writer;
  create_project(other, home / "ball.limber", writer);
  sitting.play("click Skin/143/eye\n key Ctrl+S\n wait-job\n expect unsaved yes");
  CHECK(sitting.test.fact("error") != "none");
  CHECK_FALSE(read_project(home / "ball.limber").document.visibility);
}

TEST_CASE("project: a preferred autosave writes the file by itself") {
  const Home home;
  Sitting sitting(home.folder.path(), {home / "scans/ball.nrrd"});
  sitting.play("key Ctrl+S\n type ball\n key Return\n wait-job");
  sitting.editor().preferences->autosave_minutes = 1;
  sitting.play("click Muscle/17/eye\n wait 0.1\n wait-job\n expect unsaved yes");
  sitting.editor().life->unsaved_since = sitting.editor().ui->now - 60;
  sitting.play("wait 0.1\n wait-job\n expect unsaved no");
}
