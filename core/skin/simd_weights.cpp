// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/skin/simd_weights.h"

#include <array>
#include <bit>
#include <cstring>
#include <limits>
#include <stdexcept>

#include "core/base/always_inline.h"
#include "core/platform/host.h"

namespace limber {

namespace {

// The code below is written once, for four and for eight voxels at a time. Eight are processed if the processor has
// AVX2.
#pragma GCC diagnostic ignored "-Wpsabi"  // vectors are only passed to inlined functions

static_assert(sizeof(Influence) == 16 && std::endian::native == std::endian::little);

struct Four {
  using Lanes = std::int32_t __attribute__((vector_size(16)));
  using Numbers = double __attribute__((vector_size(32)));
  // Loads the influences of four voxels, one voxel into each row.
  LIMBER_INLINE static void load(const Influence* from, Lanes* row) { std::memcpy(row, from, 4 * sizeof *row); }
  LIMBER_INLINE static void store(const Lanes* row, Influence* to) {
    std::memcpy(static_cast<void*>(to), row, 4 * sizeof *row);
  }
  // Transposes a matrix of 4 x 4 numbers in place.
  LIMBER_INLINE static void transpose(Lanes* row) {
    const Lanes a = __builtin_shufflevector(row[0], row[1], 0, 4, 1, 5),
                b = __builtin_shufflevector(row[2], row[3], 0, 4, 1, 5);
    const Lanes c = __builtin_shufflevector(row[0], row[1], 2, 6, 3, 7),
                d = __builtin_shufflevector(row[2], row[3], 2, 6, 3, 7);
    row[0] = __builtin_shufflevector(a, b, 0, 1, 4, 5);
    row[1] = __builtin_shufflevector(a, b, 2, 3, 6, 7);
    row[2] = __builtin_shufflevector(c, d, 0, 1, 4, 5);
    row[3] = __builtin_shufflevector(c, d, 2, 3, 6, 7);
  }
};

struct Eight {
  using Lanes = std::int32_t __attribute__((vector_size(32)));
  using Numbers = double __attribute__((vector_size(64)));
  // Loads the influences of eight voxels: voxels i and i + 4 into row i. So each half of the rows can be transposed on
  // its own.
  LIMBER_INLINE static void load(const Influence* from, Lanes* row) {
    for (int i = 0; i < 4; ++i) {
      Four::Lanes low, high;
      std::memcpy(&low, from + i, sizeof low);
      std::memcpy(&high, from + i + 4, sizeof high);
      row[i] = __builtin_shufflevector(low, high, 0, 1, 2, 3, 4, 5, 6, 7);
    }
  }
  LIMBER_INLINE static void store(const Lanes* row, Influence* to) {
    for (int i = 0; i < 4; ++i) {
      const Four::Lanes low = __builtin_shufflevector(row[i], row[i], 0, 1, 2, 3),
                        high = __builtin_shufflevector(row[i], row[i], 4, 5, 6, 7);
      std::memcpy(static_cast<void*>(to + i), &low, sizeof low);
      std::memcpy(static_cast<void*>(to + i + 4), &high, sizeof high);
    }
  }
  LIMBER_INLINE static void transpose(Lanes* row) {
    const Lanes a = __builtin_shufflevector(row[0], row[1], 0, 8, 1, 9, 4, 12, 5, 13),
                b = __builtin_shufflevector(row[2], row[3], 0, 8, 1, 9, 4, 12, 5, 13);
    const Lanes c = __builtin_shufflevector(row[0], row[1], 2, 10, 3, 11, 6, 14, 7, 15),
                d = __builtin_shufflevector(row[2], row[3], 2, 10, 3, 11, 6, 14, 7, 15);
    row[0] = __builtin_shufflevector(a, b, 0, 1, 8, 9, 4, 5, 12, 13);
    row[1] = __builtin_shufflevector(a, b, 2, 3, 10, 11, 6, 7, 14, 15);
    row[2] = __builtin_shufflevector(c, d, 0, 1, 8, 9, 4, 5, 12, 13);
    row[3] = __builtin_shufflevector(c, d, 2, 3, 10, 11, 6, 7, 14, 15);
  }
};

constexpr std::int32_t kLow = 0xffff, kHigh = ~kLow;
// Vector comparisons are signed, so 2^31 is subtracted from each key to keep the order of unsigned keys.
constexpr std::int32_t kBias = std::numeric_limits<std::int32_t>::min(),
                       kLeast = 0x10000 ^ kBias;  // smallest key of a bone whose weight is not 0

// The influences of several voxels. Each voxel has four keys, one for each of its bones. The upper 16 bits of a key are
// the weight, the lower 16 bits are 65535 - bone index. So descending keys have the order of an influence: by
// descending weight, then by bone.
template <class Width>
struct Voxels {
  using Lanes = typename Width::Lanes;
  using Numbers = typename Width::Numbers;
  Lanes key[4];

