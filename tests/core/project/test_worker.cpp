// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/project/worker.h"

#include <atomic>
#include <chrono>
#include <csignal>
#include <fstream>
#include <thread>
#include <vector>

#include <doctest/doctest.h>
#include <sched.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/support/program.h"
#include "tests/support/sanitizer.h"

using namespace limber;
using namespace limber::test;

namespace {

using Clock = std::chrono::steady_clock;

// Writes a shell script that stands in for the worker program.
Path script(const TemporaryFolder& folder, const std::string& text) {
  const Path path = folder / "worker";
  std::ofstream(path) << "#!/bin/sh\n" << text;
  std::filesystem::permissions(path, std::filesystem::perms::owner_all);
  return path;
}

std::string message_of(const TemporaryFolder& folder, const std::string& text, WorkerSettings settings = {}) {
  settings.program = script(folder, text);
  Progress quiet;
  try {
    run_worker("job.json", quiet, settings);
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

struct Seen final : Progress {
  std::string last;
  double fraction = -1;
  void on_update(std::string_view stage, double at) override {
    last = stage;
    fraction = at;
  }
};

// Returns true if the process runs and is not a zombie.
bool alive(const Path& pid_file) {
  std::ifstream in(pid_file);
  pid_t id = 0;
  if (!(in >> id)) return false;
  std::ifstream stat("/proc/" + std::to_string(id) + "/stat");
  std::string number, name, state;
  return stat >> number >> name >> state && state != "Z" && state != "X";
}

// Writes a job that bends an arm. At 0.8 mm it takes long and needs much memory.
void write_job(const TemporaryFolder& folder, const std::string& spacing = "8") {
  REQUIRE(run_limber({"phantom", "arm", "--spacing", "8", "-o", folder.path()}).exit_code == 0);
  std::ofstream(folder / "job.json")
      << R"({"command": "resample", "volume": "volume.nrrd", "rig": "rig.json", "tissues": "tissues.json",
    "flex": ["Forearm=60"], "method": "dqs", "threads": 1, "output": "posed.nrrd", "spacing": )"
      << spacing << "}";
}

}  // namespace

TEST_CASE("worker: a job file is run by the program itself in a process of its own, with its progress") {
  const TemporaryFolder folder;
  write_job(folder);
  Seen progress;
  run_worker(folder / "job.json", progress, {.program = LIMBER_PROGRAM});
  CHECK(std::filesystem::exists(folder / "posed.nrrd"));
  CHECK_FALSE(progress.last.empty());
  CHECK(progress.fraction == 1);
}

TEST_CASE("worker: its own error comes through word for word") {
  const TemporaryFolder folder;
  std::ofstream(folder / "job.json")
      << R"({"command": "resample", "volume": "no-such.nrrd", "rig": "rig.json", "output": "posed.nrrd",
        "method": "dqs"})";
  const auto direct = run_limber({"job", folder / "job.json"});
  Progress quiet;
  std::string message;
  try {
    run_worker(folder / "job.json", quiet, {.program = LIMBER_PROGRAM});
  } catch (const Error& error) {
    message = error.what();
  }
  CHECK("limber: " + message + "\n" == direct.err);
}

