// SPDX-License-Identifier: AGPL-3.0-or-later
// Checks that many operators share. Each function returns the reason why an operator cannot run now, or "" if it can.
#pragma once

#include <string>

namespace limber::editor {

struct Context;

std::string needs_volume(const Context& context);
std::string needs_tissue(const Context& context);
std::string needs_bone(const Context& context);

}  // namespace limber::editor
