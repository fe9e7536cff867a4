// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/base/zeroed_vector.h"

#include <algorithm>
#include <cstdint>
#include <new>

#include <doctest/doctest.h>

using namespace limber;

TEST_CASE("zeroed vector: zeros of any length, that can be written like any other") {
  for (std::int64_t count : {std::int64_t{0}, std::int64_t{1}, std::int64_t{5000}, std::int64_t{30000001}}) {
    ZeroedVector<std::uint16_t> zeros(count);
    REQUIRE(std::ssize(zeros) == count);
    CHECK(std::all_of(zeros.begin(), zeros.end(), [](std::uint16_t value) { return value == 0; }));
    for (std::int64_t i = 0; i < count; i += 4999) zeros[i] = static_cast<std::uint16_t>(i % 60000 + 1);
    bool kept = true;
    for (std::int64_t i = 0; i < count; ++i) kept &= zeros[i] == (i % 4999 ? 0 : i % 60000 + 1);
    CHECK(kept);
  }
}

TEST_CASE("zeroed vector: more zeros than the machine has memory, where few are written") {
  const std::size_t count = std::size_t{1} << 36;  // 256 GB
  ZeroedVector<float> numbers(count);
  numbers[0] = 1;
  numbers[count - 1] = 2;
  CHECK(numbers[0] == 1);
  CHECK(numbers[count / 2] == 0);
  CHECK(numbers[count - 1] == 2);
  CHECK_THROWS_AS(ZeroedVector<float>(std::size_t{1} << 62), std::bad_alloc);
}

TEST_CASE("zeroed vector: what it grows by is zero, whatever stood there before") {
  for (std::size_t count : {std::size_t{1}, std::size_t{1000}, std::size_t{3000000}}) {
    ZeroedVector<int> values(count, 7);
    values.resize(count / 2);
    values.resize(count);
    CHECK(std::count(values.begin(), values.end(), 7) == std::ptrdiff_t(count / 2));
    values.clear();
    values.resize(count);
    CHECK(std::count(values.begin(), values.end(), 0) == std::ptrdiff_t(count));
    values.assign(count, 3);
    values.resize(2 * count + 1);
    CHECK(std::count(values.begin(), values.begin() + std::ptrdiff_t(count), 3) == std::ptrdiff_t(count));
    CHECK(std::count(values.begin() + std::ptrdiff_t(count), values.end(), 0) == std::ptrdiff_t(count + 1));
    const ZeroedVector<int> copy = values;
    CHECK(copy == values);
    ZeroedVector<int> moved = std::move(values);
    CHECK(moved == copy);
    moved.push_back(5);
    CHECK(moved.size() == copy.size() + 1);
    CHECK(moved[copy.size()] == 5);
    CHECK(moved != copy);
  }
}
