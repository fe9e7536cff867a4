// SPDX-License-Identifier: AGPL-3.0-or-later
// Writes the pictures of a task as numbered files or as a video. Also exports the playing motion as pictures or video.
#pragma once

#include "editor/files/picture_task.h"

namespace limber::editor {

// Returns the size of an exported picture of a view, pixels.
glm::ivec2 size_of_view(const Editor& editor, ViewId id);

// Calls `begin` if no file of these names exists, or once the user has agreed to replace the files. Throws Error if a
// video is wanted but ffmpeg is not installed, or if no file can be written at `path`.
void agree_on_pictures(Editor& editor, const Path& path, int pictures, std::function<void(Editor&)> begin);
// Starts the task. It writes NAME-0000.png, NAME-0001.png and so on, or a video if the name ends in .mp4 or .webm.
// Sets `take` and `finish` of the task itself.
void start_picture_files(Editor& editor, const Path& path, PictureTask task);

// Returns why the playing range of the clip cannot be exported as pictures; "" when it can.
std::string why_no_motion_pictures(const Editor& editor);
// Writes the playing range of the shown clip, posed as in the live preview and seen by the 3D view's camera. Writes
// one picture for each frame, or a video at the clip's speed.
enum class MotionCamera { Still, FollowsBody };
void export_motion_pictures(Editor& editor, const Path& path, MotionCamera camera = MotionCamera::Still);
// Asks whether the camera stands still or follows the body, and then exports.
void ask_motion_pictures(Editor& editor, const Path& path);

}  // namespace limber::editor
