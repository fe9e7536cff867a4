// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/files/picture_task.h"

#include <condition_variable>
#include <mutex>

namespace limber::editor {

namespace {

// Passes pictures from the editor's thread to the task.
struct Board {
  std::mutex mutex;
  std::condition_variable changed;
  std::optional<render::Image> picture;
  bool over = false;  // the task has ended, or was cancelled
};

// Waits for the next picture.
render::Image next_picture(Board& board, int number, int count, Progress& progress) {
  for (;;) {
    progress.update("pictures", static_cast<double>(number) / count);
    std::unique_lock lock(board.mutex);
    if (!board.changed.wait_for(lock, std::chrono::milliseconds(50), [&] { return board.picture.has_value(); }))
      continue;
    render::Image image = std::move(*board.picture);
    board.picture.reset();
    return image;
  }
}

// The picture that the editor draws, a share in each frame.
struct Drawing {
  std::unique_ptr<render::View3D> view;
  int picture = 0;
  double time = 0;
};

// Draws a share of the task's next picture. Returns true when the picture is complete.
bool draw_share(Drawing& drawing, const PictureTask& task) {
  drawing.view->draw(task.scene, task.camera(drawing.picture), task.size, drawing.time += 1);
  if (!drawing.view->complete()) return false;
  if (drawing.view->scale() > 1)  // nothing is averaged at rest, so the picture has stayed coarse
    drawing.view->draw(task.scene, task.camera(drawing.picture), task.size, drawing.time, 1);
  return true;
}

}  // namespace

void start_picture_task(Editor& editor, PictureTask wanted) {
  auto task = std::make_shared<const PictureTask>(std::move(wanted));
  auto board = std::make_shared<Board>();
  start_task(editor, task->label, [task, board](Progress& progress) -> Finish {
    struct Over {
      Board& board;
      ~Over() {
        const std::lock_guard lock(board.mutex);
        board.over = true;
      }
    } over{*board};
    for (int i = 0; i < task->pictures; ++i) task->take(i, next_picture(*board, i, task->pictures, progress), progress);
    return task->finish(progress);
  });

  auto drawing = std::make_shared<Drawing>();
  drawing->view = std::make_unique<render::View3D>(editor.views->renderer);
  editor.each_frame.push_back([board, task, drawing](Editor& e) {
    {
      const std::lock_guard lock(board->mutex);
      if (board->over || drawing->picture >= task->pictures) return false;
      e.touch();
      if (board->picture) return true;
    }
    if (!draw_share(*drawing, *task)) return true;
    const std::lock_guard lock(board->mutex);
    board->picture = drawing->view->read();
    ++drawing->picture;
    board->changed.notify_all();
    return true;
  });
}

}  // namespace limber::editor
