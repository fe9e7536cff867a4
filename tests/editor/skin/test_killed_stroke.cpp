// SPDX-License-Identifier: AGPL-3.0-or-later
#include <chrono>
#include <csignal>
#include <fstream>
#include <thread>

#include <sys/wait.h>
#include <unistd.h>

#include "core/project/journal.h"
#include "core/project/project_io.h"
#include "core/skin/weight_layers.h"
#include "tests/editor/sitting.h"
#include "tests/editor/weighed_limb.h"

namespace limber::test {

TEST_CASE(
    "painting: kill -9 during a stroke loses that stroke alone, layers and strokes before it are offered and come "
    "back") {
  const Home home;
  Document document = small_limb();
  document.weights = half_weights(*document.volume);
  const Path project = home / "limb.limber";
  DocumentWriter writer;
  create_project({.document = document}, project, writer);
  const std::string script = home / "script", picture = home / "second.png", folder = home.folder.path();
  // Makes a layer and a stroke on it, then begins another stroke whose button is never released.
  std::ofstream(script) << "key Ctrl+2\nmove \"3D view/view\"\nkey Num1\nwait-idle\nkey Shift+Ctrl+L\nwait-idle\n"
                           "press \"3D view/view\"\nrelease\nwait-idle\n"
                           "key ]\nkey ]\npress \"3D view/view\"\nmove \"3D view/view\"\nshot "
                        << picture << "\nwait 3600\n";
  const pid_t child = ::fork();
  REQUIRE(child >= 0);
  if (child == 0) {
    for (const char* name : {"HOME", "XDG_CONFIG_HOME", "XDG_CACHE_HOME", "XDG_STATE_HOME"})
      ::setenv(name, folder.c_str(), 1);
    ::execl(LIMBER_PROGRAM, "limber", "editor", "--size", "1280x720", "--play", script.c_str(), project.c_str(),
            nullptr);
    ::_exit(127);
  }
  bool runs = true;
  for (int i = 0; i < 2400 && runs && !std::filesystem::exists(picture); ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    runs = ::waitpid(child, nullptr, WNOHANG) == 0;
  }
  REQUIRE(runs);
  REQUIRE(std::filesystem::exists(picture));
  std::this_thread::sleep_for(std::chrono::seconds(1));  // a finished edit is on the disk within a second
  ::kill(child, SIGKILL);
  ::waitpid(child, nullptr, 0);

  CHECK(read_project(project).document.layers == nullptr);
  const auto left = recoverable(journal_path(project));
  REQUIRE(left);
  CHECK(left->edits == 2);
  CHECK(left->label == "Add Upper");
  const Recovered back = recover(journal_path(project));
  CHECK(back.warnings.empty());
  REQUIRE(back.document.layers);
  CHECK(back.document.layers->layers.size() == 1);
  CHECK(*back.document.layers->base == *document.weights);
  CHECK(*back.document.weights == composed(*back.document.layers));
  CHECK(*back.document.weights != *document.weights);
}

}  // namespace limber::test
