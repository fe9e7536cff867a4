// SPDX-License-Identifier: AGPL-3.0-or-later
// Writes the pictures of a task as numbered files or as a video. Also exports the playing motion as pictures or video.
#pragma once

#include <functional>
#include <string>

#include "core/platform/path.h"
#include "editor/context/view_place.h"
#include "editor/files/picture_task.h"

namespace limber::editor {

struct Context;
struct Screen;

// Returns the size of an exported picture of a view, pixels.
glm::ivec2 size_of_view(const Screen& screen, ViewId id);

// Calls `begin` once the user has agreed to replace the files that already exist among those to be written. If there
// are none, calls `begin` at once. Throws Error if a video is wanted but ffmpeg is not installed, or if no file can be
// written at `path`.
void agree_on_pictures(Context& context, const Path& path, int pictures, std::function<void(Context&)> begin);
// Starts the task that draws the pictures and writes them as NAME-0000.png, NAME-0001.png and so on, or as a video if
// the name ends in .mp4 or .webm. The caller leaves `take` and `finish` of the task empty; this function sets them.
void start_picture_files(Context& context, const Path& path, PictureTask task);

// Returns why the playing range of the clip cannot be exported as pictures; "" when it can.
std::string why_no_motion_pictures(const Context& context);
// The camera of the pictures of a motion. export_motion_pictures() writes the playing range of the shown clip, posed as
// in the live preview: one picture for each frame, or a video at the clip's speed.
enum class MotionCamera { Still, FollowsBody };
void export_motion_pictures(Context& context, const Path& path, MotionCamera camera = MotionCamera::Still);
// Asks whether the camera stands still or follows the body, and then exports.
void ask_motion_pictures(Context& context, const Path& path);

}  // namespace limber::editor
