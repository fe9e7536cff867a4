// SPDX-License-Identifier: AGPL-3.0-or-later
// Reports the progress of a long function and lets the user cancel the function. The function calls update() from its
// own thread several times a second, so that a cancel takes effect within 100 ms. Loops inside parallel_for may poll
// cancelled(), which any thread may call.
#pragma once

#include <atomic>
#include <string_view>

#include "core/base/error.h"

namespace limber {

class Progress {
 public:
  virtual ~Progress() = default;

  // Reports progress.
  //   stage     the present step of the work, in a word for the user ("weights")
  //   fraction  the completed share of that step, [0, 1]
  //   throws Cancelled when cancel() was called earlier
  void update(std::string_view stage, double fraction) {
    if (cancelled()) throw Cancelled();
    on_update(stage, fraction);
  }
  void cancel() { cancelled_ = true; }
  virtual bool cancelled() const { return cancelled_; }

 protected:
  virtual void on_update(std::string_view, double) {}

 private:
  std::atomic<bool> cancelled_ = false;
};

// Returns a Progress that ignores updates and is never cancelled.
Progress& no_progress();

}  // namespace limber
