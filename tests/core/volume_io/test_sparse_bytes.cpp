// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/volume_io/sparse_bytes.h"

#include <algorithm>
#include <random>

#include <doctest/doctest.h>

using namespace limber;

namespace {

// Returns runs of zeros and of other bytes, of random lengths.
std::string random_bytes(std::mt19937& random) {
  std::string bytes;
  for (int run = static_cast<int>(random() % 8); run > 0; --run) {
    const std::size_t length = random() % (random() % 2 ? 20 : 3000);
    const bool zero = random() % 2;
    for (std::size_t i = 0; i < length; ++i) bytes += zero ? '\0' : static_cast<char>(1 + random() % 255);
  }
  return bytes;
}

}  // namespace

TEST_CASE("sparse bytes: what is packed is unpacked unchanged, in pieces of any size, and zeros take no room") {
  std::mt19937 random(5);
  for (int round = 0; round < 500; ++round) {
    const std::string bytes = random_bytes(random);
    std::string packed = "head";
    pack_sparsely(bytes, packed);
    CHECK(packed.size() <= 4 + bytes.size() + 8 * (bytes.size() / 512 + 2));
    SparseBytes sparse(packed, 4);
    std::string unpacked(bytes.size(), 'x');
    for (std::size_t at = 0; at < bytes.size();) {
      const std::size_t some = std::min<std::size_t>(1 + random() % 1000, bytes.size() - at);
      REQUIRE(sparse.read(&unpacked[at], some));
      at += some;
    }
    CHECK(unpacked == bytes);
    CHECK(sparse.is_done());
    char more;
    CHECK_FALSE(sparse.read(&more, 1));
  }
  std::string packed;
  pack_sparsely(std::string(1 << 20, '\0'), packed);
  CHECK(packed.size() == 8);
}

TEST_CASE("sparse bytes: those that are cut short are refused, and damaged ones never lead beyond their end") {
  std::mt19937 random(6);
  std::string packed, unpacked(1000, 'x');
  pack_sparsely(std::string(600, 'a') + std::string(400, '\0'), packed);
  for (std::size_t size = 0; size < packed.size(); ++size)
    CHECK_FALSE(SparseBytes(packed.substr(0, size)).read(unpacked.data(), unpacked.size()));
  int refused = 0;
  for (int round = 0; round < 2000; ++round) {
    std::string damaged = packed;
    for (int change = 0; change < 3; ++change) damaged[random() % 24 % damaged.size()] = static_cast<char>(random());
    SparseBytes sparse(damaged);
    if (sparse.read(unpacked.data(), unpacked.size())) continue;
    ++refused;
    (void)sparse.read(unpacked.data(), unpacked.size());  // must not read beyond the end either
  }
  CHECK(refused > 100);
}
