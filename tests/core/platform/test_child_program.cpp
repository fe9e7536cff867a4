// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/platform/child_program.h"

#include <chrono>
#include <thread>

#include <doctest/doctest.h>

#include "core/platform/pipe.h"

using namespace limber;

namespace {

struct Shell {
  std::error_code error;
  Pipe out = make_pipe(error);
  ChildProgram program;
  explicit Shell(const std::string& script)
      : program("/bin/sh", {"sh", "-c", script}, {.out = &out.write_end}, Environment::Empty, error) {
    REQUIRE_FALSE(error);
    out.write_end.close();
  }
  // Returns all that the program writes until no process holds its standard output open.
  std::string all() {
    std::string text;
    for (char block[256];;) {
      const std::ptrdiff_t got = read_some(out.read_end, block, sizeof block);
      if (got == 0) return text;
      if (got > 0) text.append(block, static_cast<std::size_t>(got));
      else if (!wait_to_read({&out.read_end}, 10000)) return text + " and then nothing for 10 s";
    }
  }
  const ProgramEnd& end() {
    while (!program.has_ended()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    return program.end();
  }
};

}  // namespace

TEST_CASE("child program: what it writes arrives, and its exit code") {
  Shell shell("echo said; exit 7");
  CHECK(shell.all() == "said\n");
  CHECK(shell.end().exit_code == 7);
  CHECK_FALSE(shell.end().by_signal());
}

TEST_CASE("child program: its children end with it") {
  Shell shell("sleep 100 & sleep 100");
  shell.program.kill_and_wait();
  CHECK(shell.end().was_killed());
  CHECK(shell.all().empty());  // returns at once only if the sleeping children do not hold the pipe
}

TEST_CASE("child program: a program that is not there is an error") {
  std::error_code error;
  ChildProgram program("/no/such/program", {"program"}, {}, Environment::Same, error);
  CHECK(error == std::errc::no_such_file_or_directory);
  CHECK(program.has_ended());
}
