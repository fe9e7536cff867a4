// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/platform/memory_pages.h"

#include <vector>

#include <doctest/doctest.h>

using namespace limber;

TEST_CASE("all zero: of bytes, wherever one is not") {
  std::vector<char> bytes(5000, 0);
  CHECK(is_all_zero(bytes.data(), 0));
  CHECK(is_all_zero(bytes.data(), bytes.size()));
  for (std::size_t at : {std::size_t{0}, std::size_t{1}, std::size_t{2500}, std::size_t{4999}}) {
    bytes[at] = 1;
    CHECK_FALSE(is_all_zero(bytes.data(), bytes.size()));
    CHECK(is_all_zero(bytes.data() + at + 1, bytes.size() - at - 1));
    bytes[at] = 0;
  }
}
