// SPDX-License-Identifier: AGPL-3.0-or-later
// Gives each severity of a message an icon and a colour. Colour alone is not enough, since some users cannot tell
// colours apart.
#pragma once

#include "editor/ui/messages.h"
#include "editor/ui/theme.h"

namespace limber::editor {

struct Sign {
  const char* icon;
  Colour colour;
};
Sign sign_of(const Theme& theme, Severity severity);

}  // namespace limber::editor
