// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <memory>
#include <string>

#include "core/project/document.h"

namespace limber::editor {

struct ResultFacts;

// What is known of a result, read once for each.
struct KnownResult {
  std::weak_ptr<const Result> result;
  std::shared_ptr<const ResultFacts> facts;
};

// What the views show in place of the volume at rest, and what that is compared with. Names of results; one that is
// empty or unknown is the volume at rest.
struct Comparison {
  std::string a, b;
  bool shows_a = false;  // else b
  enum class Views {
    One,         // a or b
    Wipe,        // a left of a line that is dragged, b right of it, in one picture
    SideBySide,  // each view twice, a left and b right, with one camera
  } views = Views::One;
  float share = 0.5f;  // of the view that a takes
};

}  // namespace limber::editor
