// SPDX-License-Identifier: AGPL-3.0-or-later
// What the benchmarks share. Each row runs five times and reports the median of CPU time (user + system); counters:
//   peer      the same figure of the program it is measured against, on a comparable 2-core machine
//   ahead     how many times better Limber is than that peer
//   goal      how many times better it means to be
//   peak_mb   largest memory of the process, for rows that run a whole process
#pragma once

#include <benchmark/benchmark.h>

#include "tests/support/program.h"

namespace limber::bench {

// Applies to every row: five repetitions, median only, time as told by the row itself or CPU time of one thread.
inline void five_times(benchmark::internal::Benchmark* row) {
  row->Repetitions(5)->ReportAggregatesOnly(true)->Unit(benchmark::kMillisecond);
}

// A whole process of `limber` as one iteration: CPU time and peak memory as the operating system counts them.
// Fails the row when the program fails.
double run_whole_process(benchmark::State& state, const std::vector<std::string>& arguments);

// rate, higher is better / seconds, lower is better
inline void against_peer_rate(benchmark::State& state, double items_per_iteration, double peer_rate, double goal) {
  state.counters["rate"] = benchmark::Counter(items_per_iteration, benchmark::Counter::kIsIterationInvariantRate);
  state.counters["ahead"] =
      benchmark::Counter(items_per_iteration / peer_rate, benchmark::Counter::kIsIterationInvariantRate);
  state.counters["peer"] = peer_rate;
  state.counters["goal"] = goal;
}
void against_peer_seconds(benchmark::State& state, double seconds, double peer_seconds, double goal);

}  // namespace limber::bench
