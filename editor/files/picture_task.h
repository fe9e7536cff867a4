// SPDX-License-Identifier: AGPL-3.0-or-later
// Draws pictures as fine as they are at rest, and hands them to a task that writes them. The editor's thread draws,
// because it owns the GL context, in small shares of each frame, so that the editor stays responsive. Another thread
// writes.
#pragma once

#include "editor/context/editor.h"

namespace limber::editor {

struct PictureTask {
  std::string label;    // of the job
  render::Scene scene;  // a copy, so that edits do not change the later pictures
  glm::ivec2 size{0};
  int pictures = 1;
  std::function<render::Camera(int picture)> camera;
  // Changes the scene for a picture, in the editor's thread. Called once per frame until it returns true: what it waits
  // for is then there. Empty: all pictures show the same scene.
  std::function<bool(int picture, render::Scene& scene)> prepare;
  // These functions run in the task's thread: `take` for each picture in order, then `finish`.
  std::function<void(int picture, const render::Image& image, Progress& progress)> take;
  std::function<Finish(Progress& progress)> finish;
};
void start_picture_task(Editor& editor, PictureTask task);

}  // namespace limber::editor
