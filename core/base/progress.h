// SPDX-License-Identifier: AGPL-3.0-or-later
// How a long function tells how far it is and learns that it should stop.
// The function calls update() from its own thread a few times a second's worth of work (so that a cancel takes
// effect within 100 ms); loops inside parallel_for may poll cancelled(), which any thread may call.
#pragma once

#include <atomic>
#include <string_view>

#include "core/base/error.h"

namespace limber {

class Progress {
 public:
  virtual ~Progress() = default;

  // stage  what is being done, as a user would say it ("weights"); fraction of that stage in [0, 1]
  // throws Cancelled when cancel() was called before
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

// Listens to nothing and is never cancelled.
Progress& no_progress();

}  // namespace limber
