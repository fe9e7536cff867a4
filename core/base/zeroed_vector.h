// SPDX-License-Identifier: AGPL-3.0-or-later
// A vector whose values start as zero and use no memory until they are written. A body's grid is mostly air: where the
// program only reads zeros, the system maps one shared page of zeros. std::vector cannot do this, because it writes
// every value that it creates; with a custom allocator it would still visit every value to destroy it. A
// ZeroedVector can also hold values in memory that another owner keeps, such as an array of another language, without
// copying them.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <initializer_list>
#include <iterator>
#include <limits>
#include <memory>
#include <new>
#include <type_traits>
#include <utility>

#include "core/platform/memory_pages.h"

namespace limber {

// A growing array of values of type T. The zero value of T must consist of zero bytes.
template <class T>
class ZeroedVector {
  static_assert(std::is_trivially_copyable_v<T> && std::is_trivially_destructible_v<T>);

 public:
  using value_type = T;
  using iterator = T*;
  using const_iterator = const T*;

  ZeroedVector() = default;
  explicit ZeroedVector(std::size_t count) { resize(count); }
  ZeroedVector(std::size_t count, const T& value) { assign(count, value); }
  ZeroedVector(std::initializer_list<T> values) { assign(values.begin(), values.end()); }
  // Holds values that lie in the memory of `owner`, which this vector keeps alive. Nothing is copied.
  static ZeroedVector of_owner(T* values, std::size_t count, std::shared_ptr<const void> owner) {
    ZeroedVector held;
    held.values_ = std::unique_ptr<T[], Delete>(values, Delete{0, std::move(owner)});
    held.size_ = held.capacity_ = count;
    return held;
  }
  // Copies only memory pages that are not all zero, so that the copy uses no more memory than the original.
  ZeroedVector(const ZeroedVector& other) {
    constexpr std::size_t kPage = 4096 / sizeof(T);
    resize(other.size());
    for (std::size_t at = 0; at < size_; at += kPage) {
      const std::size_t bytes = std::min(kPage, size_ - at) * sizeof(T);
      if (!is_all_zero(&other[at], bytes)) std::memcpy(static_cast<void*>(data() + at), &other[at], bytes);
    }
  }
  ZeroedVector(ZeroedVector&& other) noexcept { swap(other); }
  ZeroedVector& operator=(ZeroedVector other) noexcept {
    swap(other);
    return *this;
  }

  std::size_t size() const { return size_; }
  std::size_t capacity() const { return capacity_; }
  bool empty() const { return size_ == 0; }
  T* data() { return values_.get(); }
  const T* data() const { return values_.get(); }
  T* begin() { return data(); }
  T* end() { return data() + size_; }
  const T* begin() const { return data(); }
  const T* end() const { return data() + size_; }
  T& operator[](std::size_t at) { return data()[at]; }
  const T& operator[](std::size_t at) const { return data()[at]; }

  // Changes the number of values; new values are zero.
  void resize(std::size_t count) {
    if (count > capacity_) grow(count);
    else if (count > size_)
      // This memory may still contain values of an earlier, larger size.
      std::memset(static_cast<void*>(end()), 0, (count - size_) * sizeof(T));
    size_ = count;
  }
  void assign(std::size_t count, const T& value) {
    resize(count);
    std::fill_n(data(), count, value);
  }
  template <std::input_iterator Iterator>
  void assign(Iterator first, Iterator last) {
    resize(static_cast<std::size_t>(std::distance(first, last)));
    std::copy(first, last, data());
  }
  void push_back(T value) {
    if (size_ == capacity_) grow(std::max<std::size_t>(16, 2 * capacity_));
    data()[size_++] = value;
  }
  void clear() { size_ = 0; }
  void swap(ZeroedVector& other) noexcept {
    std::swap(values_, other.values_);
    std::swap(size_, other.size_);
    std::swap(capacity_, other.capacity_);
  }

  friend bool operator==(const ZeroedVector& a, const ZeroedVector& b) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end());
  }

 private:
  struct Delete {
    std::size_t bytes = 0;
    std::shared_ptr<const void> owner{};  // keeps the memory of the values alive; null: this vector owns it
    void operator()(T* values) const {
      if (!owner) delete_zeros(values, bytes);
    }
  };

  void grow(std::size_t capacity) {
    if (capacity > std::numeric_limits<std::ptrdiff_t>::max() / sizeof(T)) throw std::bad_alloc();
    const std::size_t bytes = capacity * sizeof(T);
    std::unique_ptr<T[], Delete> grown(static_cast<T*>(new_zeros(bytes)), Delete{bytes});
    if (!grown) throw std::bad_alloc();
    if (size_) std::memcpy(static_cast<void*>(grown.get()), data(), size_ * sizeof(T));
    values_ = std::move(grown);
    capacity_ = capacity;
  }

  std::unique_ptr<T[], Delete> values_;
  std::size_t size_ = 0, capacity_ = 0;
};

}  // namespace limber
