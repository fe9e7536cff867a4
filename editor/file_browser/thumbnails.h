// SPDX-License-Identifier: AGPL-3.0-or-later
// Makes and stores small pictures of projects and volumes for the start screen. A project's picture is stored in the
// project's file, a volume's picture in the cache folder.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>

#include <glm/glm.hpp>

#include "core/platform/path.h"

namespace limber::editor {

struct Context;

inline constexpr glm::ivec2 kThumbnailSize{240, 160};  // size of the small pictures, pixels

// Renders the body as the 3D view shows it now. Returns the picture as the bytes of a PNG file; "" without a volume.
std::string thumbnail_png(Context& context);
// Renders the body in the next frames and stores the picture in the cache folder, as the picture of the volume file at
// `path`. (A project file contains its own picture.) Failures are ignored.
void keep_thumbnail(Context& context, const Path& path);
// Returns the path of a picture in the cache folder: the picture of the volume file at `path`. The path depends on the
// time of the file's last change, so that no outdated picture is found.
Path cached_thumbnail(const Path& cache, const Path& path);

// Starts a background task that checks which recent files still exist, and reads their pictures. Its result is stored
// in StartScreen::facts.
void look_at_recents(Context& context);

}  // namespace limber::editor
