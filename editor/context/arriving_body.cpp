// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/context/arriving_body.h"

#include <algorithm>

#include "core/base/error.h"
#include "editor/context/views.h"
#include "render/scene/tissue_appearance.h"

namespace limber::editor {

namespace {
constexpr std::chrono::milliseconds kLongestPause{500}, kTurn{20};
}  // namespace

bool ArrivingBodies::has_frames_locked() const {
  return std::chrono::steady_clock::now() - last_frame_ < kLongestPause;
}
bool ArrivingBodies::has_frames() const {
  const std::lock_guard lock(mutex_);
  return has_frames_locked();
}

void ArrivingBodies::await(const std::shared_ptr<render::PreparedBody>& body, Progress& progress) {
  const auto is_waiting = [&] { return std::find(waiting_.begin(), waiting_.end(), body) != waiting_.end(); };
  std::unique_lock lock(mutex_);
  waiting_.push_back(body);
  try {
    while (is_waiting() && has_frames_locked()) {
      lock.unlock();
      progress.update("picture", 1);  // wakes the editor, so that it draws a frame
      lock.lock();
      uploaded_.wait_for(lock, kTurn, [&] { return !is_waiting(); });
    }
  } catch (const Cancelled&) {
    lock.lock();
    std::erase(waiting_, body);
    throw;
  }
  std::erase(waiting_, body);
}

bool ArrivingBodies::upload(render::Renderer& renderer) {
  std::unique_lock lock(mutex_);
  last_frame_ = std::chrono::steady_clock::now();
  if (waiting_.empty()) return false;
  const std::shared_ptr<render::PreparedBody> body = waiting_.front();
  lock.unlock();
  bool is_done = true;
  try {
    is_done = renderer.upload(*body);
  } catch (const Error&) {  // ignored: the views retry at a coarser resolution when they draw the body
  }
  lock.lock();
  if (is_done) std::erase(waiting_, body);
  uploaded_.notify_all();
  return !waiting_.empty();
}

MakeReady body_maker(const Views& views) {
  return [arriving = views.arriving, display = views.display, limits = views.renderer.limits()](
             const Document& document, Progress& progress, const std::optional<render::ShownGrey>& grey) {
    if (!document.volume || !arriving->has_frames()) return;
    const render::LabelLooks looks =
        document.tissues
            ? render::looks_of(*document.tissues, document.visibility ? *document.visibility : Visibility{})
            : render::LabelLooks{};
    const render::Display shown = display == render::Display::Image ? render::Display::Solid : display;
    try {
      arriving->await(render::prepared_body(document.volume, looks, shown, limits, progress, grey), progress);
    } catch (const Error&) {  // ignored: the views meet the same error when they draw the body
    }
  };
}

}  // namespace limber::editor
