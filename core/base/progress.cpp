// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/base/progress.h"

namespace limber {

namespace {
struct Silent final : Progress {
  bool cancelled() const override { return false; }
};
}  // namespace

Progress& no_progress() {
  static Silent silent;
  return silent;
}

}  // namespace limber
