// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/project/document.h"

namespace limber::editor {

struct ResultFacts;

// What tables show about a result (a resampled volume). The facts are computed once for each result.
struct KnownResult {
  std::weak_ptr<const Result> result;
  std::shared_ptr<const ResultFacts> facts;
};

struct ResultList {
  std::vector<KnownResult> known;
  struct {
    std::string result;  // the result whose name is being edited; "" for none
    std::string text;
    bool focused = false;
  } renaming;
};

}  // namespace limber::editor
