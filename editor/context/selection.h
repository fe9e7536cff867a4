// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <optional>
#include <set>

#include "core/volume/label_volume.h"

namespace limber::editor {

// The selected tissues and bones. They are not part of the document, so selecting is no edit.
struct Selection {
  std::optional<Label> tissue;  // the active tissue
  std::set<Label> tissues;      // all selected tissues, including the active one
  std::optional<int> bone;
  std::set<int> bones;
};

}  // namespace limber::editor
