// SPDX-License-Identifier: AGPL-3.0-or-later
// How a message's severity looks: always a shape and a colour.
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
