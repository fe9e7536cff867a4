// SPDX-License-Identifier: AGPL-3.0-or-later
// Makes a body ready to be drawn while a job still reads or computes it, so that the first frame that shows the body
// takes no longer than other frames. The job's thread does all work that needs no OpenGL. Each frame then uploads a
// part of the body, and the job ends when the upload is complete.
#pragma once

#include <chrono>
#include <condition_variable>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>

#include "core/base/progress.h"
#include "core/project/document.h"
#include "render/view.h"

namespace limber::editor {

struct Views;

// The queue of bodies to upload to OpenGL. The threads of jobs add bodies, and frames upload them.
class ArrivingBodies {
 public:
  // Waits in a job's thread until frames have uploaded the body. Returns early if no frame came for half a second, as
  // with a minimized window; the body is then uploaded when it is first drawn. Throws Cancelled.
  void await(const std::shared_ptr<render::PreparedBody>& body, Progress& progress);
  // Uploads in a frame, after Renderer::begin_frame(), as much as the frame's time limit allows. Returns true if bodies
  // are still waiting.
  bool upload(render::Renderer& renderer);
  bool has_frames() const;  // true if a frame came in the last half second

 private:
  bool has_frames_locked() const;

  mutable std::mutex mutex_;
  std::condition_variable uploaded_;
  std::deque<std::shared_ptr<render::PreparedBody>> waiting_;
  std::chrono::steady_clock::time_point last_frame_{};
};

// Returns a function that a job calls in its own thread with the document that will be shown when the job ends. The
// function makes the document's body ready to be drawn with the views' current display mode. If the window draws no
// frames, such as while it is minimized, the function does nothing.
//   grey  the grey image that will be shown with the body; empty: none
using MakeReady = std::function<void(const Document&, Progress&, const std::optional<render::ShownGrey>& grey)>;
MakeReady body_maker(const Views& views);

}  // namespace limber::editor
