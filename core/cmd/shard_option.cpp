// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/cmd/shard_option.h"

#include <cstdio>

#include "core/base/error.h"

namespace limber::cmd {

Shard read_shard(const std::string& text) {
  int number = 0, of = 0, end = 0;
  if (std::sscanf(text.c_str(), "%d/%d%n", &number, &of, &end) != 2 || end != static_cast<int>(text.size()) || of < 1 ||
      number < 1 || number > of)
    throw Error("this is not a shard (a part of the cells)", "--shard " + text,
                "write i/n with i from 1 to n, as in --shard 1/4");
  return {number - 1, of};
}

std::vector<int> numbers_of_shard(const Shard& shard, int cell_count) {
  std::vector<int> numbers;
  for (int number = shard.index + 1; number <= cell_count; number += shard.count) numbers.push_back(number);
  return numbers;
}

}  // namespace limber::cmd
