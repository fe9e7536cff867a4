// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/deform/kept_corners.h"

#include <algorithm>
#include <tuple>

#include "core/platform/give_back_pages.h"

namespace limber {

namespace {

constexpr int kBits = 21;  // number of bits in which a corner's distance along one axis is stored
constexpr std::uint32_t kMask = (1u << kBits) - 1;
constexpr std::int64_t kCorners = std::tuple_size_v<KeptCorners::Corners>;

}  // namespace

KeptCorners::KeptCorners(const std::vector<int>& only_bone, std::int64_t most_bytes) {
  const std::int64_t most_slots = most_bytes / (kCorners * std::int64_t{sizeof(std::uint64_t)});
  slot_.assign(only_bone.size(), -1);
  std::int32_t slots = 0;
  for (std::size_t brick = 0; brick < only_bone.size(); ++brick)
    if (only_bone[brick] < 0 && slots < most_slots) slot_[brick] = slots++;
  top_.assign(slots, INT32_MIN);
  is_kept_.resize(slots);
  distances_.resize(slots * kCorners);
}

void KeptCorners::keep(std::int64_t brick, const FixedBox& box, const Corners& corners) {
  for (int axis = 0; axis < 3; ++axis)
    if (std::int64_t{box.high[axis]} - box.low[axis] > kMask) return;
  const std::int32_t slot = slot_[brick];
  if (slot < 0) return;
  std::uint64_t* kept = &distances_[slot * kCorners];
  const auto distance = [](int to, int from) {
    return std::uint64_t{(static_cast<std::uint32_t>(to) - static_cast<std::uint32_t>(from)) & kMask};
  };
  for (std::int64_t c = 0; c < kCorners; ++c) {
    const FixedPoint& at = corners[c];
    kept[c] = distance(at.x, box.low.x) | distance(at.y, box.low.y) << kBits | distance(at.z, box.low.z) << (2 * kBits);
  }
  top_[slot] = box.high.z >> 16;
  is_kept_[slot] = 1;
}

bool KeptCorners::read(std::int64_t brick, const FixedBox& box, Corners& corners) const {
  if (slot_[brick] < 0 || !is_kept_[slot_[brick]]) return false;
  const std::uint64_t* kept = &distances_[slot_[brick] * kCorners];
  for (std::int64_t c = 0; c < kCorners; ++c)
    corners[c] = box.low + FixedPoint(kept[c] & kMask, kept[c] >> kBits & kMask, kept[c] >> (2 * kBits));
  return true;
}

void KeptCorners::forget_below(int z) {
  const std::int64_t slots = std::ssize(top_);
  for (std::int64_t first = 0; first < slots; first += kGroup) {
    const std::int64_t end = std::min(first + kGroup, slots);
    const auto begin = is_kept_.begin();
    if (std::none_of(begin + first, begin + end, [](std::uint8_t kept) { return kept; })) continue;
    if (std::any_of(top_.begin() + first, top_.begin() + end, [&](int top) { return top >= z; })) continue;
    std::fill(begin + first, begin + end, std::uint8_t{0});
    give_back_pages(&distances_[first * kCorners], (end - first) * kCorners * std::int64_t{sizeof(std::uint64_t)});
  }
}

}  // namespace limber
