// SPDX-License-Identifier: AGPL-3.0-or-later
// Maps the progress of one cell to the interval [begin, end] of the progress of a whole study or batch.
#pragma once

#include <algorithm>
#include <string>

#include "core/base/progress.h"

namespace limber {

class PartOfProgress final : public Progress {
 public:
  PartOfProgress(Progress& whole, std::string name, double begin, double end)
      : whole_(whole),
        name_(std::move(name)),
        begin_(begin),
        end_(end) {}
  bool cancelled() const override { return whole_.cancelled() || Progress::cancelled(); }

 protected:
  void on_update(std::string_view stage, double fraction) override {
    whole_.update(name_ + ": " + std::string(stage), begin_ + (end_ - begin_) * std::clamp(fraction, 0.0, 1.0));
  }

 private:
  Progress& whole_;
  std::string name_;
  double begin_, end_;
};

}  // namespace limber
