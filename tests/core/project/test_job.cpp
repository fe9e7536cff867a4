// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/project/job.h"

#include <atomic>
#include <chrono>
#include <thread>
#include <vector>

#include <doctest/doctest.h>

#include "tests/support/documents.h"

using namespace limber;
using namespace limber::test;

namespace {

using Clock = std::chrono::steady_clock;

void nap() { std::this_thread::sleep_for(std::chrono::milliseconds(2)); }

// Waits until the condition holds, for a minute at most.
template <class Condition>
bool wait_for(Jobs& jobs, History& history, const Condition& condition) {
  for (const auto start = Clock::now(); Clock::now() - start < std::chrono::minutes(1); nap()) {
    jobs.poll(history);
    if (condition()) return true;
  }
  return false;
}

bool finish(Jobs& jobs, History& history) {
  return wait_for(jobs, history, [&] { return !jobs.busy(); });
}

Edit name_result(const std::string& name) {
  return [name](const Document& now) {
    Document next = now;
    next.results.push_back(std::make_shared<const Result>(Result{.name = name}));
    return next;
  };
}

Edit work_until_cancelled(Progress& progress) {
  for (;; nap()) progress.update("waiting", 0.5);
}

}  // namespace

TEST_CASE(
    "job: its edit is applied to the document of the moment when it is done, so what was done meanwhile is kept") {
  History history(small_document());
  std::atomic<bool> go = false;
  Jobs jobs;
  jobs.start("Resample", [&go, input = history.current()](Progress& progress) {
    while (!go) nap();
    progress.update("deform", 1);
    return name_result("from " + std::to_string(input.results.size()));
  });
  Document meanwhile = history.current();
  meanwhile.visibility = nullptr;
  history.commit("Show all", meanwhile);
  go = true;
  REQUIRE(finish(jobs, history));
  CHECK(history.steps().back().label == "Resample");
  CHECK(history.current().visibility == nullptr);
  CHECK(history.current().results.back()->name == "from 1");
  CHECK(jobs.status(1).state == JobState::Done);
}

TEST_CASE("job: whatever is thrown becomes a message, and the document stays as it was") {
  History history(small_document());
  const Document before = history.current();
  Jobs jobs(4);
  const int error =
      jobs.start("A", [](Progress&) -> Edit { throw Error("no tissue", "arm.mha", "choose another volume"); });
  const int memory = jobs.start("B", [](Progress&) -> Edit {
    std::vector<char> huge;
    huge.reserve(huge.max_size() + 1);
    return {};
  });
  const int mistake = jobs.start("C", [](Progress&) -> Edit { throw std::runtime_error("bad index"); });
  const int unknown = jobs.start("D", [](Progress&) -> Edit { throw 42; });
  const int edit = jobs.start("E", [](Progress&) -> Edit {
    return [](const Document&) -> Document { throw Error("the volume has gone", "here", "open it again"); };
  });
  const int too_much = jobs.start("F", [](Progress&) -> Edit { throw std::bad_alloc(); });
  REQUIRE(finish(jobs, history));
  CHECK(jobs.status(error).message == "no tissue: arm.mha: choose another volume");
  CHECK(jobs.status(memory).message.starts_with("there is not enough memory: B: "));
  CHECK(jobs.status(mistake).message.find("bad index") != std::string::npos);
  CHECK(jobs.status(unknown).message.starts_with("an internal error of the program: D: "));
  CHECK(jobs.status(edit).message.starts_with("the volume has gone"));
  CHECK(jobs.status(too_much).message.starts_with("there is not enough memory"));
  for (const JobStatus& status : jobs.statuses()) CHECK(status.state == JobState::Failed);
  CHECK(history.current() == before);
  jobs.dismiss_ended();
  CHECK(jobs.statuses().empty());
}

TEST_CASE("job: a cancel ends it soon, is no error, and what it would have changed is dropped") {
  History history(small_document());
  const Document before = history.current();
  Jobs jobs;
  const int running = jobs.start("Wait", work_until_cancelled);
  std::atomic<bool> go = false;
  const int late = jobs.start("Late", [&go](Progress&) {
    while (!go) nap();
    return name_result("late");
  });
  const int queued = jobs.start("Queued", work_until_cancelled);
  CHECK(jobs.status(queued).state == JobState::Queued);
  REQUIRE(wait_for(jobs, history, [&] { return jobs.status(running).stage == "waiting"; }));
  jobs.cancel(queued);
  CHECK(jobs.status(queued).state == JobState::Cancelled);
  jobs.cancel(running);
  jobs.cancel(late);
  CHECK(jobs.status(late).state == JobState::Stopping);
  go = true;
  REQUIRE(finish(jobs, history));
  for (const JobStatus& status : jobs.statuses()) {
    CHECK(status.state == JobState::Cancelled);
    CHECK(status.message.empty());
  }
  CHECK(history.current() == before);
}

