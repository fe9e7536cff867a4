// SPDX-License-Identifier: AGPL-3.0-or-later
// The option --shard i/n, by which n programs share the cells of a study or batch.
#pragma once

#include <string>
#include <vector>

namespace limber::cmd {

struct Shard {
  int index = 0, count = 1;  // the index counts from 0
};

// Reads a shard i/n, where i counts from 1. Throws Error if it is malformed.
Shard read_shard(const std::string& text);

// Returns the numbers, counted from 1, of the shard's cells: every n-th one.
std::vector<int> numbers_of_shard(const Shard& shard, int cell_count);

}  // namespace limber::cmd
