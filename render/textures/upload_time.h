// SPDX-License-Identifier: AGPL-3.0-or-later
// The time limit for all uploads of a frame together. At least one lot (a group of slots, or of slices of an image) is
// uploaded, however long its upload takes.
#pragma once

#include <chrono>

namespace limber::render {

struct UploadTime {
  std::chrono::steady_clock::time_point until;
  bool used = false;  // true: a lot has been uploaded in this frame

  bool is_over() const { return used && std::chrono::steady_clock::now() >= until; }
};

}  // namespace limber::render
