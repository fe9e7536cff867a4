// SPDX-License-Identifier: AGPL-3.0-or-later
// Makes a body ready to be drawn while a job still reads or computes it, so that the frame that shows it first takes no
// longer than others. The job's thread computes everything that needs no OpenGL; the frames then upload it bit by bit,
// and the job ends when they are done.
#pragma once

#include <chrono>
#include <condition_variable>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>

#include "core/base/progress.h"
#include "core/project/document.h"
#include "render/view.h"

namespace limber::editor {

struct Views;

// The bodies that jobs want to be uploaded. Jobs and frames share it.
class ArrivingBodies {
 public:
  // Waits in a job's thread until frames have uploaded the body. Returns early if no frame came for half a second, as
  // with a minimized window; the body is then uploaded when it is first drawn. Throws Cancelled.
  void await(const std::shared_ptr<render::PreparedBody>& body, Progress& progress);
  // Uploads in a frame, after Renderer::begin_frame(), as much as the frame's time limit allows. Returns true if bodies
  // are still waiting.
  bool upload(render::Renderer& renderer);
  bool has_frames() const;  // whether a frame came in the last half second

 private:
  bool has_frames_locked() const;

  mutable std::mutex mutex_;
  std::condition_variable uploaded_;
  std::deque<std::shared_ptr<render::PreparedBody>> waiting_;
  std::chrono::steady_clock::time_point last_frame_{};
};

// Returns a function that a job calls in its own thread with the document that will be shown when the job ends. It
// makes the document's body ready to be drawn as the views show bodies now. Where no frames are drawn, it does nothing.
using MakeReady = std::function<void(const Document&, Progress&)>;
MakeReady body_maker(const Views& views);

}  // namespace limber::editor
