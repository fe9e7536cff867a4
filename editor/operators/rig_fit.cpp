// SPDX-License-Identifier: AGPL-3.0-or-later
// Skeletons that are laid into the volume.
#include "editor/icons.h"
#include "editor/operators/polls.h"
#include "editor/rig_fitting.h"

namespace limber::editor {

std::vector<Operator> rig_fit_operators() {
  return {
      {"rig.auto_fit", "Auto-fit skeleton...", kAutoFitIcon, "Rig", "Lays a skeleton into the volume by itself: joints are found from the bones or from the body's shape.", ask_auto_fit, needs_volume},
      {"rig.templates", "Templates...", icon::kRig, "Rig", "Places a ready skeleton, scaled to the tissue.", ask_template, needs_volume},
  };
}

}  // namespace limber::editor
