// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/project/strips_codec.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "core/motion/clip.h"
#include "core/motion/clip_speed.h"

namespace limber {

namespace {

constexpr std::size_t kFewestOfTrack = 10;  // size of a stored track with an empty name and no strips, bytes
// Size of a stored strip with an empty name, bytes.
constexpr std::size_t kFewestOfStrip = 4 + 4 + 12 + 24 + 5 + 1 + 8 + 8 + 1 + 56;

void put(ByteWriter& out, const Strip& strip, std::size_t clip) {
  out.text(strip.name);
  out.count(clip);
  for (const int number : {strip.start, strip.first, strip.last}) out.put(static_cast<std::int32_t>(number));
  for (const double number : {strip.skip, strip.speed, strip.repeat}) out.put(number);
  for (const bool flag : {strip.reversed, strip.mirrored, strip.goes_on, strip.holds, strip.muted}) out.flag(flag);
  out.put(static_cast<std::uint8_t>(strip.blend));
  out.put(strip.influence);
  for (const int number : {strip.blend_in, strip.blend_out}) out.put(static_cast<std::int32_t>(number));
  out.flag(strip.bones.has_value());
  if (strip.bones) {
    out.count(strip.bones->size());
    for (const std::string& bone : *strip.bones) out.text(bone);
  }
  out.put(strip.place.turn);
  for (const glm::dvec3& v : {strip.place.from, strip.place.to})
    for (int i = 0; i < 3; ++i) out.put(v[i]);
}

double get_between(ByteReader& in, double low, double high) {
  const auto value = in.get<double>();
  in.require(value >= low && value <= high);
  return value;
}
int get_frame(ByteReader& in) {
  const auto frame = in.get<std::int32_t>();
  in.require(std::abs(std::int64_t{frame}) <= kMostStripFrame);
  return frame;
}

Strip get_strip(ByteReader& in, const std::vector<std::shared_ptr<const Clip>>& clips) {
  Strip strip;
  strip.name = in.text();
  strip.clip = clips[in.get_below<std::uint32_t>(clips.size())];
  for (int* number : {&strip.start, &strip.first, &strip.last}) *number = get_frame(in);
  in.require(strip.first <= strip.last);
  strip.skip = get_between(in, 0, kMostRepeats * 2 * double(kMostStripFrame));
  strip.speed = get_between(in, kSlowest, kFastest);
  strip.repeat = get_between(in, 0, kMostRepeats);
  in.require(begins_within(strip));
  for (bool* flag : {&strip.reversed, &strip.mirrored, &strip.goes_on, &strip.holds, &strip.muted}) *flag = in.flag();
  strip.blend =
      static_cast<StripBlend>(in.get_below<std::uint8_t>(static_cast<std::uint64_t>(StripBlend::AddChange) + 1));
  strip.influence = get_between(in, 0, 1);
  for (int* number : {&strip.blend_in, &strip.blend_out})
    *number = static_cast<int>(in.get_below<std::uint32_t>(kLongestBlend + 1));
  if (in.flag()) {
    strip.bones.emplace();
    for (std::size_t count = in.count(4); count > 0; --count) strip.bones->insert(in.text());
  }
  strip.place.turn = get_between(in, -1e6, 1e6);
  for (glm::dvec3* v : {&strip.place.from, &strip.place.to})
    for (int i = 0; i < 3; ++i) (*v)[i] = get_between(in, -kFarthestMove, kFarthestMove);
  return strip;
}

}  // namespace

void put_strips(ByteWriter& out, const Strips& strips, const std::vector<std::shared_ptr<const Clip>>& clips) {
  out.count(strips.tracks.size());
  for (const StripTrack& track : strips.tracks) {
    out.text(track.name);
    out.flag(track.muted);
    out.flag(track.solo);
    out.count(track.strips.size());
    for (const Strip& strip : track.strips)
      put(out, strip, static_cast<std::size_t>(std::find(clips.begin(), clips.end(), strip.clip) - clips.begin()));
  }
}

Strips get_strips(ByteReader& in, const std::vector<std::shared_ptr<const Clip>>& clips) {
  for (const auto& clip : clips) in.require(!clip->strips);
  Strips strips;
  std::set<std::string> names, track_names;
  const std::size_t tracks = in.count(kFewestOfTrack);
  in.require(tracks <= kMostTracks);
  for (std::size_t t = 0; t < tracks; ++t) {
    StripTrack& track = strips.tracks.emplace_back();
    track.name = in.text();
    in.require(track_names.insert(track.name).second);
    track.muted = in.flag();
    track.solo = in.flag();
    const std::size_t count = in.count(kFewestOfStrip);
    in.require(names.size() + count <= kMostStrips);
    for (std::size_t i = 0; i < count; ++i) {
      track.strips.push_back(get_strip(in, clips));
      in.require(names.insert(track.strips.back().name).second);
      in.require(i == 0 || track.strips[i - 1].start <= track.strips[i].start);
    }
  }
  in.require(clips_of(strips).size() == clips.size());
  return strips;
}

}  // namespace limber