  LIMBER_INLINE explicit Voxels(const Influence* influences) {
    Lanes row[4];
    Width::load(influences, row);
    Width::transpose(row);  // now each row contains two bones, or two weights, of every voxel
    key[0] = (row[2] << 16 | (~row[0] & kLow)) ^ kBias;
    key[1] = ((row[2] & kHigh) | ((~row[0] >> 16) & kLow)) ^ kBias;
    key[2] = (row[3] << 16 | (~row[1] & kLow)) ^ kBias;
    key[3] = ((row[3] & kHigh) | ((~row[1] >> 16) & kLow)) ^ kBias;
  }

  LIMBER_INLINE void write(Influence* influences) const {
    // Sets the bone to 0 where the weight is 0.
    Lanes k[4];
    for (int i = 0; i < 4; ++i) k[i] = (key[i] ^ kBias ^ kLow) & (key[i] >= kLeast);
    Lanes row[4] = {(k[0] & kLow) | k[1] << 16, (k[2] & kLow) | k[3] << 16, ((k[0] >> 16) & kLow) | (k[1] & kHigh),
                    ((k[2] >> 16) & kLow) | (k[3] & kHigh)};
    Width::transpose(row);
    Width::store(row, influences);
  }

  LIMBER_INLINE Lanes weight(int i) const { return ((key[i] ^ kBias) >> 16) & kLow; }
  // Returns a mask for each voxel: all bits are set if key i belongs to this bone and its weight is not 0, else none.
  LIMBER_INLINE Lanes is_of(int i, std::int32_t bone_key) const {
    return ((key[i] & kLow) == bone_key) & (key[i] >= kLeast);
  }

