// SPDX-License-Identifier: AGPL-3.0-or-later
// Writes the pictures of a task as numbered files or as a video, and the motion that plays as such.
#pragma once

#include "editor/files/picture_task.h"

namespace limber::editor {

// The size with which pictures of a view are exported.
glm::ivec2 size_of_view(const Editor& editor, ViewId id);

// Begins once the user agrees that pictures of these names are replaced, which is asked only if some exist. Throws
// Error when a video needs ffmpeg and that is not installed, or when no file can be written at `path`.
void agree_on_pictures(Editor& editor, const Path& path, int pictures, std::function<void(Editor&)> begin);
// Starts the task, which writes NAME-0000.png, NAME-0001.png and so on, or a video when the name ends in .mp4 or .webm.
// `take` and `finish` of the task are set here.
void start_picture_files(Editor& editor, const Path& path, PictureTask task);

// Returns why the motion that plays cannot be exported as pictures; "" when it can.
std::string why_no_motion_pictures(const Editor& editor);
// Writes the frames of the shown clip that play, posed as in the live preview, from where the 3D view looks: every
// frame as a picture, or a video at the clip's speed.
enum class MotionCamera { Still, FollowsBody };
void export_motion_pictures(Editor& editor, const Path& path, MotionCamera camera = MotionCamera::Still);
// Asks whether the camera stands still or follows the body, and then exports.
void ask_motion_pictures(Editor& editor, const Path& path);

}  // namespace limber::editor
