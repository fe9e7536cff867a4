// SPDX-License-Identifier: AGPL-3.0-or-later
// Ghosts at frames before and after the one that is shown: outlines of the posed body over the 3D view, past ones in
// one colour, coming ones in another, each further one half as strong. Only frames of the range that plays. The body's
// surface is taken once in the background, coarse; each frame's outline is kept while the view stands still. Until an
// outline is there, and where no weights say how the body follows, the skeleton stands for it.
#pragma once

#include <map>
#include <memory>
#include <vector>

#include "core/deform/skinned_surface.h"
#include "editor/context/editor.h"

namespace limber::editor {

struct OnionOutlines {
  std::shared_ptr<const LabelVolume> volume;  // of which the surface is, or is being made
  std::shared_ptr<const SkinWeights> weights;
  std::shared_ptr<const SkinnedSurface> surface;  // null until it is made

  // What the lines are seen from and of; another one makes them anew.
  struct Seen {
    std::vector<double> view;
    std::shared_ptr<const Clip> clip;
    std::shared_ptr<const Armature> armature;
    std::shared_ptr<const SkinnedSurface> surface;
    Blend blend = Blend::DualQuaternion;

    bool operator==(const Seen&) const = default;
  } seen;
  std::map<int, std::vector<std::vector<glm::vec2>>> lines;  // by frame, pixels
};

void draw_onion_skin(Editor& editor);

}  // namespace limber::editor