  LIMBER_INLINE void order(int i, int k) {
    const Lanes greater = key[i] > key[k], both = (key[i] ^ key[k]) & greater;
    const Lanes less = key[i] ^ both;
    key[i] = key[k] ^ both;
    key[k] = less;
  }
  LIMBER_INLINE void sort() { order(0, 1), order(2, 3), order(0, 2), order(1, 3), order(1, 2); }
};

template <class Width>
LIMBER_INLINE typename Width::Lanes scaled(const typename Width::Lanes& weight, const typename Width::Numbers& factor) {
  return __builtin_convertvector(__builtin_convertvector(weight, typename Width::Numbers) * factor + 0.5,
                                 typename Width::Lanes);
}

template <class Width>
LIMBER_INLINE void set_group(Influence* influences, std::int32_t bone_key, std::int32_t heir_key,
                             const std::uint16_t* weights) {
  using Lanes = typename Width::Lanes;
  using Numbers = typename Width::Numbers;
  Voxels<Width> voxels(influences);
  const Voxels<Width> before = voxels;
  voxels.sort();
  Lanes now;
  for (std::size_t i = 0; i < sizeof(Lanes) / 4; ++i) now[i] = weights[i];
  // Masks with one lane for each voxel: own[i]: influence i belongs to the painted bone; found: one of the four does.
  // Weights: had: weight of the painted bone before; rest[i]: weight of influence i if it belongs to another bone.
  Lanes own[4], rest[4], had{}, found{};
  for (int i = 0; i < 4; ++i) {
    own[i] = voxels.is_of(i, bone_key);
    found |= own[i];
    had |= voxels.weight(i) & own[i];
  }
  const Lanes same = had == now;
  own[3] |= ~found;  // a new fifth bone replaces the one with the smallest weight
  for (int i = 0; i < 4; ++i) rest[i] = voxels.weight(i) & ~own[i];
  const Lanes others = kFullWeight - now, sum = rest[0] + rest[1] + rest[2] + rest[3];
  const Numbers factor = __builtin_convertvector(others, Numbers) / __builtin_convertvector(sum - (sum == 0), Numbers);
  // Scales the other bones' weights. All but the largest of them are rounded; the largest gets what remains of the sum.
  // The remainder is never negative, since at most two weights are rounded up, each by at most half a unit.
  Lanes made[4] = {Lanes{}, scaled<Width>(rest[1] & ~own[0], factor), scaled<Width>(rest[2], factor),
                   scaled<Width>(rest[3], factor)};
  const Lanes left = others - made[1] - made[2] - made[3];
  made[0] = left & ~own[0];
  made[1] |= left & own[0];
  // If the painted bone had all the weight, it is the first influence. Its fallback bone then becomes the second one.
  const Lanes nobody = sum == 0;
  voxels.key[1] = (voxels.key[1] & ~nobody) | (heir_key & nobody);
  for (int i = 0; i < 4; ++i) {
    const Lanes bone = (voxels.key[i] & kLow & ~own[i]) | (bone_key & own[i]), weight = made[i] | (now & own[i]);
    voxels.key[i] = (weight << 16 | bone) ^ kBias;
  }
  voxels.sort();
  for (int i = 0; i < 4; ++i) voxels.key[i] = (before.key[i] & same) | (voxels.key[i] & ~same);
  voxels.write(influences);
}

template <class Width>
LIMBER_INLINE void find_group(const Influence* influences, std::int32_t bone_key, std::uint16_t* weights) {
  const Voxels<Width> voxels(influences);
  typename Width::Lanes weight{};
  for (int i = 0; i < 4; ++i) weight |= voxels.weight(i) & voxels.is_of(i, bone_key);
  for (std::size_t i = 0; i < sizeof weight / 4; ++i) weights[i] = static_cast<std::uint16_t>(weight[i]);
}

template <class Width>
LIMBER_INLINE void set_all(Influence* influences, std::size_t count, std::int32_t bone_key, std::int32_t heir_key,
                           const std::uint16_t* weights) {
  for (std::size_t i = 0; i < count; i += sizeof(typename Width::Lanes) / 4)
    set_group<Width>(influences + i, bone_key, heir_key, weights + i);
}

template <class Width>
LIMBER_INLINE void find_all(const Influence* influences, std::size_t count, std::int32_t bone_key,
                            std::uint16_t* weights) {
  for (std::size_t i = 0; i < count; i += sizeof(typename Width::Lanes) / 4)
    find_group<Width>(influences + i, bone_key, weights + i);
}

#ifdef __x86_64__
[[gnu::target("avx2")]] void set_all_avx2(Influence* influences, std::size_t count, std::int32_t bone_key,
                                          std::int32_t heir_key, const std::uint16_t* weights) {
  set_all<Eight>(influences, count, bone_key, heir_key, weights);
}
[[gnu::target("avx2")]] void find_all_avx2(const Influence* influences, std::size_t count, std::int32_t bone_key,
                                           std::uint16_t* weights) {
  find_all<Eight>(influences, count, bone_key, weights);
}
#else
void set_all_avx2(Influence*, std::size_t, std::int32_t, std::int32_t, const std::uint16_t*) {}
void find_all_avx2(const Influence*, std::size_t, std::int32_t, std::uint16_t*) {}
#endif

std::int32_t key_of_bone(int bone) { return kLow - bone; }

void check_groups(std::size_t influences, std::size_t weights) {
  if (influences != weights || influences % kWeightLanes != 0)
    throw std::logic_error("simd_weights: the influences do not fill whole groups");
}

}  // namespace

void weights_of(std::span<const Influence> influences, int bone, std::span<std::uint16_t> weights, LaneWidth width) {
  check_groups(influences.size(), weights.size());
  const auto all = width == LaneWidth::Widest && has_avx2() ? find_all_avx2 : find_all<Four>;
  all(influences.data(), influences.size(), key_of_bone(bone), weights.data());
}

void set_weights(std::span<Influence> influences, int bone, int fallback_bone, std::span<const std::uint16_t> weights,
                 LaneWidth width) {
  check_groups(influences.size(), weights.size());
  const auto all = width == LaneWidth::Widest && has_avx2() ? set_all_avx2 : set_all<Four>;
  all(influences.data(), influences.size(), key_of_bone(bone), key_of_bone(fallback_bone), weights.data());
}

}  // namespace limber
