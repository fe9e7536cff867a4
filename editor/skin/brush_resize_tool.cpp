// SPDX-License-Identifier: AGPL-3.0-or-later
#include <algorithm>
#include <cmath>

#include "editor/context/context.h"
#include "editor/context/views.h"
#include "editor/skin/brush_tools.h"
#include "editor/skin/painting.h"
#include "editor/skin/weight_display.h"
#include "editor/ui/draw.h"
#include "editor/viewport/gizmo_draw.h"
#include "editor/viewport/numeric_input.h"
#include "editor/viewport/transform_tool.h"

namespace limber::editor {

namespace {

constexpr double kWhole = 120;  // pointer's distance from the ring's centre for strength or value 1, px at scale 1
constexpr float kSlow = 0.1f;   // the pointer's movement counts only this fraction while Shift is held

class BrushNumberTool final : public Modal {
 public:
  BrushNumberTool(Context& context, BrushNumber which)
      : which_(which),
        view_(context, place_of_tool(context)),
        before_(number(context)) {
    const Painting& painting = *context.skin->painting;
    const glm::dvec3 near = painting.place                   ? painting.place->seen
                            : view_.place.id == ViewId::Body ? context.views->body.camera.centre
                                                             : context.views->cross_hair;
    per_pixel_ =
        which == BrushNumber::Radius ? view_.millimetres_per_pixel(near) : 1 / (kWhole * context.ui->look.scale);
    pointer_ = glm::dvec2(context.ui->input.pointer);
    centre_ = pointer_ - glm::dvec2(before_ / per_pixel_, 0);
  }

  bool moved(Context& context, const glm::vec2& pixels) override {
    pointer_ += glm::dvec2(pixels) * double(context.ui->input.down(Key::Shift) ? kSlow : 1.0f);
    show(context);
    return true;
  }
  bool button(Context& context, const ButtonChanged& event) override {
    if (!event.down) return true;
    if (event.button == MouseButton::Right) cancel(context);
    return event.button == MouseButton::Middle;
  }
  bool key(Context& context, const KeyChanged& event) override {
    if (!event.down) return true;
    if (event.key == Key::Return || event.key == Key::NumEnter) return false;
    if (event.key == Key::Escape) {
      cancel(context);
      return false;
    }
    if (typed_.key(event.key)) show(context);
    return true;
  }
  void cancel(Context& context) override { number(context) = before_; }

  std::string title() const override {
    constexpr const char* kNames[] = {"Radius", "Strength", "Value"};
    return std::string(kNames[static_cast<int>(which_)]) + " " +
           (typed_.typed() ? typed_.text() : text_of_number(which_ == BrushNumber::Radius ? "%.1f" : "%.2f", now_)) +
           (which_ == BrushNumber::Radius ? " mm" : "");
  }
  std::vector<KeyHint> hints(const Context&) const override {
    return {{{"LMB"}, "Confirm"}, {{"0-9"}, "Type a number"}, {{"Shift"}, "Precise"}, {{"Esc"}, "Cancel"}};
  }

  void draw(Context& context, const ViewPlace& place) override {
    if (place.id != view_.place.id) return;
    now_ = number(context);
    const float scale = context.ui->look.scale, radius = static_cast<float>(now_ / per_pixel_);
    const ImVec2 centre = im(glm::vec2(centre_));
    ImDrawList& canvas = *ImGui::GetWindowDrawList();
    if (which_ != BrushNumber::Radius) {
      canvas.AddCircle(centre, float(kWhole) * scale, with_alpha(0xFFFFFFFF, 0.5f), 64, 1.5f * scale);
      canvas.AddCircleFilled(centre, radius, with_alpha(0xFFFFFFFF, 0.25f * static_cast<float>(now_)), 64);
    }
    canvas.AddCircle(centre, radius, with_alpha(0xFF000000, 0.55f), 64, 3.6f * scale);
    canvas.AddCircle(centre, radius, 0xFFFFFFFF, 64, 2 * scale);
    const Rect words{glm::vec2(centre_) - glm::vec2(context.ui->look.px(60), context.ui->look.px(10)),
                     glm::vec2(centre_) + glm::vec2(context.ui->look.px(60), context.ui->look.px(10))};
    put_text(context.ui, context.ui->look.fonts.mono, 0xFFFFFFFF, words,
             typed_.typed() ? typed_.text() : text_of_number(which_ == BrushNumber::Radius ? "%.1f mm" : "%.2f", now_),
             Align::Centre);
  }

 private:
  double& number(Context& context) const {
    Painting& painting = *context.skin->painting;
    return which_ == BrushNumber::Radius     ? painting.radius
           : which_ == BrushNumber::Strength ? painting.strength
                                             : painting.value;
  }
  void show(Context& context) {
    const double wished = typed_.typed() ? typed_.value() : glm::distance(pointer_, centre_) * per_pixel_;
    number(context) = which_ == BrushNumber::Radius ? std::clamp(wished, Painting::kLeastRadius, Painting::kMostRadius)
                                                    : std::clamp(wished, 0.0, 1.0);
    context.ui->touch();
  }

  BrushNumber which_;
  ViewProjection view_;
  const double before_;
  double per_pixel_ = 1, now_ = 0;
  glm::dvec2 centre_{0}, pointer_{0};
  TypedNumber typed_;
};

}  // namespace

std::unique_ptr<Modal> begin_brush_number(Context& context, BrushNumber which) {
  return std::make_unique<BrushNumberTool>(context, which);
}

}  // namespace limber::editor
