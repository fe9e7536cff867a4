// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/motion/motion_path_overlay.h"

#include <chrono>

#include "editor/context/context.h"
#include "editor/context/selection.h"
#include "editor/context/view_projection.h"
#include "editor/context/workspace.h"
#include "editor/motion/timeline.h"
#include "editor/ui/draw.h"

namespace limber::editor {

namespace {

// Colours in ABGR: of the path before the shown frame (RGB 4B8EF5) and after it (RGB 5AD19A), the same as those of the
// onion skin, and of the diamonds at keys (RGB F5A623), the same as in the timeline.
constexpr Colour kPast = 0xFFF58E4B, kComing = 0xFF9AD15A, kKey = 0xFF23A6F5;
// Longest path, in frames; a longer playing range shows only its first frames.
constexpr int kMostFrames = 100'000;
constexpr std::size_t kMostBones = 8;  // if more bones are selected, only the active bone has a path
// A frame has a dot if its point lies at least this far from the last dot, pixels at scale 1.
constexpr float kRoom = 5;
constexpr std::chrono::milliseconds kTime{8};  // time limit per drawn frame for computing new points

void add_points(const ClipOnRig& clip, MotionPaths& paths) {
  const auto began = std::chrono::steady_clock::now();
  while (paths.first + std::ssize(paths.tips) <= paths.last && std::chrono::steady_clock::now() - began < kTime) {
    const auto posed = posed_from_rest(*paths.armature, clip.at(paths.first + static_cast<int>(paths.tips.size())));
    std::vector<glm::dvec3>& tips = paths.tips.emplace_back();
    for (const int bone : paths.bones) tips.push_back(posed[bone] * paths.armature->bones[bone].tail);
  }
}

bool has_key(const Clip& clip, const std::string& bone, int frame) {
  const auto keys = clip.keys.bones.find(bone);
  return keys != clip.keys.bones.end() && keys->second.contains(frame);
}

void draw_diamond(ImDrawList& canvas, const glm::vec2& at, float half, Colour colour) {
  canvas.AddQuadFilled(im(at - glm::vec2(half, 0)), im(at - glm::vec2(0, half)), im(at + glm::vec2(half, 0)),
                       im(at + glm::vec2(0, half)), colour);
}

// Draws the path of one bone's tip.
//   number  index of the bone in the paths' list
void draw_path(Context& context, const ViewProjection& view, const MotionPaths& paths, std::size_t number) {
  ImDrawList& canvas = *ImGui::GetWindowDrawList();
  const float scale = context.ui->look.scale;
  const int now = shown_frame(context);
  const std::string& name = paths.armature->bones[paths.bones[number]].name;
  std::optional<glm::dvec2> before, dot;
  for (std::size_t k = 0; k < paths.tips.size(); ++k) {
    const int frame = paths.first + static_cast<int>(k);
    const auto pixel = view.pixel_of(paths.tips[k][number]);
    const Colour colour = frame <= now ? kPast : kComing;
    if (pixel && before) canvas.AddLine(im(glm::vec2(*before)), im(glm::vec2(*pixel)), colour, 1.5f * scale);
    if (pixel && (!dot || glm::distance(*dot, *pixel) >= kRoom * scale)) {
      canvas.AddCircleFilled(im(glm::vec2(*pixel)), 2 * scale, colour);
      dot = pixel;
    }
    before = pixel;
  }
  for (std::size_t k = 0; k < paths.tips.size(); ++k) {
    const int frame = paths.first + static_cast<int>(k);
    const auto pixel = view.pixel_of(paths.tips[k][number]);
    if (!pixel) continue;
    if (has_key(*paths.clip, name, frame)) draw_diamond(canvas, glm::vec2(*pixel), 5 * scale, kKey);
    if (frame == now)
      canvas.AddCircle(im(glm::vec2(*pixel)), 5 * scale, context.ui->look.theme.view_text, 0, 1.5f * scale);
  }
}

}  // namespace

const MotionPaths* motion_paths(Context& context) {
  const ClipOnRig* clip =
      context.timeline->paths.on && context.workspace() == Workspace::Pose ? clip_on_rig(context) : nullptr;
  std::vector<int> bones(context.selection->bones.begin(), context.selection->bones.end());
  if (bones.size() > kMostBones) bones.assign(context.selection->bone ? 1 : 0, context.selection->bone.value_or(0));
  if (!clip || bones.empty()) return nullptr;
  auto& kept = context.timeline->paths.kept;
  const auto [low, high] = playing_range(context.document());
  const int last = std::min(high, low + kMostFrames - 1);
  if (!kept || kept->clip != clip->clip() || kept->armature != clip->armature() || kept->bones != bones ||
      kept->first != low || kept->last != last)
    kept = std::make_shared<MotionPaths>(MotionPaths{clip->clip(), clip->armature(), bones, low, last, {}});
  add_points(*clip, *kept);
  if (kept->first + std::ssize(kept->tips) <= kept->last) context.ui->touch();
  return kept.get();
}

void draw_motion_paths(Context& context) {
  const MotionPaths* paths = motion_paths(context);
  const std::optional<ViewProjection> view = paths ? body_seen(context) : std::nullopt;
  if (!view) return;
  for (std::size_t number = 0; number < paths->bones.size(); ++number) draw_path(context, *view, *paths, number);
}

}  // namespace limber::editor
