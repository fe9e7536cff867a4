// SPDX-License-Identifier: AGPL-3.0-or-later
// Keeps strips together with the clips of the document that they play.
#pragma once

#include "core/project/document.h"

namespace limber {

// Makes the strips of `next` play its clips instead of those of `before`. A clip that is missing in `next` counts as
// edited if a clip there has its name, and as renamed if a new clip has its index. Otherwise it was deleted, and its
// strips are removed.
void relink_strips(const Document& before, Document& next);

// Lets the strips of `clip` play the same of `changed`, which is the clip with `ratio` frames in place of each one, as
// core/motion/clip_speed.h makes it. The playing ranges that were those of the strips stay so.
void follow_frames(Document& document, const std::shared_ptr<const Clip>& clip,
                   const std::shared_ptr<const Clip>& changed, double ratio);

// A clip of the document that has strips of another one.
struct StripUse {
  std::string clip;
  int strips = 0;
};
std::vector<StripUse> strip_uses(const Document& document, const std::shared_ptr<const Clip>& clip);

}  // namespace limber
