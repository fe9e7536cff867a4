// SPDX-License-Identifier: AGPL-3.0-or-later
// Onion skin: draws ghosts of the body, which are its outlines at frames before and after the shown frame, over the 3D
// view. Earlier and later frames have different colours, and each further ghost is half as opaque. Only frames of the
// playing range have ghosts. A coarse surface of the body is computed once in the background, and outlines are cached
// while the view stands still. Until an outline is ready, and when the body has no weights, the skeleton is drawn
// instead.
#pragma once

#include <map>
#include <memory>
#include <vector>

#include "core/deform/skinned_surface.h"
#include "core/motion/clip.h"

namespace limber::editor {

struct Context;

struct OnionOutlines {
  std::shared_ptr<const LabelVolume> volume;  // the label volume from which `surface` is computed
  std::shared_ptr<const SkinWeights> weights;
  std::shared_ptr<const SkinnedSurface> surface;  // coarse surface of the body; null until it is computed

  // The inputs of the cached outlines. When one of these inputs changes, the outlines are discarded.
  struct Seen {
    std::vector<double> view;
    std::shared_ptr<const Clip> clip;
    std::shared_ptr<const Armature> armature;
    std::shared_ptr<const SkinnedSurface> surface;
    Blend blend = Blend::DualQuaternion;

    bool operator==(const Seen&) const = default;
  } seen;
  std::map<int, std::vector<std::vector<glm::vec2>>> lines;  // cached outlines by frame: closed lines, pixels
};

void draw_onion_skin(Context& context);

}  // namespace limber::editor
