// SPDX-License-Identifier: AGPL-3.0-or-later
// The program's own files, by name.
#pragma once

#include "core/base/asset.h"

namespace limber::editor {

using limber::asset;

}  // namespace limber::editor
