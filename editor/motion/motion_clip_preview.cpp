// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/motion/motion_clip_preview.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "editor/context/context.h"
#include "editor/context/views.h"
#include "editor/ui/draw.h"
#include "editor/ui/widgets.h"

namespace limber::editor {

namespace {

constexpr int kMeasured = 60;         // approximate number of frames that are sampled to measure the figure's size
constexpr double kSide = 0.6;         // angle by which the camera is turned from the front to the side, radians
constexpr double kAbove = 0.2;        // angle by which the camera looks down, radians
constexpr double kFinest = 1.0 / 60;  // a playing preview is drawn again after this time at the earliest, s

// Projects a 3D point into the picture. The returned x points to the right and y up.
glm::dvec2 seen(const glm::dvec3& p) {
  const double depth = -std::sin(kSide) * p.x + std::cos(kSide) * p.y;
  return {std::cos(kSide) * p.x + std::sin(kSide) * p.y, std::cos(kAbove) * p.z + std::sin(kAbove) * depth};
}

}  // namespace

MotionPicture::MotionPicture(std::shared_ptr<const Motion> motion) : motion_(std::move(motion)) {
  int ends = static_cast<int>(motion_->joints.size());
  for (int j = 0; j < std::ssize(motion_->joints); ++j) {
    if (motion_->joints[j].parent >= 0) sticks_.emplace_back(motion_->joints[j].parent, j);
    if (motion_->joints[j].end_site) sticks_.emplace_back(j, ends++);
  }
}

std::vector<glm::dvec3> MotionPicture::places(int frame, bool z_up) const {
  const auto world = forward_kinematics(*motion_, frame);
  std::vector<glm::dvec3> places;
  const auto add = [&](const glm::dvec3& p) { places.push_back(z_up ? glm::dvec3(p.x, p.y, p.z) : lps_from_bvh(p)); };
  for (const RigidTransform& joint : world) add(joint.translation);
  for (std::size_t j = 0; j < world.size(); ++j)
    if (motion_->joints[j].end_site) add(world[j] * *motion_->joints[j].end_site);
  const glm::dvec3 middle(places[0].x, places[0].y, 0);
  for (glm::dvec3& p : places) p -= middle;
  return places;
}

void MotionPicture::measure(bool z_up) {
  if (measured_ == static_cast<int>(z_up)) return;
  measured_ = z_up;
  low_ = 1e300, high_ = -1e300, wide_ = 1e-9;
  const int step = std::max(1, motion_->frame_count / kMeasured);
  for (int frame = 0; frame < motion_->frame_count; frame += step)
    for (const glm::dvec3& p : places(frame, z_up)) {
      const glm::dvec2 at = seen(p);
      low_ = std::min(low_, at.y);
      high_ = std::max(high_, at.y);
      wide_ = std::max(wide_, std::abs(at.x));
    }
}

void MotionPicture::move_on(Context& context, const Rect& rect, double rate) {
  const Pressed pressed = press_area(context.ui, "preview", rect);
  const int last = motion_->frame_count - 1;
  if (pressed.held) {
    const double share = (ImGui::GetIO().MousePos.x - rect.low.x) / std::max(1.0f, rect.width());
    frame_ = static_cast<int>(std::round(std::clamp(share, 0.0, 1.0) * last));
    began_ = -1;
    stays_ = true;
  } else if (pressed.hovered && last > 0) {
    if (stays_) return;
    if (began_ < 0) began_ = context.ui->now, began_at_ = frame_;
    frame_ = static_cast<int>(std::fmod(began_at_ + (context.ui->now - began_) * rate, last + 1.0));
    context.ui->wake_at(context.ui->now + std::max(kFinest, 1 / rate));
  } else {
    began_ = -1;
    stays_ = false;
  }
}

void MotionPicture::draw(Context& context, const Rect& rect, bool z_up, double rate) {
  const Look& look = context.ui->look;
  const float text = look.px(20);
  const Rect picture{rect.low, {rect.high.x, rect.high.y - 2 * text}};
  move_on(context, picture, std::isfinite(rate) && rate > 0 ? std::min(rate, 1000.0) : 30);
  measure(z_up);
  fill(picture, look.theme.field, look.px(6));

  const float margin = look.px(16);
  const double scale =
      std::min((picture.height() - 2 * margin) / std::max(1e-9, high_ - low_), (picture.width() / 2 - margin) / wide_);
  const glm::dvec2 middle = picture.centre();
  const auto pixel_of = [&](const glm::dvec2& at) {
    return im(glm::vec2(middle.x + scale * at.x, middle.y - scale * (at.y - (low_ + high_) / 2)));
  };
  ImDrawList& canvas = *ImGui::GetWindowDrawList();
  canvas.PushClipRect(im(picture.low), im(picture.high), true);
  const float ground = pixel_of({0, low_}).y;
  canvas.AddLine({picture.low.x + margin, ground}, {picture.high.x - margin, ground}, look.theme.line2, look.line());
  const auto where = places(frame_, z_up);
  for (const auto& [a, b] : sticks_)
    canvas.AddLine(pixel_of(seen(where[a])), pixel_of(seen(where[b])), look.theme.accent, 2 * look.scale);
  for (std::size_t j = 0; j < motion_->joints.size(); ++j)
    canvas.AddCircleFilled(pixel_of(seen(where[j])), 2.2f * look.scale, look.theme.text);
  canvas.PopClipRect();

  const double share = motion_->frame_count > 1 ? double(frame_) / (motion_->frame_count - 1) : 0;
  const Rect bar{{picture.low.x, picture.high.y - look.px(3)}, picture.high};
  fill({bar.low, {bar.low.x + static_cast<float>(share) * bar.width(), bar.high.y}}, look.theme.accent, 0);
  char words[64];
  std::snprintf(words, sizeof words, "Frame %d / %d", frame_, motion_->frame_count - 1);
  put_text(context.ui, look.fonts.mono, look.theme.text2,
           Rect{{rect.low.x, picture.high.y}, {rect.high.x, picture.high.y + text}}, words);
  put_text(context.ui, look.fonts.small, look.theme.text3, Rect{{rect.low.x, picture.high.y + text}, rect.high},
           "Hover to play the motion, drag to scrub.");
}

}  // namespace limber::editor
