// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/skin/influence_chunk.h"

#include <algorithm>
#include <bit>
#include <stdexcept>

namespace limber {

namespace {

using Bones = std::array<std::uint16_t, 4>;

// Collects the different sets of bones that the voxels of a brick follow. Each set gets a number, in the order in which
// the sets first occur.
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

InfluenceChunk::InfluenceChunk(std::span<const Influence> influences)
    : count_(static_cast<std::uint16_t>(influences.size())) {
  if (influences.size() > 65535)
    throw std::logic_error("InfluenceChunk: there are more influences than a brick has voxels");
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
  if (records_ > 0) std::memcpy(bytes.get(), sets.numbers().data(), records_);
  std::uint8_t* at = bytes.get() + records_;
  for (std::size_t i = 0; i < influences.size(); ++i) {
    std::memcpy(at, &set[i], set_bytes_);  // the set's index; its lowest byte comes first
    at += set_bytes_;
    std::memcpy(at, &influences[i].weight[1], 2 * std::size_t{weights_});
    at += 2 * weights_;
  }
  std::memset(at, 0, kBehind);
  bytes_ = std::move(bytes);
}

InfluenceChunk::InfluenceChunk(std::size_t count, const Influence& all)
    : InfluenceChunk(std::vector<Influence>(count, all)) {}

namespace {

// Unpacks the stored records of a brick's voxels. In all these records the index of the bone set takes kSetBytes bytes,
// and kWeights weights follow.
template <int kSetBytes, int kWeights>
struct Records {
  const std::uint8_t *sets, *first;
  void unpack(std::size_t place, Influence& influence) const {
    const std::uint8_t* record = first + place * (kSetBytes + 2 * kWeights);
    std::uint16_t set = 0;
    std::memcpy(&set, record, kSetBytes);
    // Copies the four bones, and the four weights, as one 64-bit value each. If the numbers were written one by one, a
    // following 64-bit read would stall.
    std::uint64_t bones, others;
    std::memcpy(&bones, sets + set * sizeof(Bones), sizeof bones);
    // This copy may read beyond the end of the record. The next line sets the bytes that do not belong to the record to
    // 0.
    std::memcpy(&others, record + kSetBytes, sizeof others);
    others &= (std::uint64_t{1} << (16 * kWeights)) - 1;
    const std::uint64_t weights =
        (kFullWeight - ((others & 0xffff) + (others >> 16 & 0xffff) + (others >> 32))) | others << 16;
    std::memcpy(influence.bone.data(), &bones, sizeof bones);
    std::memcpy(influence.weight.data(), &weights, sizeof weights);
  }
};

// Calls body(records) with the instance of Records that fits this record layout. Returns false for rare layouts, for
// which there is no instance.
template <class Body>
bool with_records(int set_bytes, int weights, const std::uint8_t* sets, const std::uint8_t* first, const Body& body) {
  switch (set_bytes * 4 + weights) {
    case 0: return body(Records<0, 0>{sets, first}), true;
    case 1: return body(Records<0, 1>{sets, first}), true;
    case 2: return body(Records<0, 2>{sets, first}), true;
    case 3: return body(Records<0, 3>{sets, first}), true;
    case 4: return body(Records<1, 0>{sets, first}), true;
    case 5: return body(Records<1, 1>{sets, first}), true;
    case 6: return body(Records<1, 2>{sets, first}), true;
    case 7: return body(Records<1, 3>{sets, first}), true;
    default: return false;
  }
}

}  // namespace

void InfluenceChunk::unpack(Influence* influences) const {
  const auto all = [&](const auto& records) {
    for (std::size_t i = 0; i < count_; ++i) records.unpack(i, influences[i]);
  };
  if (!with_records(set_bytes_, weights_, bytes_.get(), bytes_.get() + records_, all))
    std::copy(begin(), end(), influences);
}

void InfluenceChunk::unpack(std::span<const std::uint16_t> places, Influence* influences) const {
  const auto some = [&](const auto& records) {
    for (std::size_t i = 0; i < places.size(); ++i) records.unpack(places[i], influences[i]);
  };
  if (!with_records(set_bytes_, weights_, bytes_.get(), bytes_.get() + records_, some))
    std::transform(places.begin(), places.end(), influences, [&](std::uint16_t place) { return (*this)[place]; });
}

bool InfluenceChunk::operator==(const InfluenceChunk& other) const {
  return count_ == other.count_ && records_ == other.records_ && set_bytes_ == other.set_bytes_ &&
         weights_ == other.weights_ &&
         std::memcmp(bytes_.get(), other.bytes_.get(), static_cast<std::size_t>(heap_bytes())) == 0;
}

bool InfluenceChunk::operator==(const std::vector<Influence>& other) const {
  return count_ == other.size() && std::equal(other.begin(), other.end(), begin());
}

}  // namespace limber
