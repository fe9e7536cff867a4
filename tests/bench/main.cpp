// SPDX-License-Identifier: AGPL-3.0-or-later
#include "tests/bench/bench.h"

#include <string>
#include <vector>

#include "core/base/parallel.h"

namespace limber::bench {

double run_whole_process(benchmark::State& state, const std::vector<std::string>& arguments) {
  const auto run = test::run_limber(arguments);
  if (run.exit_code != 0) state.SkipWithError(("limber " + arguments.front() + " failed: " + run.err).c_str());
  state.SetIterationTime(run.cpu_seconds);
  state.counters["peak_mb"] = run.peak_mb;
  return run.cpu_seconds;
}

void against_peer_seconds(benchmark::State& state, double seconds, double peer_seconds, double goal) {
  state.counters["ahead"] = peer_seconds / seconds;
  state.counters["peer"] = peer_seconds;
  state.counters["goal"] = goal;
}

namespace {
// Reports only the median of the five repetitions.
class MedianReporter : public benchmark::JSONReporter {
 public:
  void ReportRuns(const std::vector<Run>& runs) override {
    std::vector<Run> medians;
    for (const Run& run : runs)
      if (run.error_occurred || run.aggregate_name == "median") medians.push_back(run);
    if (!medians.empty()) JSONReporter::ReportRuns(medians);
  }
};
}  // namespace

}  // namespace limber::bench

int main(int argc, char** argv) {
  // Uses one thread, so that times are those of one core.
  const limber::ThreadCount one_thread(1);
  std::vector<std::string> words(argv, argv + argc);
  std::vector<char*> arguments;
  for (auto& word : words) arguments.push_back(word.data());
  int count = static_cast<int>(arguments.size());
  benchmark::Initialize(&count, arguments.data());
  if (benchmark::ReportUnrecognizedArguments(count, arguments.data())) return 2;
  limber::bench::MedianReporter reporter;
  benchmark::RunSpecifiedBenchmarks(&reporter);
  return 0;
}
