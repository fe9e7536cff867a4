// SPDX-License-Identifier: AGPL-3.0-or-later
// Kills a session at random moments, again and again, and continues each time from what is left. LIMBER_KILLS sets how
// often (default 12), LIMBER_KILL_PAUSE the pause between two edits in seconds (default 0.003).
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <random>
#include <thread>

#include <doctest/doctest.h>
#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include "core/base/error.h"
#include "tests/support/documents.h"
#include "tests/support/edit_script.h"
#include "tests/support/program.h"

using namespace limber;
using namespace limber::test;

namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

double number_from(const char* variable, double otherwise) {
  const char* text = std::getenv(variable);
  return text ? std::atof(text) : otherwise;
}

// A line of the log, written at once for each edit: what the user saw done, and when.
struct Done {
  int edit = 0;
  std::int64_t nanoseconds = 0;
};

std::vector<Done> done_edits(const Path& log) {
  std::vector<Done> all;
  std::ifstream in(log);
  for (Done one; in >> one.edit >> one.nanoseconds;) all.push_back(one);
  return all;
}

std::int64_t nanoseconds_now() { return Clock::now().time_since_epoch().count(); }

pid_t start_script(const TemporaryFolder& folder, int seed, double pause) {
  const std::string seed_text = std::to_string(seed), pause_text = std::to_string(pause);
  const pid_t child = ::fork();
  if (child == 0) {
    ::setenv("LIMBER_EDIT_SCRIPT", folder.path().c_str(), 1);
    ::setenv("LIMBER_EDIT_SEED", seed_text.c_str(), 1);
    ::setenv("LIMBER_EDIT_PAUSE", pause_text.c_str(), 1);
    ::execl("/proc/self/exe", "limber_tests", "--no-skip", "--test-case=edit script: run by another test*", nullptr);
    ::_exit(127);
  }
  return child;
}

}  // namespace

TEST_CASE("edit script: run by another test, to be killed" * doctest::skip()) {
  const char* folder = std::getenv("LIMBER_EDIT_SCRIPT");
  if (!folder) return;
  const int log = ::open((Path(folder) / "log").c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0600);
  EditScript script{.pause = number_from("LIMBER_EDIT_PAUSE", 0.01),
                    .seed = static_cast<std::uint32_t>(number_from("LIMBER_EDIT_SEED", 0))};
  script.after_edit = [&](int edit) {
    const std::string line = std::to_string(edit) + " " + std::to_string(nanoseconds_now()) + "\n";
    CHECK(::write(log, line.data(), line.size()) == std::ssize(line));
  };
  run_edit_script(Path(folder) / "a.limber", {.edits_folder = Path(folder) / "state"}, script);
}

TEST_CASE("kill: killed at any moment, a project opens whole, with all edits but at most the last second's" *
          doctest::test_suite("slow")) {
  const int kills = static_cast<int>(number_from("LIMBER_KILLS", 12));
  const double pause = number_from("LIMBER_KILL_PAUSE", 0.003);
  std::mt19937 random(4);
  double worst = 0;
  int struck = 0, lost = 0;
  for (int round = 0; struck < kills; ++round) {
    const TemporaryFolder folder;
    const Path path = folder / "a.limber";
    DocumentWriter writer;
    create_project({.document = edit_script_start()}, path, writer);
    for (int reached = 0; struck < kills; ++struck) {
      const pid_t child = start_script(folder, struck, pause);
      REQUIRE(child > 0);
      const double wait = 0.02 + 200 * pause * static_cast<double>(random() % 1000) / 1500;
      std::this_thread::sleep_for(std::chrono::duration<double>(wait));
      const std::int64_t killed = nanoseconds_now();
      ::kill(child, SIGKILL);
      int status = 0;
      REQUIRE(::waitpid(child, &status, 0) == child);
      if (!WIFSIGNALED(status)) {
        CHECK(status == 0);
        break;  // the process had finished before the kill
      }

      for (const std::string& wrong : verify_project(path)) FAIL_CHECK(wrong);
      const auto list = all_recoverable(folder / "state");
      const Document back = list.empty() ? read_project(path).document : recover(list[0].journal).document;
      const int edit = edit_of(back);
      CHECK(edit >= reached);
      reached = edit;
      for (const Done& done : done_edits(folder / "log")) {
        if (done.edit <= edit) continue;
        const double age = static_cast<double>(killed - done.nanoseconds) * 1e-9;
        worst = std::max(worst, age);
        ++lost;
        CHECK(age <= 1);
      }
      fs::remove(folder / "log");
    }
  }
  MESSAGE(struck, " kills, ", lost, " edits lost, the oldest of them ", worst, " s before its kill");
}
