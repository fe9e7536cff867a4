// SPDX-License-Identifier: AGPL-3.0-or-later
// Simulates power cuts at random moments while someone works. LIMBER_POWER_CUTS sets how many (default 20).
#include <algorithm>
#include <cstdlib>
#include <random>

#include <doctest/doctest.h>

#include "core/base/error.h"
#include "tests/support/edit_script.h"
#include "tests/support/power_cut.h"
#include "tests/support/program.h"

using namespace limber;
using namespace limber::test;

namespace {

struct PowerGone {};

// Works until the power cut. Returns the number of the last edit that was certainly on the disk.
int work_until_the_cut(const TemporaryFolder& folder, PowerCut& power, std::uint32_t seed) {
  int kept = 0;
  EditScript script{.edits = 60, .pause = 0.001, .seed = seed};
  script.after_pause = [&](int edit, bool all_kept) {
    if (power.happened()) throw PowerGone();
    if (all_kept) kept = edit;
  };
  try {
    run_edit_script(
        folder / "a.limber",
        {.edits_folder = folder / "state", .open_log = power.open_log(), .retry_seconds = 0.01, .watch_seconds = 0.1},
        script);
  } catch (const PowerGone&) {
  } catch (const Error&) {
    CHECK(power.happened());
  }
  return kept;
}

void make_project(const TemporaryFolder& folder) {
  DocumentWriter writer;
  create_project({.document = edit_script_start()}, folder / "a.limber", writer);
}

}  // namespace

TEST_CASE(
    "power cut: whatever the disk lost of what was not synced, a project opens whole with every edit that was kept" *
    doctest::test_suite("slow")) {
  const char* wanted = std::getenv("LIMBER_POWER_CUTS");
  const int cuts = wanted ? std::atoi(wanted) : 20;
  std::mt19937 random(9);

  std::int64_t operations = 0;
  {
    const TemporaryFolder folder;
    make_project(folder);
    PowerCut power(folder.path(), std::int64_t{1} << 60, 0);
    work_until_the_cut(folder, power, 0);
    operations = power.operations();
  }
  REQUIRE(operations > 100);

  int struck = 0, recovered = 0;
  for (int round = 0; round < cuts; ++round) {
    const TemporaryFolder folder;
    make_project(folder);
    int kept = 0;
    bool happened = false;
    {
      PowerCut power(folder.path(), 1 + static_cast<std::int64_t>(random() % static_cast<std::uint64_t>(operations)),
                     random());
      kept = work_until_the_cut(folder, power, static_cast<std::uint32_t>(round));
      happened = power.happened();
      // The number of operations depends on the machine's speed. If the work ended before the cut, later cuts come
      // earlier.
      if (happened) power.restore();
      else operations = std::min(operations, power.operations());
    }
    if (!happened) continue;
    ++struck;

    INFO("round ", round);
    for (const std::string& wrong : verify_project(folder / "a.limber")) FAIL_CHECK(wrong);
    const auto list = all_recoverable(folder / "state");
    recovered += !list.empty();
    const Document back = list.empty() ? read_project(folder / "a.limber").document : recover(list[0].journal).document;
    CHECK(edit_of(back) >= kept);

    // Work continues from the recovered project.
    run_edit_script(folder / "a.limber", {.edits_folder = folder / "state"}, {.edits = edit_of(back) + 2, .pause = 0});
    CHECK(verify_project(folder / "a.limber").empty());
  }
  CHECK(struck > cuts / 2);
  MESSAGE(struck, " power cuts, edits recovered after ", recovered, " of them");
}
