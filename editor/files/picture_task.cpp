// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/files/picture_task.h"

#include <chrono>
#include <condition_variable>
#include <exception>
#include <mutex>

#include "editor/context/context.h"
#include "editor/context/views.h"
#include "editor/ui/ui.h"

namespace limber::editor {

namespace {

// Passes one picture at a time from the editor's thread, which draws, to the task's thread.
struct Board {
  std::mutex mutex;
  std::condition_variable changed;
  std::optional<render::Image> picture;
  std::exception_ptr failure;  // the exception that stopped drawing; null: nothing stopped it
};

// Waits in the task's thread for the next picture. If drawing threw an exception, throws it again.
render::Image next_picture(Board& board, int number, int count, Progress& progress) {
  for (;;) {
    progress.update("pictures", static_cast<double>(number) / count);
    std::unique_lock lock(board.mutex);
    if (!board.changed.wait_for(lock, std::chrono::milliseconds(50),
                                [&] { return board.picture.has_value() || board.failure; }))
      continue;
    if (!board.picture) std::rethrow_exception(board.failure);
    render::Image image = std::move(*board.picture);
    board.picture.reset();
    return image;
  }
}

// The picture that is being drawn; each frame of the editor draws a part of it.
struct Drawing {
  std::unique_ptr<render::View3D> view;
  render::Scene scene;
  int picture = 0;
  bool prepared = false;  // true: the scene is ready for this picture
  bool drawn = false;     // true: the picture is complete, but the task has not taken the previous picture yet
  double time = 0;
};

// Draws a part of the task's next picture. Returns true when the picture is complete.
bool draw_share(Drawing& drawing, const PictureTask& task) {
  drawing.view->draw(drawing.scene, task.camera(drawing.picture), task.size, drawing.time += 1);
  if (!drawing.view->complete()) return false;
  if (drawing.view->scale() > 1)  // the view was not refined to full resolution, so draw it once more at scale 1
    drawing.view->draw(drawing.scene, task.camera(drawing.picture), task.size, drawing.time, 1);
  return true;
}

// Draws a part of the next picture, or passes the complete picture to the task. Returns false after the last picture.
bool draw_next(Ui& ui, Drawing& drawing, const PictureTask& task, Board& board) {
  const auto taken = [&] {
    const std::lock_guard lock(board.mutex);
    return !board.picture;
  };
  if (drawing.drawn && !taken()) return true;  // wait: the task's progress update will wake the editor again
  // While the scene is not ready, draw nothing; the task's progress update wakes the editor again.
  if (task.prepare && !drawing.prepared) drawing.prepared = task.prepare(drawing.picture, drawing.scene);
  if (task.prepare && !drawing.prepared) return true;
  ui.touch();
  if (!drawing.drawn) drawing.drawn = draw_share(drawing, task);
  if (!drawing.drawn || !taken()) return true;
  render::Image image = drawing.view->read();
  const std::lock_guard lock(board.mutex);
  board.picture = std::move(image);
  board.changed.notify_all();
  drawing.drawn = drawing.prepared = false;
  return ++drawing.picture < task.pictures;
}

}  // namespace

void start_picture_task(Context& context, PictureTask wanted) {
  auto task = std::make_shared<const PictureTask>(std::move(wanted));
  auto board = std::make_shared<Board>();
  auto drawing = std::make_shared<Drawing>();
  drawing->view = std::make_unique<render::View3D>(context.views->renderer);
  drawing->scene = task->scene;
  const int id = start_task(context, task->label, [task, board](Progress& progress) -> Finish {
    for (int i = 0; i < task->pictures; ++i) task->take(i, next_picture(*board, i, task->pictures, progress), progress);
    return task->finish(progress);
  });
  context.background->each_frame.push_back([id, board, task, drawing](Context& c) {
    if (!c.background->tasks.contains(id)) return false;  // the job has ended, possibly before its first picture
    try {
      return draw_next(c.ui, *drawing, *task, *board);
    } catch (...) {  // passed to the job's thread, which throws it again and so fails
      const std::lock_guard lock(board->mutex);
      board->failure = std::current_exception();
      board->changed.notify_all();
      return false;
    }
  });
}

}  // namespace limber::editor
