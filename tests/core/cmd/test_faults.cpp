// SPDX-License-Identifier: AGPL-3.0-or-later
// Makes every n-th file system call of a command fail, or kills the program at this call (by the preloaded library
// tests/support/failing_calls.cpp). A command that could not write reports the failure, inputs and older outputs are
// unchanged, and nothing is left behind after the next start.
#include <algorithm>
#include <csignal>
#include <map>

#include <doctest/doctest.h>

#include "core/base/file.h"
#include "tests/support/program.h"
#include "tests/support/sanitizer.h"

#ifndef LIMBER_ADDRESS_SANITIZER  // the sanitizer's library must be loaded before any other

using namespace limber;
using namespace limber::test;

namespace {

namespace fs = std::filesystem;

struct Bench {
  TemporaryFolder folder, state, log;
  std::string in(const std::string& name) const { return folder / name; }

  ProgramRun run(const std::vector<std::string>& words, const std::string& fault = "") const {
    std::vector<std::string> all{"XDG_STATE_HOME=" + state.path().string()};
    if (!fault.empty()) {
      all.push_back("LD_PRELOAD=" LIMBER_FAILING_CALLS);
      all.push_back("LIMBER_FAIL=" + fault);
      all.push_back("LIMBER_FAIL_LOG=" + (log / "log").string());
    }
    all.push_back(LIMBER_PROGRAM);
    all.insert(all.end(), words.begin(), words.end());
    return run_program("/usr/bin/env", all);
  }
  bool failed() const { return fs::exists(log / "log"); }
  std::map<std::string, std::string> contents() const {
    std::map<std::string, std::string> all;
    for (const auto& entry : fs::directory_iterator(folder.path()))
      all[entry.path().filename()] = sha256_of_file(entry.path());
    return all;
  }
};

// A command that makes `output`. It is run with faults, first without an output of an earlier run, then over one.
struct Request {
  std::string output;
  std::vector<std::string> words;
};

std::vector<Request> requests(const Bench& bench) {
  const std::string volume = bench.in("volume.nrrd"), rig = bench.in("rig.json"), tissues = bench.in("tissues.json");
  return {{"arm.limber",
           {"project", bench.in("arm.limber"), "create", volume, "--rig", rig, "--tissues", tissues, "--replace"}},
          {"w.nrrd",
           {"weights", volume, "--rig", rig, "--tissues", tissues, "--method", "rigid", "-o", bench.in("w.nrrd")}},
          {"posed.nrrd",
           {"resample", volume, "--rig", rig, "--tissues", tissues, "--weights", bench.in("given.nrrd"), "--flex",
            "Forearm=20", "--method", "lbs", "-o", bench.in("posed.nrrd")}}};
}

void make_inputs(const Bench& bench) {
  REQUIRE(bench.run({"phantom", "arm", "--spacing", "10", "-o", bench.folder.path()}).exit_code == 0);
  REQUIRE(bench
              .run({"weights", bench.in("volume.nrrd"), "--rig", bench.in("rig.json"), "--tissues",
                    bench.in("tissues.json"), "--method", "rigid", "-o", bench.in("given.nrrd")})
              .exit_code == 0);
}

}  // namespace

TEST_CASE("faults: when every n-th write, open, rename or sync fails, commands say so, and all is as before" *
          doctest::test_suite("slow")) {
  const Bench bench;
  make_inputs(bench);
  int faults = 0;
  for (const Request& request : requests(bench)) {
    for (const bool over_older : {false, true}) {
      if (over_older) REQUIRE(bench.run(request.words).exit_code == 0);
      auto before = bench.contents();
      for (const char* kind : {"write", "open", "rename", "fsync"})
        for (const int n : {1, 2, 5}) {
          fs::remove(bench.log / "log");
          const std::string fault = std::string(kind) + ":" + std::to_string(n);
          const ProgramRun run = bench.run(request.words, fault);
          INFO(request.output, over_older ? " over an older one, " : ", ", fault, ": ", run.exit_code, " ", run.err);
          if (!bench.failed()) {
            CHECK(run.exit_code == 0);
            if (!over_older) fs::remove(bench.in(request.output));
            before = bench.contents();  // saving a project again changes its identifier
            continue;
          }
          ++faults;
          CHECK(run.exit_code == 1);
          CHECK(std::count(run.err.begin(), run.err.end(), '\n') == 1);
          CHECK(run.err.find("/proc/") == std::string::npos);
          CHECK(run.err.find(".limber-") == std::string::npos);
          REQUIRE(bench.run({"--version"}).exit_code == 0);
          CHECK(bench.contents() == before);
        }
    }
    fs::remove(bench.in(request.output));
  }
  MESSAGE(faults, " faults");
  CHECK(faults > 30);
}

TEST_CASE("faults: what is killed at any of its writes leaves nothing behind after the next start" *
          doctest::test_suite("slow")) {
  const Bench bench;
  make_inputs(bench);
  int kills = 0, left = 0;
  for (const Request& request : requests(bench)) {
    const auto before = bench.contents();
    for (const char* kind : {"write", "rename", "fsync"})
      for (const int n : {1, 3, 9}) {
        fs::remove(bench.log / "log");
        const ProgramRun run = bench.run(request.words, std::string(kind) + ":" + std::to_string(n) + ":kill");
        INFO(request.output, ", ", kind, " ", n, ": ", run.exit_code, " ", run.err);
        if (!bench.failed()) {
          fs::remove(bench.in(request.output));
          continue;
        }
        ++kills;
        CHECK(run.exit_code == 128 + SIGKILL);
        left += bench.contents() != before;
        REQUIRE(bench.run({"--version"}).exit_code == 0);
        CHECK(bench.contents() == before);
        std::error_code error;
        CHECK(fs::is_empty(bench.state / "limber/unfinished", error));
      }
  }
  MESSAGE(kills, " kills, ", left, " of them with leftovers");
  CHECK(kills > 8);
  CHECK(left > 2);
}

#endif
