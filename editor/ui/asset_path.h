// SPDX-License-Identifier: AGPL-3.0-or-later
// Brings asset(), which finds the program's own files by name, into the editor's namespace.
#pragma once

#include "core/base/asset.h"

namespace limber::editor {

using limber::asset;

}  // namespace limber::editor
