// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/onion_skin.h"

#include "editor/paint.h"
#include "editor/seen_from.h"
#include "editor/timeline.h"

namespace limber::editor {

namespace {

constexpr Colour kPast = 0xFFF58E4B, kComing = 0xFF9AD15A;  // 4B8EF5, 5AD19A
constexpr double kWidest = 0.12, kHalfWidth = 0.0425;       // of a bone's length, as bones are drawn

void draw_ghost(Editor& editor, const SeenFrom& view, const Armature& armature, const Pose& pose, Colour colour) {
  ImDrawList& canvas = *ImGui::GetWindowDrawList();
  const auto posed = posed_from_rest(armature, pose);
  for (std::size_t b = 0; b < armature.bones.size(); ++b) {
    const auto head = view.pixel_of(posed[b] * armature.bones[b].head), tail = view.pixel_of(posed[b] * armature.bones[b].tail);
    if (!head || !tail) continue;
    const glm::dvec2 along = *tail - *head, across = kHalfWidth * glm::dvec2(-along.y, along.x), middle = *head + kWidest * along;
    const ImVec2 outline[] = {im(glm::vec2(*head)), im(glm::vec2(middle + across)), im(glm::vec2(*tail)), im(glm::vec2(middle - across))};
    canvas.AddPolyline(outline, 4, colour, ImDrawFlags_Closed, 1.4f * editor.look.scale);
  }
}

}  // namespace

void draw_onion_skin(Editor& editor) {
  const auto& onion = editor.timeline->onion;
  const std::optional<SeenFrom> view = body_seen(editor);
  const ClipOnRig* clip = onion.on && editor.workspace == Workspace::Pose && view && editor.views->bones ? clip_on_rig(editor) : nullptr;
  if (!clip) return;
  const FrameRange range = playing_range(editor);
  // The furthest first: near ones lie on top.
  for (int step = onion.count; step >= 1; --step)
    for (const int side : {-1, 1}) {
      const int frame = shown_frame(editor) + side * step * onion.step;
      if (frame < range.low || frame > range.high) continue;
      draw_ghost(editor, *view, *clip->armature(), clip->at(frame), with_alpha(side < 0 ? kPast : kComing, 1.8f / static_cast<float>(1 << step)));
    }
}

}  // namespace limber::editor
