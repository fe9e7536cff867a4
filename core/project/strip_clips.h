// SPDX-License-Identifier: AGPL-3.0-or-later
// Keeps the strips of a document up to date when the clips that they play are edited, renamed or deleted.
#pragma once

#include "core/project/document.h"

namespace limber {

// Makes the strips of `next` play its clips instead of those of `before`. A clip that is missing in `next` counts as
// edited if a clip there has its name, and as renamed if a new clip has its index. Otherwise it was deleted, and its
// strips are removed.
void relink_strips(const Document& before, Document& next);

// Makes all strips that play `clip` play `changed` instead. `changed` is the same motion at another speed
// (core/motion/clip_speed.h): each frame of `clip` becomes `ratio` frames of `changed`. The frame numbers in the strips
// are scaled accordingly, so that the strips play the same part of the motion. If the frame range of the clip that
// contains the strips was exactly the range that its strips cover, the clip gets their new range.
void follow_frames(Document& document, const std::shared_ptr<const Clip>& clip,
                   const std::shared_ptr<const Clip>& changed, double ratio);

// The name of a clip some of whose strips play a given other clip, and the number of these strips.
struct StripUse {
  std::string clip;
  int strips = 0;
};
std::vector<StripUse> strip_uses(const Document& document, const std::shared_ptr<const Clip>& clip);

}  // namespace limber
