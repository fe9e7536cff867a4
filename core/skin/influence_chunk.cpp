// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/skin/influence_chunk.h"

#include <algorithm>
#include <bit>
#include <stdexcept>

namespace limber {

namespace {

using Bones = std::array<std::uint16_t, 4>;

// The sets of bones that occur, in the order of their first voxels.
class BoneSets {
 public:
  int place_of(const Bones& bones) {
    const auto number = std::bit_cast<std::uint64_t>(bones);
    if (!numbers_.empty() && numbers_[last_] == number) return last_;
    last_ = static_cast<int>(std::find(numbers_.begin(), numbers_.end(), number) - numbers_.begin());
    if (last_ == std::ssize(numbers_)) numbers_.push_back(number);
    return last_;
  }
  const std::vector<std::uint64_t>& numbers() const { return numbers_; }

 private:
  std::vector<std::uint64_t> numbers_;
  int last_ = 0;
};

}  // namespace

InfluenceChunk::InfluenceChunk(std::span<const Influence> influences) : count_(static_cast<std::uint16_t>(influences.size())) {
  if (influences.size() > 65535) throw std::logic_error("InfluenceChunk: more than a brick");
  static_assert(sizeof(std::uint64_t) == kSetBytes);
  BoneSets sets;
  std::vector<std::uint16_t> set(influences.size());
  std::uint16_t third = 0, fourth = 0, second = 0;
  for (std::size_t i = 0; i < influences.size(); ++i) {
    const Influence& influence = influences[i];
    if (influence.weight[0] + influence.weight[1] + influence.weight[2] + influence.weight[3] != kFullWeight)
      throw std::logic_error("SkinWeights: an influence does not sum to one");
    set[i] = static_cast<std::uint16_t>(sets.place_of(influence.bone));
    second |= influence.weight[1];
    third |= influence.weight[2];
    fourth |= influence.weight[3];
  }
  weights_ = fourth ? 3 : third ? 2 : second ? 1 : 0;
  set_bytes_ = sets.numbers().size() > 256 ? 2 : sets.numbers().size() > 1 ? 1 : 0;
  stride_ = static_cast<std::uint8_t>(set_bytes_ + 2 * weights_);
  records_ = static_cast<std::uint32_t>(sets.numbers().size() * kSetBytes);
  auto bytes = std::make_unique_for_overwrite<std::uint8_t[]>(static_cast<std::size_t>(heap_bytes()));
  std::memcpy(bytes.get(), sets.numbers().data(), records_);
  std::uint8_t* at = bytes.get() + records_;
  for (std::size_t i = 0; i < influences.size(); ++i) {
    std::memcpy(at, &set[i], set_bytes_);  // little end first
    at += set_bytes_;
    std::memcpy(at, &influences[i].weight[1], 2 * std::size_t{weights_});
    at += 2 * weights_;
  }
  std::memset(at, 0, kBehind);
  bytes_ = std::move(bytes);
}

InfluenceChunk::InfluenceChunk(std::size_t count, const Influence& all) : InfluenceChunk(std::vector<Influence>(count, all)) {}

namespace {

template <int kSetBytes, int kWeights>
void unpack_records(const std::uint8_t* bytes, const std::uint8_t* record, std::size_t count, Influence* influences) {
  for (std::size_t i = 0; i < count; ++i, record += kSetBytes + 2 * kWeights) {
    std::uint16_t set = 0;
    std::memcpy(&set, record, kSetBytes);
    std::array<std::uint16_t, 4> weight{kFullWeight};
    std::memcpy(&weight[1], record + kSetBytes, 2 * kWeights);
    weight[0] = static_cast<std::uint16_t>(kFullWeight - weight[1] - weight[2] - weight[3]);
    std::memcpy(influences[i].bone.data(), bytes + set * sizeof(Bones), sizeof(Bones));
    influences[i].weight = weight;
  }
}

}  // namespace

void InfluenceChunk::unpack(Influence* influences) const {
  const std::uint8_t *bytes = bytes_.get(), *records = bytes + records_;
  switch (set_bytes_ * 4 + weights_) {
    case 0: return count_ ? std::fill_n(influences, count_, (*this)[0]), void() : void();
    case 1: return unpack_records<0, 1>(bytes, records, count_, influences);
    case 2: return unpack_records<0, 2>(bytes, records, count_, influences);
    case 3: return unpack_records<0, 3>(bytes, records, count_, influences);
    case 4: return unpack_records<1, 0>(bytes, records, count_, influences);
    case 5: return unpack_records<1, 1>(bytes, records, count_, influences);
    case 6: return unpack_records<1, 2>(bytes, records, count_, influences);
    case 7: return unpack_records<1, 3>(bytes, records, count_, influences);
    default: std::copy(begin(), end(), influences);
  }
}

bool InfluenceChunk::operator==(const InfluenceChunk& other) const {
  return count_ == other.count_ && records_ == other.records_ && set_bytes_ == other.set_bytes_ && weights_ == other.weights_ &&
         std::memcmp(bytes_.get(), other.bytes_.get(), static_cast<std::size_t>(heap_bytes())) == 0;
}

bool InfluenceChunk::operator==(const std::vector<Influence>& other) const {
  return count_ == other.size() && std::equal(other.begin(), other.end(), begin());
}

}  // namespace limber
