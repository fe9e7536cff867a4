// SPDX-License-Identifier: AGPL-3.0-or-later
// The time limit for all uploads of a frame together. Data are uploaded in lots (groups of slots, or of slices of an
// image). Each frame uploads at least one lot, however long this takes.
#pragma once

#include <chrono>

namespace limber::render {

struct UploadTime {
  std::chrono::steady_clock::time_point until;
  bool used = false;  // true: a lot has been uploaded in this frame

  bool is_over() const { return used && std::chrono::steady_clock::now() >= until; }
};

}  // namespace limber::render