TEST_CASE(
    "job: one that hangs after its cancel is shown as stopping, lets the next one start and is left behind in the end" *
    doctest::test_suite("slow")) {
  static std::atomic<bool> release = false, gone = false;
  std::atomic<int> calls = 0;
  History history;
  {
    Jobs jobs(1, [&calls] { ++calls; });
    const int hanging = jobs.start("Hang", [](Progress&) -> Edit {
      while (!release) nap();
      gone = true;
      return {};
    });
    const int next = jobs.start("Next", [](Progress&) { return name_result("next"); });
    jobs.cancel(hanging);
    REQUIRE(wait_for(jobs, history, [&] { return jobs.status(next).state == JobState::Done; }));
    CHECK(jobs.status(hanging).state == JobState::Stopping);
    CHECK_FALSE(jobs.shut_down(0.05));
    CHECK(calls > 0);
  }
  const int calls_before = calls;
  release = true;
  for (int i = 0; i < 5000 && !gone; ++i) nap();
  CHECK(gone);
  CHECK(calls == calls_before);
}

TEST_CASE("job: progress tells the stage, the fraction and, when it can, the time that is left") {
  History history;
  Jobs jobs;
  std::atomic<bool> go = false;
  const int id = jobs.start("Slow", [&go](Progress& progress) -> Edit {
    progress.update("read", 1);
    progress.update("solve", 0);
    for (; !go; nap()) progress.update("solve", 0.25);
    return {};
  });
  REQUIRE(wait_for(jobs, history, [&] { return jobs.status(id).seconds_left.has_value(); }));
  const JobStatus status = jobs.status(id);
  CHECK(status.stage == "solve");
  CHECK(status.fraction == 0.25);
  CHECK(*status.seconds_left > 2 * status.seconds);
  go = true;
  REQUIRE(finish(jobs, history));
  CHECK_FALSE(history.can_undo());  // the job's edit changed nothing
}

TEST_CASE("job: many at once, in few threads, all come to their end") {
  History history;
  Jobs jobs(3);
  std::atomic<int> together = 0, most = 0;
  for (int i = 0; i < 60; ++i)
    jobs.start("Job " + std::to_string(i), [&, i](Progress& progress) {
      int now = ++together, before = most;
      while (now > before && !most.compare_exchange_weak(before, now)) {
      }
      for (int k = 0; k < 20; ++k) progress.update("work", k / 20.0);
      --together;
      return name_result(std::to_string(i));
    });
  REQUIRE(finish(jobs, history));
  jobs.poll(history);
  CHECK(history.current().results.size() == 60);
  CHECK(most <= 3);
}

TEST_CASE("job: long ones run one at a time, in order, and no other waits for them") {
  History history(small_document());
  Jobs jobs(1);
  std::atomic<bool> go = false;
  const auto until_go = [&go](Progress& progress) -> Edit {
    for (; !go; nap()) progress.update("solving", 0.5);
    return {};
  };
  const int first = jobs.start("First", until_go, Lane::Long), second = jobs.start("Second", until_go, Lane::Long);
  const int common = jobs.start("Common", [](Progress&) { return name_result("common"); });
  REQUIRE(wait_for(jobs, history, [&] { return jobs.status(common).state == JobState::Done; }));
  CHECK(jobs.status(first).state == JobState::Running);
  CHECK(jobs.status(second).state == JobState::Queued);
  jobs.cancel(first);
  REQUIRE(wait_for(jobs, history, [&] { return jobs.status(second).state == JobState::Running; }));
  go = true;
  REQUIRE(finish(jobs, history));
  CHECK(jobs.status(second).state == JobState::Done);
}

TEST_CASE("job: quiet ones run one at a time, and no other waits for them") {
  History history(small_document());
  Jobs jobs(1);
  std::atomic<bool> go = false;
  const auto until_go = [&go](Progress& progress) -> Edit {
    for (; !go; nap()) progress.update("refining", 0.5);
    return {};
  };
  const int first = jobs.start("", until_go, Lane::Quiet), second = jobs.start("", until_go, Lane::Quiet);
  const int common = jobs.start("Common", [](Progress&) { return name_result("common"); });
  const int again = jobs.start(
      "Again", [](Progress&) { return name_result("again"); }, Lane::Long);
  REQUIRE(wait_for(jobs, history, [&] {
    return jobs.status(common).state == JobState::Done && jobs.status(again).state == JobState::Done;
  }));
  CHECK(jobs.status(first).state == JobState::Running);
  CHECK(jobs.status(second).state == JobState::Queued);
  go = true;
  REQUIRE(finish(jobs, history));
}
