// SPDX-License-Identifier: AGPL-3.0-or-later
// The option --shard i/n: n runs of the program share the cells of a study or batch.
#pragma once

#include <string>
#include <vector>

namespace limber::cmd {

struct Shard {
  int index = 0, count = 1;  // index of this run, from 0; number of runs
};

// Reads a shard i/n, where i counts from 1. Throws Error if it is malformed.
Shard read_shard(const std::string& text);

// Returns the numbers, counted from 1, of the cells of a shard: every n-th cell, where n is the number of shards.
std::vector<int> numbers_of_shard(const Shard& shard, int cell_count);

}  // namespace limber::cmd
