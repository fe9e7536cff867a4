// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/selection/area_select_tool.h"

#include <algorithm>
#include <cmath>

#include "editor/context/context.h"
#include "editor/context/selection.h"
#include "editor/context/workspace.h"
#include "editor/pose/pose_edits.h"
#include "editor/rig/rig_edits.h"
#include "editor/ui/draw.h"
#include "editor/viewport/gizmo_draw.h"
#include "editor/viewport/transform_tool.h"

namespace limber::editor {

namespace {

constexpr int kSamples = 16;                            // intervals of a bone: kSamples + 1 points of it are tested
constexpr float kRadius = 24, kLeast = 4, kMost = 400;  // initial, smallest, largest circle radius, pixels at scale 1
constexpr float kGrowth = 1.15f;                        // factor by which a wheel step changes the circle radius

// A bone in the view, represented by points that are spaced evenly from its head to its tail. `points` are the pixels
// of those points that are visible.
struct SeenBone {
  int bone;
  std::vector<glm::dvec2> points;
};

std::vector<SeenBone> bones_seen(const Context& context, const ViewProjection& view) {
  const bool posed = context.workspace() == Workspace::Pose;
  const std::shared_ptr<const Armature> rig = posed ? context.document().armature : shown_rig(context);
  const auto moved = posed_from_rest(*rig, posed ? seen_pose(context) : rest_pose(*rig));
  std::vector<SeenBone> seen;
  for (int bone = 0; bone < std::ssize(rig->bones); ++bone) {
    SeenBone one{bone, {}};
    for (int i = 0; i <= kSamples; ++i) {
      const glm::dvec3 point =
          moved[bone] * glm::mix(rig->bones[bone].head, rig->bones[bone].tail, double(i) / kSamples);
      const auto pixel = view.shows(point) ? view.pixel_of(point) : std::nullopt;
      if (pixel) one.points.push_back(*pixel);
    }
    seen.push_back(std::move(one));
  }
  return seen;
}

class AreaSelection : public Modal {
 public:
  explicit AreaSelection(Context& context)
      : view_(context, place_of_tool(context)),
        before_(context.selection),
        pointer_(context.ui->input.pointer),
        bones_(bones_seen(context, view_)) {}

  bool moved(Context& context, const glm::vec2&) override {
    pointer_ = context.ui->input.pointer;
    context.ui->touch();
    return true;
  }
  bool key(Context& context, const KeyChanged& event) override {
    if (!event.down) return true;
    if (event.key == Key::Escape) cancel(context);
    return event.key != Key::Escape && !(ends_by_key() && (event.key == Key::Return || event.key == Key::NumEnter));
  }
  void cancel(Context& context) override { *context.selection = before_; }

 protected:
  virtual bool ends_by_key() const { return false; }

  // Adds to the selection all bones that have a visible point in the area, or removes them while Shift is held. The
  // active bone stays active as long as it is selected.
  //   inside  returns true if a pixel lies in the area
  template <class Inside>
  void take(Context& context, const Inside& inside) {
    Selection& selection = context.selection;
    for (const SeenBone& bone : bones_) {
      if (std::none_of(bone.points.begin(), bone.points.end(), inside)) continue;
      if (context.ui->input.down(Key::Shift)) selection.bones.erase(bone.bone);
      else selection.bones.insert(bone.bone);
    }
    if (!selection.bone || !selection.bones.contains(*selection.bone))
      selection.bone = selection.bones.empty() ? std::nullopt : std::optional(*selection.bones.begin());
    selection.tissues.clear();
    selection.tissue.reset();
    context.transform_settings->part = TransformSettings::Part::Whole;
  }

  ViewProjection view_;
  const Selection before_;
  glm::vec2 pointer_;

 private:
  std::vector<SeenBone> bones_;
};

class BoxSelection final : public AreaSelection {
 public:
  using AreaSelection::AreaSelection;

  bool button(Context& context, const ButtonChanged& event) override {
    if (event.button == MouseButton::Right && event.down) return false;
    if (event.button != MouseButton::Left) return true;
    if (event.down) {
      from_ = context.ui->input.pointer;
      return true;
    }
    if (!from_) return true;
    const glm::dvec2 low = glm::min(*from_, pointer_), high = glm::max(*from_, pointer_);
    take(context, [&](const glm::dvec2& p) { return p.x >= low.x && p.x <= high.x && p.y >= low.y && p.y <= high.y; });
    return false;
  }

  void draw(Context& context, const ViewPlace& place) override {
    if (place.id != view_.place.id) return;
    const Theme& theme = context.ui->look.theme;
    if (!from_) {
      const Colour line = with_alpha(theme.view_text, 0.5f);
      fill({{place.rect.low.x, pointer_.y}, {place.rect.high.x, pointer_.y + context.ui->look.line()}}, line);
      fill({{pointer_.x, place.rect.low.y}, {pointer_.x + context.ui->look.line(), place.rect.high.y}}, line);
      return;
    }
    const Rect box{glm::min(*from_, pointer_), glm::max(*from_, pointer_)};
    fill(box, with_alpha(theme.view_text, 0.08f));
    outline(box, theme.view_text, 0, context.ui->look.line());
  }

  std::vector<KeyHint> hints(const Context&) const override {
    return {{{"LMB"}, "Draw a box"}, {{"Shift"}, "Deselect"}, {{"Esc"}, "Cancel"}};
  }
  std::string title() const override { return "Select in a box"; }

 private:
  std::optional<glm::vec2> from_;
};

class CircleSelection final : public AreaSelection {
 public:
  using AreaSelection::AreaSelection;

  bool moved(Context& context, const glm::vec2& pixels) override {
    AreaSelection::moved(context, pixels);
    if (painting_) paint(context);
    return true;
  }
  bool wheel(Context& context, float steps) override {
    radius_ = std::clamp(radius_ * std::pow(kGrowth, steps), kLeast, kMost);
    context.ui->touch();
    return true;
  }
  bool button(Context& context, const ButtonChanged& event) override {
    if (event.button == MouseButton::Right && event.down) return false;
    if (event.button != MouseButton::Left) return true;
    painting_ = event.down;
    if (painting_) paint(context);
    return true;
  }

  void draw(Context& context, const ViewPlace& place) override {
    if (place.id != view_.place.id) return;
    const bool taking_out = context.ui->input.down(Key::Shift);
    ImGui::GetWindowDrawList()->AddCircle(im(pointer_), radius_ * context.ui->look.scale,
                                          taking_out ? kViewError : context.ui->look.theme.view_text, 64,
                                          1.5f * context.ui->look.line());
  }

  std::vector<KeyHint> hints(const Context&) const override {
    return {{{"LMB"}, "Paint"}, {{"Shift"}, "Deselect"}, {{"Wheel"}, "Size"}, {{"Enter"}, "Done"}, {{"Esc"}, "Cancel"}};
  }
  std::string title() const override { return "Select with a circle"; }

 private:
  bool ends_by_key() const override { return true; }
  void paint(Context& context) {
    const double reach = radius_ * context.ui->look.scale;
    take(context, [&](const glm::dvec2& p) { return glm::distance(p, glm::dvec2(pointer_)) <= reach; });
  }

  float radius_ = kRadius;
  bool painting_ = false;
};

}  // namespace

std::unique_ptr<Modal> begin_box_selection(Context& context) { return std::make_unique<BoxSelection>(context); }

std::unique_ptr<Modal> begin_circle_selection(Context& context) { return std::make_unique<CircleSelection>(context); }

}  // namespace limber::editor
