// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "editor/ui/rect.h"

namespace limber::editor {

enum class ViewId { Body, Axial, Coronal, Sagittal };

struct ViewPlace {
  ViewId id;
  Rect rect;
  bool side_a = false;  // true for the left one of two views side by side, which shows result A
};

}  // namespace limber::editor
