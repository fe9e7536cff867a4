// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/base/pages.h"

#include <algorithm>

#include <doctest/doctest.h>

using namespace limber;

TEST_CASE("sparse zeros: a vector of zeros of any length, that can be written like any other") {
  for (std::int64_t count : {std::int64_t{0}, std::int64_t{1}, std::int64_t{5000}, std::int64_t{30000001}}) {
    std::vector<std::uint16_t> zeros = sparse_zeros<std::uint16_t>(count);
    REQUIRE(std::ssize(zeros) == count);
    CHECK(std::all_of(zeros.begin(), zeros.end(), [](std::uint16_t value) { return value == 0; }));
    for (std::int64_t i = 0; i < count; i += 4999) zeros[i] = static_cast<std::uint16_t>(i % 60000 + 1);
    bool kept = true;
    for (std::int64_t i = 0; i < count; ++i) kept &= zeros[i] == (i % 4999 ? 0 : i % 60000 + 1);
    CHECK(kept);
  }
}

TEST_CASE("sparse zeros: giving pages back leaves what lies around them") {
  std::vector<char> bytes(100000, 0);
  bytes.front() = bytes.back() = 7;
  give_back_zeros(bytes.data() + 1, std::ssize(bytes) - 2);
  CHECK(bytes.front() == 7);
  CHECK(bytes.back() == 7);
  CHECK(std::count(bytes.begin(), bytes.end(), 0) == std::ssize(bytes) - 2);
}
