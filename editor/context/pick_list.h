// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <optional>
#include <vector>

#include "core/volume/label_volume.h"

namespace limber::editor {

// A bone or a tissue under the pointer, which a click can select.
struct Pickable {
  std::optional<int> bone;  // index of the bone; no value: this is the tissue with the label `tissue`
  Label tissue = 0;

  bool operator==(const Pickable&) const = default;
};

// The list of bones and tissues under the pointer.
struct PickList {
  bool opens = false;          // true: the list opens in the next frame
  std::vector<Pickable> rows;  // the bones and tissues of the list, the nearest to the eye first
};

}  // namespace limber::editor
