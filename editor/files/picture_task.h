// SPDX-License-Identifier: AGPL-3.0-or-later
// Draws pictures at full quality and passes them to a task that writes them. The editor's thread draws, because it
// owns the OpenGL context. It draws a small part in each frame, so that the editor stays responsive. Another thread
// writes the files.
#pragma once

#include "editor/context/background_task.h"
#include "render/image_io.h"
#include "render/scene/camera.h"
#include "render/scene/scene.h"

namespace limber::editor {

struct Context;

struct PictureTask {
  std::string label;    // label of the job
  render::Scene scene;  // a copy, so that edits do not change the later pictures
  glm::ivec2 size{0};
  int pictures = 1;
  std::function<render::Camera(int picture)> camera;
  // Prepares the scene for a picture. It is called in the editor's thread once per frame until it returns true, which
  // means that the scene is ready. Empty: all pictures show the same scene.
  std::function<bool(int picture, render::Scene& scene)> prepare;
  // `take` and `finish` run in the task's thread: `take` for each picture in order, then `finish` once.
  std::function<void(int picture, const render::Image& image, Progress& progress)> take;
  std::function<Finish(Progress& progress)> finish;
};
void start_picture_task(Context& context, PictureTask task);

}  // namespace limber::editor
