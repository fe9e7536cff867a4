// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/base/leftovers.h"

#include <csignal>
#include <cstdlib>
#include <fstream>

#include <doctest/doctest.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/support/program.h"

using namespace limber;

namespace {

namespace fs = std::filesystem;

// Sets the user's state folder to a temporary one as long as this object lives.
struct StateFolder {
  test::TemporaryFolder folder;
  std::string before = std::getenv("XDG_STATE_HOME") ? std::getenv("XDG_STATE_HOME") : "";
  StateFolder() { ::setenv("XDG_STATE_HOME", folder.path().c_str(), 1); }
  ~StateFolder() { before.empty() ? ::unsetenv("XDG_STATE_HOME") : ::setenv("XDG_STATE_HOME", before.c_str(), 1); }
  std::ptrdiff_t notes() const {
    std::error_code error;
    return std::distance(fs::directory_iterator(folder.path() / "limber" / "unfinished", error), {});
  }
};

void put(const Path& path, const std::string& bytes) { std::ofstream(path) << bytes; }

// Starts a process that registers an unfinished file at `path` and waits.
pid_t start_owner(const Path& path) {
  int ready[2];
  REQUIRE(::pipe(ready) == 0);
  const pid_t child = ::fork();
  if (child == 0) {
    const Unfinished unfinished(path);
    put(path, "a body");
    put(path.string() + "-journal", "its journal");
    [[maybe_unused]] const ssize_t told = ::write(ready[1], "x", 1);
    for (;;) ::pause();
  }
  char byte = 0;
  REQUIRE(::read(ready[0], &byte, 1) == 1);
  ::close(ready[0]);
  ::close(ready[1]);
  return child;
}

void kill_and_wait(pid_t child) {
  ::kill(child, SIGKILL);
  ::waitpid(child, nullptr, 0);
}

}  // namespace

TEST_CASE("leftovers: what a killed process left is removed by the next start, and not before it is dead") {
  const StateFolder state;
  const test::TemporaryFolder folder;
  const Path path = folder / ".limber-7-body.limber";
  const pid_t child = start_owner(path);
  remove_leftovers();
  CHECK(fs::exists(path));
  CHECK(state.notes() == 1);
  kill_and_wait(child);
  CHECK(fs::exists(path));
  REQUIRE(test::run_limber({"--version"}).exit_code == 0);
  CHECK(fs::is_empty(folder.path()));
  CHECK(state.notes() == 0);
}

TEST_CASE("leftovers: a folder goes with all that is in it, a link goes and what it names stays") {
  const StateFolder state;
  const test::TemporaryFolder folder;
  fs::create_directory(folder / "precious");
  put(folder / "precious" / "work", "hours");
  for (const bool as_link : {false, true}) {
    const Path path = folder / "limber-Ab3dEf";
    const pid_t child = start_owner(path);
    kill_and_wait(child);
    fs::remove(path);
    fs::remove(path.string() + "-journal");
    if (as_link) {
      fs::create_directory_symlink(folder / "precious", path);
    } else {
      fs::create_directory(path);
      put(path / "posed.nrrd", "a body");
      fs::create_directory_symlink(folder / "precious", path / "link");
    }
    remove_leftovers();
    CHECK(fs::exists(path) == as_link);
    CHECK(fs::exists(folder / "precious" / "work"));
    CHECK(state.notes() == 0);
    fs::remove(path);
  }
}

TEST_CASE("leftovers: a note that names what Limber never makes removes nothing") {
  const StateFolder state;
  const test::TemporaryFolder folder;
  put(folder / "thesis.tex", "years");
  fs::create_directories(state.folder.path() / "limber" / "unfinished");
  int number = 0;
  for (const std::string& text : {(folder / "thesis.tex").string() + "\n", folder.path().string() + "\n",
                                  std::string("/\n"), std::string("thesis.tex\n"), (folder / ".limber-1-x").string()})
    put(state.folder.path() / "limber" / "unfinished" / ("1-" + std::to_string(++number)), text);
  put(folder / ".limber-1-x", "its note is torn");
  remove_leftovers();
  CHECK(fs::exists(folder / "thesis.tex"));
  CHECK(fs::exists(folder / ".limber-1-x"));
  CHECK(state.notes() == 0);
}

TEST_CASE("leftovers: whatever ends as it should leaves neither file nor note") {
  const StateFolder state;
  const test::TemporaryFolder folder;
  {
    const Unfinished unfinished(folder / ".limber-1-x");
    put(folder / ".limber-1-x", "half");
    CHECK(state.notes() == 1);
  }
  CHECK(fs::is_empty(folder.path()));
  CHECK(state.notes() == 0);
}
