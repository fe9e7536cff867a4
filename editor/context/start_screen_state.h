// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <map>
#include <memory>

#include "core/base/file.h"
#include "render/image_io.h"

namespace limber::editor {

// What the start screen shows about a recent file: a small picture of it, and whether the file is missing.
struct RecentFacts {
  bool missing = false;
  std::shared_ptr<const render::Image> picture;
};

struct StartScreen {
  bool shown = false;
  int row = 0;  // index of the recent file that is selected
  std::map<Path, RecentFacts> facts;
};

}  // namespace limber::editor
