// SPDX-License-Identifier: AGPL-3.0-or-later
// Writes values as bytes and reads them back, bit for bit. Numbers are little-endian, as in memory; texts and lists
// start with their length. The reader does not trust the bytes: it never reads past the end, and before memory is
// allocated for a list, it compares the list's length with the bytes that are left.
#pragma once

#include <bit>
#include <cstdint>
#include <cstring>
#include <functional>
#include <string>
#include <string_view>
#include <type_traits>

namespace limber {

static_assert(std::endian::native == std::endian::little, "files and messages are little-endian");

class ByteWriter {
 public:
  template <class T>
  void put(T value) {
    static_assert(std::is_arithmetic_v<T> && !std::is_same_v<T, bool>);
    bytes_.append(reinterpret_cast<const char*>(&value), sizeof value);
  }
  void flag(bool value) { put(static_cast<std::uint8_t>(value)); }
  void count(std::size_t value) { put(static_cast<std::uint32_t>(value)); }
  void text(std::string_view value) {
    count(value.size());
    bytes_ += value;
  }
  void raw(const void* bytes, std::size_t size) { bytes_.append(static_cast<const char*>(bytes), size); }
  std::string take() { return std::move(bytes_); }

 private:
  std::string bytes_;
};

class ByteReader {
 public:
  // Reads from `bytes`. When a value is not valid or the bytes end too early, the reader calls `damaged`, which must
  // throw.
  ByteReader(std::string_view bytes, std::function<void()> damaged) : bytes_(bytes), damaged_(std::move(damaged)) {}

  template <class T>
  T get() {
    static_assert(std::is_arithmetic_v<T> && !std::is_same_v<T, bool>);
    T value;
    std::memcpy(&value, raw(sizeof value).data(), sizeof value);
    return value;
  }
  bool flag() { return get_below<std::uint8_t>(2) == 1; }
  // Reads a number that must lie in [0, end).
  template <class T>
  T get_below(std::uint64_t end) {
    const T value = get<T>();
    require(static_cast<std::uint64_t>(value) < end);
    return value;
  }
  // Reads the length of a list. Each element of the list takes at least `least` bytes, so a length that needs more
  // bytes than are left is not valid.
  std::size_t count(std::size_t least) {
    const std::size_t value = get<std::uint32_t>();
    require(value <= bytes_.size() / least);
    return value;
  }
  std::string text() { return std::string(raw(count(1))); }
  std::string_view raw(std::size_t size) {
    require(size <= bytes_.size());
    const std::string_view part = bytes_.substr(0, size);
    bytes_.remove_prefix(size);
    return part;
  }
  bool at_end() const { return bytes_.empty(); }
  std::string_view rest() { return raw(bytes_.size()); }
  void require(bool holds) const {
    if (!holds) damaged_();
  }
  void end() const { require(bytes_.empty()); }

 private:
  std::string_view bytes_;
  std::function<void()> damaged_;
};

}  // namespace limber
