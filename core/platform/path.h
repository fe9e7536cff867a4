// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>

namespace limber {

using Path = std::filesystem::path;

}  // namespace limber
