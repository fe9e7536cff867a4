// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/motion/onion_skin_overlay.h"

#include <algorithm>
#include <chrono>
#include <limits>

#include "editor/context/background_task.h"
#include "editor/context/context.h"
#include "editor/context/view_projection.h"
#include "editor/context/views.h"
#include "editor/context/workspace.h"
#include "editor/motion/timeline.h"
#include "editor/shown/preview_blend.h"
#include "editor/ui/draw.h"
#include "editor/viewport/silhouette.h"

namespace limber::editor {

namespace {

// Colours of ghosts before and after the shown frame, in ABGR (in RGB: 4B8EF5, 5AD19A).
constexpr Colour kPast = 0xFFF58E4B, kComing = 0xFF9AD15A;
// A bone is drawn as a kite. These are the distance from the bone's head to the kite's widest point, and half the width
// there, as shares of the bone's length.
constexpr double kWidest = 0.12, kHalfWidth = 0.0425;

void draw_ghost(Ui& ui, const ViewProjection& view, const Armature& armature, const Pose& pose, Colour colour) {
  ImDrawList& canvas = *ImGui::GetWindowDrawList();
  const auto posed = posed_from_rest(armature, pose);
  for (std::size_t b = 0; b < armature.bones.size(); ++b) {
    const auto head = view.pixel_of(posed[b] * armature.bones[b].head),
               tail = view.pixel_of(posed[b] * armature.bones[b].tail);
    if (!head || !tail) continue;
    const glm::dvec2 along = *tail - *head, across = kHalfWidth * glm::dvec2(-along.y, along.x),
                     middle = *head + kWidest * along;
    const ImVec2 outline[] = {im(glm::vec2(*head)), im(glm::vec2(middle + across)), im(glm::vec2(*tail)),
                              im(glm::vec2(middle - across))};
    canvas.AddPolyline(outline, 4, colour, ImDrawFlags_Closed, 1.4f * ui.look.scale);
  }
}

// ---- Outlines of the body

// The surface from which outlines are made is simplified to at most this many vertices.
constexpr std::int64_t kMostVertices = 20'000;
constexpr float kCell = 2;  // edge of the grid cells from which silhouette() finds outlines, pixels at scale 1
// Time limit for computing outlines in one drawn frame. At least one missing outline is computed, even if this takes
// longer.
constexpr std::chrono::milliseconds kTime{8};
constexpr std::size_t kMostKept = 1000;  // if the cache holds more outlines than this, all of them are discarded

void take_surface(Context& context, OnionOutlines& outlines) {
  const Document& document = context.document();
  if (outlines.volume == document.volume && outlines.weights == document.weights) return;
  outlines = {.volume = document.volume, .weights = document.weights};
  if (!document.volume || !document.weights) return;
  start_task(context, "", [volume = document.volume, weights = document.weights](Progress&) -> Finish {
    const LabelSet all(65536, 1);
    auto surface = std::make_shared<const SkinnedSurface>(
        skinned_surface(*volume, TissueVoxels(*volume), *weights, all, kMostVertices));
    return [volume, weights, surface](Context& c) {
      OnionOutlines& now = *c.timeline->onion.outlines;
      if (now.volume == volume && now.weights == weights) now.surface = surface;
      c.ui->touch();
    };
  });
}

// Returns numbers that identify a view: its rectangle, and for four fixed points their pixels and the directions in
// which they are seen. Two views with equal numbers are equal.
std::vector<double> view_of(const ViewProjection& view) {
  std::vector<double> numbers{view.place.rect.low.x, view.place.rect.low.y, view.place.rect.high.x,
                              view.place.rect.high.y};
  for (const glm::dvec3& point : {glm::dvec3(0), glm::dvec3(100, 0, 0), glm::dvec3(0, 100, 0), glm::dvec3(0, 0, 100)}) {
    const auto pixel = view.pixel_of(point);
    const glm::dvec3 towards = view.direction_to_eye(point);
    numbers.insert(numbers.end(), {pixel ? pixel->x : 0, pixel ? pixel->y : 0, towards.x, towards.y, towards.z});
  }
  return numbers;
}

std::vector<std::vector<glm::vec2>> outline_of(const ViewProjection& view, const OnionOutlines& outlines,
                                               const Armature& armature, const Pose& pose, float cell) {
  const auto posed = posed_from_rest(armature, pose);
  std::vector<RigidTransform> motions;
  for (const std::string& name : outlines.weights->bones()) {
    const auto bone = armature.find(name);
    if (!bone) return {};
    motions.push_back(posed[*bone]);
  }
  std::vector<glm::vec2> pixels;
  for (const glm::vec3& point : posed_surface(outlines.surface, motions, outlines.seen.blend).V) {
    const auto pixel = view.pixel_of(glm::dvec3(point));
    pixels.push_back(pixel ? glm::vec2(*pixel) : glm::vec2(std::numeric_limits<float>::quiet_NaN()));
  }
  return silhouette(pixels, outlines.surface->F, view.place.rect, cell);
}

void draw_lines(const std::vector<std::vector<glm::vec2>>& lines, Colour colour, float thickness) {
  ImDrawList& canvas = *ImGui::GetWindowDrawList();
  std::vector<ImVec2> points;
  for (const auto& line : lines) {
    points.clear();
    for (const glm::vec2& p : line) points.push_back(im(p));
    canvas.AddPolyline(points.data(), static_cast<int>(points.size()), colour, ImDrawFlags_Closed, thickness);
  }
}

}  // namespace

void draw_onion_skin(Context& context) {
  auto& onion = context.timeline->onion;
  const std::optional<ViewProjection> view = body_seen(context);
  const ClipOnRig* clip = onion.on && context.workspace() == Workspace::Pose && view ? clip_on_rig(context) : nullptr;
  if (!clip) return;
  if (!onion.outlines) onion.outlines = std::make_shared<OnionOutlines>();
  OnionOutlines& outlines = *onion.outlines;
  take_surface(context, outlines);
  const OnionOutlines::Seen seen{view_of(*view), clip->clip(), clip->armature(), outlines.surface,
                                 preview_blend(context.resampling)};
  if (outlines.seen != seen || outlines.lines.size() > kMostKept) {
    outlines.seen = seen;
    outlines.lines.clear();
  }

  const FrameRange range = playing_range(context.document());
  const auto began = std::chrono::steady_clock::now();
  bool made_one = false, waits = false;
  // Ghosts of frames far from the shown frame are drawn first, so that ghosts of nearer frames lie on top.
  for (int step = onion.count; step >= 1; --step)
    for (const int side : {-1, 1}) {
      const int frame = shown_frame(context) + side * step * onion.step;
      if (frame < range.low || frame > range.high) continue;
      const Colour colour =
          with_alpha(side < 0 ? kPast : kComing, std::min(1.0f, 1.8f / static_cast<float>(1 << step)));
      auto found = outlines.lines.find(frame);
      if (found == outlines.lines.end() && outlines.surface) {
        waits = made_one && std::chrono::steady_clock::now() - began > kTime;
        if (!waits)
          found = outlines.lines
                      .emplace(frame, outline_of(*view, outlines, *clip->armature(), clip->at(frame),
                                                 kCell * context.ui->look.scale))
                      .first,
          made_one = true;
      }
      if (found != outlines.lines.end() && !found->second.empty())
        draw_lines(found->second, colour, 1.6f * context.ui->look.scale);
      else if (context.views->bones) draw_ghost(context.ui, *view, *clip->armature(), clip->at(frame), colour);
    }
  if (waits) context.ui->touch();
}

}  // namespace limber::editor
