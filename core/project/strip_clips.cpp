// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/project/strip_clips.h"

#include <algorithm>
#include <cmath>

#include "core/motion/strip_edits.h"

namespace limber {

namespace {

using SharedClip = std::shared_ptr<const Clip>;
using Clips = std::vector<SharedClip>;

bool has(const Clips& clips, const SharedClip& clip) {
  return std::find(clips.begin(), clips.end(), clip) != clips.end();
}

// Returns the clip of `after` that replaces the clip of `before`: the clip with the same name, or else a new clip at
// the same index. Returns null if the clip was deleted.
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

void follow_frames(Document& document, const SharedClip& clip, const SharedClip& changed, double ratio) {
  const auto frame_of = [&](int frame) {
    const double moved = clip->start + std::round((double(frame) - clip->start) * ratio);
    return static_cast<int>(std::clamp(moved, -double(kMostStripFrame), double(kMostStripFrame)));
  };
  for (SharedClip& part : document.clips) {
    if (!part->strips || !has(clips_of(*part->strips), clip)) continue;
    Clip next = *part;
    Strips strips = *part->strips;
    const auto before = span_of(strips, next.rate);
    for (StripTrack& track : strips.tracks)
      for (Strip& strip : track.strips) {
        if (strip.clip != clip) continue;
        strip = with_clip_frames(strip, frame_of, ratio);
        strip.clip = changed;
      }
    if (const auto after = span_of(strips, next.rate);
        after && next.range_start == before->first && next.range_end == before->last)
      next.range_start = after->first, next.range_end = after->last;
    next.strips = std::make_shared<const Strips>(std::move(strips));
    part = std::make_shared<const Clip>(std::move(next));
  }
}

std::vector<StripUse> strip_uses(const Document& document, const SharedClip& clip) {
  std::vector<StripUse> uses;
  for (const SharedClip& other : document.clips) {
    if (!other->strips) continue;
    StripUse use{other->name};
    for (const StripTrack& track : other->strips->tracks)
      use.strips += static_cast<int>(std::count_if(track.strips.begin(), track.strips.end(),
                                                   [&](const Strip& strip) { return strip.clip == clip; }));
    if (use.strips > 0) uses.push_back(std::move(use));
  }
  return uses;
}

}  // namespace limber
