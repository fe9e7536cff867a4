// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

namespace limber::editor {

// A reference to a part of the editor's state. The owner of the reference may set it later by refer_to(). Through a
// constant Context, the part can only be read. T may be an incomplete type; only code that uses the part includes its
// header.
template <class T>
class ContextPart {
 public:
  ContextPart() = default;
  ContextPart(const ContextPart&) = delete;
  ContextPart& operator=(const ContextPart&) = delete;

  void refer_to(T* part) { part_ = part; }  // null: there is no such part now

  explicit operator bool() const { return part_ != nullptr; }
  T* operator->() { return part_; }
  const T* operator->() const { return part_; }
  T& operator*() { return *part_; }
  const T& operator*() const { return *part_; }
  // Converts to T&, so that for example `context.ui` can be passed to a function that takes a Ui&.
  operator T&() { return *part_; }
  operator const T&() const { return *part_; }

 private:
  T* part_ = nullptr;
};

}  // namespace limber::editor