TEST_CASE("worker: output, warnings and progress are told apart") {
  const TemporaryFolder folder;
  Seen progress;
  const auto output = run_worker("job.json", progress, {.program = script(folder, R"(echo "$1 $2 $3 $4"
echo '{"stage": "solve", "fraction": 0.5}' >&2
echo 'limber: warning: thin: skin: look' >&2
echo '{"stage": 3}' >&2
echo '{not json' >&2)")});
  CHECK(output.text == "job job.json --progress json\n");
  CHECK(output.warnings == std::vector<std::string>{"thin: skin: look"});
  CHECK(progress.last == "solve");
  CHECK(progress.fraction == 0.5);
}

TEST_CASE("worker: what it tells of a solve comes whole") {
  const TemporaryFolder folder;
  std::vector<WorkerProgress> told;
  Progress quiet;
  run_worker("job.json", quiet,
             {.program = script(folder, R"(echo '{"stage": "mesh", "fraction": 0.25}' >&2
echo '{"stage":"solving","fraction":0.5,"angle_degrees":45.5,)"
                                        R"("iteration":7,"residual_mm":0.125,"seconds_left":12}' >&2)"),
              .on_progress = [&](const WorkerProgress& progress) { told.push_back(progress); }});
  REQUIRE(told.size() == 2);
  CHECK(told[0].stage == "mesh");
  CHECK(told[0].fraction == 0.25);
  CHECK_FALSE(told[0].iteration);
  CHECK_FALSE(told[0].residual_mm);
  CHECK(told[1].stage == "solving");
  CHECK(told[1].angle_degrees == 45.5);
  CHECK(told[1].iteration == 7);
  CHECK(told[1].residual_mm == 0.125);
  CHECK(told[1].seconds_left == 12.0);
}

TEST_CASE("worker: one that yields is given only what all others leave of the machine") {
  const TemporaryFolder folder;
  write_job(folder, "0.8");
  const std::string job = folder / "job.json";
  for (const bool yields : {true, false}) {
    const pid_t worker = ::fork();
    REQUIRE(worker >= 0);
    if (worker == 0) {
      ::execl(LIMBER_PROGRAM, "limber", "job", job.c_str(), yields ? "--yield" : nullptr, nullptr);
      ::_exit(1);
    }
    const auto policy_of = [&] { return ::sched_getscheduler(worker); };
    for (int i = 0; i < (yields ? 2000 : 60) && policy_of() != SCHED_IDLE; ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    CHECK((policy_of() == SCHED_IDLE) == yields);
    ::kill(worker, SIGKILL);
    ::waitpid(worker, nullptr, 0);
  }
}

TEST_CASE("worker: a crash, a kill and a failure without a word become clear messages") {
  const TemporaryFolder folder;
  CHECK(message_of(folder, "kill -SEGV $$") ==
        "the worker crashed: job.json, Segmentation fault: try other settings, and please report the settings that "
        "failed");
  CHECK(message_of(folder, "kill -ABRT $$").find("Aborted") != std::string::npos);
  CHECK(message_of(folder, "kill -KILL $$").find("lack of memory") != std::string::npos);
  CHECK(message_of(folder, "exit 1") == "the worker failed: job.json: the worker gave no reason");
  CHECK(message_of(folder, "echo 'limber: a: b: c' >&2; exit 1") == "a: b: c");
  CHECK(message_of(folder, "sleep 60", {.time_limit = 0.1}).starts_with("the worker took longer than"));
  Progress quiet;
  CHECK_THROWS_AS(run_worker("job.json", quiet, {.program = "/no/such/program"}), Error);
}

TEST_CASE("worker: one that is frozen is said not to answer, not to have a few seconds left, and is ended by a limit" *
          doctest::test_suite("slow")) {
  const TemporaryFolder folder;
  write_job(folder, "0.8");
  std::vector<WorkerProgress> told;
  WorkerSettings settings{
      .silence_shown = 1.5,
      .silence_limit = 3,
      .program = script(folder, "echo $$ > " + (folder / "pid").string() + "\nexec " LIMBER_PROGRAM " \"$@\"")};
  settings.on_progress = [&](const WorkerProgress& now) {
    told.push_back(now);
    pid_t id = 0;
    if (std::ifstream(folder / "pid") >> id; told.size() == 1) ::kill(id, SIGSTOP);
  };
  Seen progress;
  std::string message;
  const auto began = Clock::now();
  try {
    run_worker(folder / "job.json", progress, settings);
  } catch (const Error& error) {
    message = error.what();
  }
  CHECK(message.starts_with("the worker stopped answering and was ended after 3 s: "));
  CHECK(Clock::now() - began < std::chrono::seconds(20));
  REQUIRE(told.size() >= 2);
  CHECK(told.back().stage == kNotAnswering);
  CHECK_FALSE(told.back().seconds_left);
  CHECK(progress.last == kNotAnswering);
  for (int i = 0; i < 100 && alive(folder / "pid"); ++i) std::this_thread::sleep_for(std::chrono::milliseconds(100));
  CHECK_FALSE(alive(folder / "pid"));
}

TEST_CASE("worker: one that answers again is shown as before, and a slow one that works is not ended" *
          doctest::test_suite("slow")) {
  const TemporaryFolder folder;
  std::vector<std::string> stages;
  Progress quiet;
  const std::string text = R"(echo '{"stage": "solve", "fraction": 0.5, "seconds_left": 3}' >&2
sleep 1.2
echo '{"processor_seconds": 1.5}' >&2
sleep 0.1)";
  run_worker("job.json", quiet,
             {.silence_shown = 0.6, .program = script(folder, text), .on_progress = [&](const WorkerProgress& now) {
                stages.push_back(now.stage);
              }});
  CHECK(stages == std::vector<std::string>{"solve", kNotAnswering, "solve"});
  const std::string works = R"(for i in 1 2 3 4 5 6 7; do echo "{\"processor_seconds\": $i}" >&2; sleep 0.2; done)";
  CHECK(message_of(folder, works, {.silence_limit = 1}).empty());
  // Repeated messages with the same processor time are no sign of work.
  const std::string waits = R"(while true; do echo '{"processor_seconds": 1.0}' >&2; sleep 0.1; done)";
  CHECK(message_of(folder, waits, {.silence_limit = 0.5}).starts_with("the worker stopped answering"));
}

TEST_CASE("worker: a job that someone listens to tells every second what it has taken of the processor" *
          doctest::test_suite("slow")) {
  const TemporaryFolder folder;
  write_job(folder, "0.8");
  const std::string job = std::string(LIMBER_PROGRAM) + " job " + (folder / "job.json").string() + " --progress json";
  const auto said = [&](const std::string& more) {
    return run_program("/bin/sh", {"-c", job + more + " & sleep 2.4; kill -KILL $!"})
               .err.find("{\"processor_seconds\": ") != std::string::npos;
  };
  CHECK(said(" --parent $$"));
  CHECK_FALSE(said(""));
}

#ifndef LIMBER_ADDRESS_SANITIZER
TEST_CASE("worker: a job that wants more memory than it may have ends with a message") {
  const TemporaryFolder folder;
  write_job(folder, "0.8");
  Progress quiet;
  std::string message;
  try {
    run_worker(folder / "job.json", quiet, {.memory_limit_mb = 200, .program = LIMBER_PROGRAM});
  } catch (const Error& error) {
    message = error.what();
  }
  INFO(message);
  CHECK(message.find("memory") != std::string::npos);
  CHECK_FALSE(std::filesystem::exists(folder / "posed.nrrd"));
}
#endif

TEST_CASE("worker: a cancel ends it within a moment, also when it does not listen, and its children with it") {
  const TemporaryFolder folder;
  const std::string pid = folder / "pid", child = folder / "child";
  const Path program = script(
      folder, "trap '' TERM\nsleep 60 & echo $! > " + child + "\necho $$ > " + pid + "\nwhile true; do sleep 1; done");
  Progress progress;
  std::atomic<bool> cancelled = false;
  std::thread waiting([&] {
    try {
      run_worker("job.json", progress, {.program = program});
    } catch (const Cancelled&) {
      cancelled = true;
    }
  });
  while (!alive(pid) || !alive(child)) std::this_thread::sleep_for(std::chrono::milliseconds(5));
  const auto asked = Clock::now();
  progress.cancel();
  waiting.join();
  CHECK(Clock::now() - asked < std::chrono::seconds(2));  // 0.1 s on an idle machine
  CHECK(cancelled);
  CHECK_FALSE(alive(pid));
  for (int i = 0; i < 200 && alive(child); ++i) std::this_thread::sleep_for(std::chrono::milliseconds(5));
  CHECK_FALSE(alive(child));
  for (int i = 0; i < 200 && ::waitpid(-1, nullptr, WNOHANG) != -1; ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  CHECK(::waitpid(-1, nullptr, WNOHANG) == -1);  // no zombie is left
}

TEST_CASE("worker: a cancel does not wait until a busy machine has time to end one that yields" *
          doctest::test_suite("slow")) {
  const TemporaryFolder folder;
  write_job(folder, "0.8");
  std::atomic<bool> over = false;
  std::vector<std::thread> busy;
  Progress progress;
  std::atomic<bool> told = false;
  WorkerSettings settings{.yields = true, .program = LIMBER_PROGRAM};
  settings.on_progress = [&](const WorkerProgress&) { told = true; };
  std::thread waiting([&] { CHECK_THROWS_AS(run_worker(folder / "job.json", progress, settings), Cancelled); });
  while (!told) std::this_thread::sleep_for(std::chrono::milliseconds(5));
  for (unsigned i = 0; i < 2 * std::thread::hardware_concurrency(); ++i)
    busy.emplace_back([&] {
      while (!over) {
      }
    });
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  const auto asked = Clock::now();
  progress.cancel();
  waiting.join();
  // The cancel does not wait for the worker to end, which takes seconds. On an idle machine a cancel takes 75 ms.
  CHECK(Clock::now() - asked < std::chrono::milliseconds(700));
  over = true;
  for (std::thread& each : busy) each.join();
}

TEST_CASE("worker: it does not outlive the program that started it") {
  const TemporaryFolder folder;
  write_job(folder, "0.8");
  const std::string pid = folder / "pid";
  const pid_t parent = ::fork();
  REQUIRE(parent >= 0);
  if (parent == 0) {
    const std::string id = std::to_string(::getpid()), job = folder / "job.json";
    if (::fork() == 0) {
      std::ofstream(pid) << ::getpid() << std::flush;
      ::execl(LIMBER_PROGRAM, "limber", "job", job.c_str(), "--parent", id.c_str(), nullptr);
      ::_exit(1);
    }
    for (;;) ::pause();
  }
  for (int i = 0; i < 1000 && !alive(pid); ++i) std::this_thread::sleep_for(std::chrono::milliseconds(5));
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  CHECK(alive(pid));
  ::kill(parent, SIGKILL);
  ::waitpid(parent, nullptr, 0);
  for (int i = 0; i < 1000 && alive(pid); ++i) std::this_thread::sleep_for(std::chrono::milliseconds(5));
  CHECK_FALSE(alive(pid));
}
