// SPDX-License-Identifier: AGPL-3.0-or-later
// What the benchmarks share. Each benchmark runs five times. Its row in the output holds the median of the CPU time
// (user + system) and these counters:
//   peer      the same quantity for the program that Limber is compared with, on a comparable 2-core machine
//   ahead     how many times better Limber is than that program
//   goal      how many times better Limber should be
//   peak_mb   largest memory of the process, for rows that run a whole process
#pragma once

#include <benchmark/benchmark.h>

#include "tests/support/program.h"

namespace limber::bench {

// Gives a row five repetitions, of which the median is reported, and milliseconds as the unit.
inline void five_times(benchmark::internal::Benchmark* row) {
  row->Repetitions(5)->ReportAggregatesOnly(true)->Unit(benchmark::kMillisecond);
}

// Runs a whole process of `limber` as one iteration. CPU time and peak memory are those that the operating system
// counts for it. Fails the row when the program fails.
double run_whole_process(benchmark::State& state, const std::vector<std::string>& arguments);

// Set the counters of a row that is compared with another program: against_peer_rate by items per second (higher is
// better), against_peer_seconds by seconds (lower is better).
inline void against_peer_rate(benchmark::State& state, double items_per_iteration, double peer_rate, double goal) {
  state.counters["rate"] = benchmark::Counter(items_per_iteration, benchmark::Counter::kIsIterationInvariantRate);
  state.counters["ahead"] =
      benchmark::Counter(items_per_iteration / peer_rate, benchmark::Counter::kIsIterationInvariantRate);
  state.counters["peer"] = peer_rate;
  state.counters["goal"] = goal;
}
void against_peer_seconds(benchmark::State& state, double seconds, double peer_seconds, double goal);

}  // namespace limber::bench
