// SPDX-License-Identifier: AGPL-3.0-or-later
// Makes and stores small pictures of projects and volumes for the start screen. A project's picture is stored in the
// project's file, a volume's picture in the cache folder.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>

#include "editor/context/editor.h"

namespace limber::editor {

inline constexpr glm::ivec2 kThumbnailSize{240, 160};  // pixels

// Renders the body as the 3D view shows it now. Returns the picture as the bytes of a PNG file; "" without a volume.
std::string thumbnail_png(Editor& editor);
// Stores the current picture in the cache folder for the volume file at `path`, which cannot hold a picture itself.
// Failures are ignored.
void keep_thumbnail(Editor& editor, const Path& path);
// Returns the path in the cache folder of the picture of the file at `path`. The picture's name changes whenever the
// file changes.
Path cached_thumbnail(const Path& cache, const Path& path);

// Starts a background task that finds out which recent files still exist, reads their pictures, and sets
// Editor::recent_facts.
void look_at_recents(Editor& editor);

}  // namespace limber::editor
