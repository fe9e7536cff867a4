// SPDX-License-Identifier: AGPL-3.0-or-later
// The influences of the voxels of one brick (8^3 voxels), packed and immutable. The voxels of a brick follow few
// different sets of bones, and most voxels follow one or two bones. So each set of bones is stored once. A voxel stores
// the index of its set and all its weights except the first, which is 1 minus the others. That takes 0 to 8 bytes per
// voxel instead of 16, without loss.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <iterator>
#include <memory>
#include <span>
#include <vector>

#include "core/skin/influence.h"

namespace limber {

class InfluenceChunk {
 public:
  InfluenceChunk() = default;
  // Packs the influences of a brick's voxels. Throws std::logic_error if the weights of a voxel do not sum to exactly
  // kFullWeight.
  explicit InfluenceChunk(std::span<const Influence> influences);
  InfluenceChunk(std::size_t count, const Influence& all);

  std::size_t size() const { return count_; }
  bool empty() const { return count_ == 0; }
  Influence operator[](std::size_t i) const {
    // To avoid branches, this code reads beyond the end of the record (kBehind bytes make room for it) and masks the
    // bytes that do not belong to the record.
    const std::uint8_t* at = bytes_.get() + records_ + i * stride_;
    const std::size_t set = read<std::uint16_t>(at) & ((1u << (8 * set_bytes_)) - 1);
    const std::uint64_t others = read<std::uint64_t>(at + set_bytes_) & ((std::uint64_t{1} << (16 * weights_)) - 1);
    const std::uint64_t first = kFullWeight - ((others & 0xffff) + (others >> 16 & 0xffff) + (others >> 32));
    return {std::bit_cast<std::array<std::uint16_t, 4>>(read<std::uint64_t>(bytes_.get() + set * kSetBytes)),
            std::bit_cast<std::array<std::uint16_t, 4>>(first | others << 16)};
  }
  Influence front() const { return (*this)[0]; }

  // An iterator that unpacks one influence at a time.
  class Iterator {
   public:
    using iterator_category = std::input_iterator_tag;
    using value_type = Influence;
    using difference_type = std::ptrdiff_t;
    using pointer = void;
    using reference = Influence;
    Iterator() = default;
    Iterator(const InfluenceChunk* chunk, std::size_t at) : chunk_(chunk), at_(at) {}
    Influence operator*() const { return (*chunk_)[at_]; }
    Iterator& operator++() {
      ++at_;
      return *this;
    }
    Iterator operator++(int) {
      Iterator before = *this;
      ++at_;
      return before;
    }
    bool operator==(const Iterator& other) const { return at_ == other.at_; }

   private:
    const InfluenceChunk* chunk_ = nullptr;
    std::size_t at_ = 0;
  };
  Iterator begin() const { return {this, 0}; }
  Iterator end() const { return {this, count_}; }

  // Unpacks the influences of all size() voxels.
  void unpack(Influence* influences) const;
  // Unpacks the influences of some voxels. `places` lists their indices in the brick.
  void unpack(std::span<const std::uint16_t> places, Influence* influences) const;
  operator std::vector<Influence>() const {
    std::vector<Influence> influences(count_);
    unpack(influences.data());
    return influences;
  }

  bool operator==(const InfluenceChunk& other) const;
  bool operator==(const std::vector<Influence>& other) const;

  std::int64_t heap_bytes() const {
    return static_cast<std::int64_t>(records_ + std::size_t{count_} * stride_ + kBehind);
  }

 private:
  static_assert(std::endian::native == std::endian::little);
  static constexpr std::size_t kSetBytes = sizeof(Influence::bone), kBehind = 8;
  template <class Number>
  static Number read(const std::uint8_t* at) {
    Number number;
    std::memcpy(&number, at, sizeof number);
    return number;
  }

  // Holds the sets of bones, then one record for each voxel, then kBehind unused bytes.
  std::unique_ptr<const std::uint8_t[]> bytes_;
  std::uint32_t records_ = 0;  // byte offset of the first record
  std::uint16_t count_ = 0;
  // Layout of a record: number of bytes of the set's index, number of weights, and length in bytes.
  std::uint8_t set_bytes_ = 0, weights_ = 0, stride_ = 0;
};

// A view of a brick's influences, which may be packed or unpacked. The influences must outlive the view.
class InfluenceView {
 public:
  InfluenceView() = default;
  InfluenceView(const InfluenceChunk& packed) : packed_(&packed) {}
  InfluenceView(const std::vector<Influence>& plain) : plain_(plain.data()) {}
  Influence operator[](std::size_t i) const { return plain_ ? plain_[i] : (*packed_)[i]; }
  // Unpacks the whole brick, which holds `count` influences.
  void unpack(std::size_t count, Influence* influences) const {
    if (plain_) std::copy_n(plain_, count, influences);
    else packed_->unpack(influences);
  }

 private:
  const InfluenceChunk* packed_ = nullptr;
  const Influence* plain_ = nullptr;
};

}  // namespace limber
