// SPDX-License-Identifier: AGPL-3.0-or-later
#include <algorithm>

#include "editor/context/context.h"
#include "editor/context/screen.h"
#include "editor/context/views.h"
#include "editor/skin/brush_settings.h"
#include "editor/skin/brush_tools.h"
#include "editor/skin/weight_display.h"
#include "editor/skin/weight_edits.h"
#include "editor/ui/ui.h"
#include "editor/viewport/gizmo_draw.h"
#include "editor/viewport/transform_tool.h"

namespace limber::editor {

namespace {

constexpr double kLeast = 3;  // a shorter drag is ignored as a slip of the hand, pixels at scale 1

using Fields = std::vector<FormField>;

class GradientTool final : public Modal {
 public:
  explicit GradientTool(Context& context) : pointer_(context.ui->input.pointer) {}

  bool moved(Context& context, const glm::vec2&) override {
    pointer_ = context.ui->input.pointer;
    if (view_) to_ = at_pointer();
    context.ui->touch();
    return true;
  }
  bool key(Context& context, const KeyChanged& event) override {
    if (!event.down) return true;
    if (event.key == Key::R) radial_ = !radial_;
    context.ui->touch();
    return event.key != Key::Escape;
  }
  bool button(Context& context, const ButtonChanged& event) override {
    if (event.button == MouseButton::Right && event.down) return false;
    if (event.button != MouseButton::Left) return true;
    if (event.down) {
      const ViewPlace* place = context.screen->layout.view_at(pointer_);
      if (!place) return false;
      view_.emplace(context, *place);
      // The line starts at the body's surface under the pointer. If no tissue is under the pointer, the line starts at
      // the depth of the camera's centre (3D view) or of the crosshair (slice).
      const auto body = brush_place(context, *place, pointer_);
      from_ = body                        ? body->seen
              : place->id == ViewId::Body ? context.views->body.camera.centre
                                          : context.views->cross_hair;
      from_ = to_ = at_pointer();
      begun_ = pointer_;
      return true;
    }
    if (!view_) return true;
    if (glm::distance(begun_, pointer_) >= kLeast * context.ui->look.scale) keep(context);
    return false;
  }

  void draw(Context& context, const ViewPlace& place) override {
    if (!view_ || place.id != view_->place.id) return;
    const GizmoPainter painter(context, *view_);
    const double length = glm::distance(from_, to_);
    const Colour dark = with_alpha(0xFF000000, 0.55f);
    if (radial_ && length > 0)
      for (const double share : {0.5, 1.0}) {
        const Ring ring{from_, view_->towards_eye, view_->right, length * share};
        painter.ring(ring, dark, 3.6f, GizmoPainter::Part::Whole);
        painter.ring(ring, share == 1 ? 0xFFFFFFFF : with_alpha(0xFFFFFFFF, 0.5f), 1.5f, GizmoPainter::Part::Whole);
      }
    painter.line(from_, to_, dark, 4);
    painter.line(from_, to_, 0xFFFFFFFF, 2);
    // This end of the line has the colour of weight 1, the other end that of weight 0.
    painter.dot(from_, 0xFFD9F4FF, dark, 5);
    painter.dot((from_ + to_) / 2.0, 0xFFFFFFFF, dark, 2.5f);
    painter.dot(to_, 0xFF69625E, 0xFFFFFFFF, 5);
  }

  std::vector<KeyHint> hints(const Context&) const override {
    return {{{"LMB"}, "Drag from full weight to none"},
            {{"R"}, radial_ ? "Fade along the line" : "Fade around the line's start"},
            {{"Esc"}, "Cancel"}};
  }
  std::string title() const override {
    return std::string(radial_ ? "Gradient around a point" : "Gradient along a line") +
           (view_ ? ", " + text_of_number("%.1f", glm::distance(from_, to_)) + " mm" : "");
  }

 private:
  glm::dvec3 at_pointer() const { return view_->in_plane(pointer_, from_, view_->towards_eye).value_or(from_); }

  void keep(Context& context) {
    const Painting& painting = *context.skin->painting;
    edit_weights(
        context,
        {choice_of("Shape",
                   "Linear: the weight fades along the line. Radial: it fades in all directions from the line's start.",
                   {"Linear", "Radial"}, radial_ ? 1 : 0),
         number_of("Start weight", "The bone's weight at the start of the line.", painting.value, 0, 1, "%.2f"),
         number_of("End weight", "The bone's weight at the end of the line.", 0, 0, 1, "%.2f"),
         choice_of("Falloff", "How the weight changes from the start of the line to its end.",
                   {"Smooth", "Sphere", "Root", "Sharp", "Linear"}, static_cast<int>(FalloffShape::Linear)),
         number_of("Amount", "How much of the change is applied. 0 = none, 1 = all.", 1, 0, 1, "%.2f")},
        [from = from_, to = to_](const Context& c, const Fields& fields) {
          Gradient gradient{from,
                            to,
                            fields[0].chosen == 1,
                            fields[1].value,
                            fields[2].value,
                            static_cast<FalloffShape>(fields[3].chosen)};
          return WeightOperation{.label = "Draw weight gradient of " + painted_name(c),
                                 .work = [gradient, amount = fields[4].value](const WeightsToEdit& what,
                                                                              const EditScope& scope) -> EditedWeights {
                                   return {with_gradient(what.body(), *what.document.weights, what.settings.bones,
                                                         gradient, amount, scope),
                                           ""};
                                 }};
        });
  }

  glm::vec2 pointer_, begun_{0};
  std::optional<ViewProjection> view_;  // the view in which the line is drawn; none until the button is pressed
  glm::dvec3 from_{0}, to_{0};          // the line's ends, world, mm
  bool radial_ = false;
};

}  // namespace

std::unique_ptr<Modal> begin_gradient(Context& context) { return std::make_unique<GradientTool>(context); }

}  // namespace limber::editor
