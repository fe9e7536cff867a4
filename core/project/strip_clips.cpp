// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/project/strip_clips.h"

#include <algorithm>

#include "core/motion/strips.h"

namespace limber {

namespace {

using SharedClip = std::shared_ptr<const Clip>;
using Clips = std::vector<SharedClip>;

bool has(const Clips& clips, const SharedClip& clip) {
  return std::find(clips.begin(), clips.end(), clip) != clips.end();
}

// Returns what became of a clip that `after` does not have; null: it was deleted.
SharedClip successor(const SharedClip& clip, const Clips& before, const Clips& after) {
  const auto named =
      std::find_if(after.begin(), after.end(), [&](const SharedClip& other) { return other->name == clip->name; });
  if (named != after.end()) return *named;
  const auto index = static_cast<std::size_t>(std::find(before.begin(), before.end(), clip) - before.begin());
  return before.size() == after.size() && !has(before, after[index]) ? after[index] : nullptr;
}

}  // namespace

void relink_strips(const Document& before, Document& next) {
  if (before.clips == next.clips) return;
  const Clips after = next.clips;
  for (SharedClip& part : next.clips) {
    if (!part->strips) continue;
    Strips strips = *part->strips;
    for (StripTrack& track : strips.tracks) {
      for (Strip& strip : track.strips)
        if (!has(after, strip.clip) && has(before.clips, strip.clip))
          strip.clip = successor(strip.clip, before.clips, after);
      std::erase_if(track.strips, [](const Strip& strip) { return !strip.clip || strip.clip->strips; });
    }
    if (strips == *part->strips) continue;
    Clip clip = *part;
    clip.strips = std::make_shared<const Strips>(std::move(strips));
    part = std::make_shared<const Clip>(std::move(clip));
  }
}

std::optional<std::string> clip_with_strips_of(const Document& document, const SharedClip& clip) {
  for (const SharedClip& other : document.clips)
    if (other->strips && has(clips_of(*other->strips), clip)) return other->name;
  return std::nullopt;
}

}  // namespace limber
