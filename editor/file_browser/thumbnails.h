// SPDX-License-Identifier: AGPL-3.0-or-later
// Small pictures of projects and volumes for the start screen: drawn by the renderer itself, kept in the project's
// file, or in the cache for volumes.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>

#include "editor/context/editor.h"

namespace limber::editor {

inline constexpr glm::ivec2 kThumbnailSize{240, 160};  // pixels

// The body as the 3D view shows it now, as a PNG; "" without a volume.
std::string thumbnail_png(Editor& editor);
// Keeps it in the cache for the file at `path`, which has no place for a picture of its own. Failures do not matter.
void keep_thumbnail(Editor& editor, const Path& path);
// Where it is kept: the name changes with the file.
Path cached_thumbnail(const Path& cache, const Path& path);

// Finds out, beside the editor, which recent files are still there, and their pictures: into Editor::recent_facts.
void look_at_recents(Editor& editor);

}  // namespace limber::editor
