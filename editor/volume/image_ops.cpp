// SPDX-License-Identifier: AGPL-3.0-or-later
// Operators for the grey image (CT, MR) that the views show with the labels.
#include <algorithm>
#include <cmath>

#include "editor/context/context.h"
#include "editor/context/interaction.h"
#include "editor/context/operator.h"
#include "editor/context/operator_polls.h"
#include "editor/context/pointer_context.h"
#include "editor/ui/icons.h"
#include "editor/ui/ui.h"
#include "editor/volume/image_labels.h"
#include "editor/volume/shown_image.h"

namespace limber::editor {

namespace {

// Change of the window of grey values per pixel of a drag (at scale 1): the level changes by this fraction of the
// width; the width is multiplied by e^(twice this number).
constexpr double kPerPixel = 1.0 / 300;

std::string needs_image(const Context& context) {
  return context.views && context.views->image ? "" : "Open an image first: File > Import > Image";
}

// Returns the step to which a drag rounds the window of an image with this range of values: a power of ten, at most 1,
// that is less than a thousandth of the range. For a CT it is 1 HU.
double window_step(double range) { return std::pow(10.0, std::min(0.0, std::floor(std::log10(range / 1000)))); }

// Changes the window of grey values during a drag of the pointer, as in radiology programs: dragging right widens the
// window, dragging up makes the picture darker.
void drag_window(Context& context) {
  const ViewPlace* place = hovered_view(context);
  if (!place || !context.views->image) return;
  const render::ShownGrey before = *context.views->image;
  const MouseButton button = context.ui->input.down(MouseButton::Right)    ? MouseButton::Right
                             : context.ui->input.down(MouseButton::Middle) ? MouseButton::Middle
                                                                           : MouseButton::Left;
  // The drag adds up small movements in `level` and `width`. The image gets both numbers rounded to `step`.
  context.interaction->drag = Drag{
      button,
      [level = before.level, width = before.width](Context& c, const glm::vec2& pixels) mutable {
        if (!c.views->image) return;
        render::ShownGrey& image = *c.views->image;
        const GreyLevels& levels = *image.image;
        const double range = std::max(levels.most() - levels.least, 1e-6), step = window_step(range);
        const glm::dvec2 by = glm::dvec2(pixels) / double(c.ui->look.scale) * kPerPixel;
        level = std::clamp(level - by.y * std::max(width, range / 100), levels.least - range, levels.most() + range);
        width = std::clamp(width * std::exp(2 * by.x), range / 5000, 2 * range);
        image.level = std::round(level / step) * step;
        image.width = std::max(std::round(width / step), 1.0) * step;
      },
      {},
      [before](Context& c) {
        if (c.views->image && c.views->image->image == before.image) c.views->image = before;
      },
      PointerWrap(place->rect, context.ui->look.px(2))};
}

Operator window_operator(const ImageWindow& window) {
  return {window.id,
          std::string(window.name) + " window",
          "",
          "View",
          "Show the image with the usual window (level and width, in Hounsfield units) for this tissue.",
          [window](Context& c) {
            c.views->image->level = window.level;
            c.views->image->width = window.width;
          },
          needs_image,
          [window](const Context& c) {
            return c.views->image && c.views->image->level == window.level && c.views->image->width == window.width;
          }};
}

void show_all_values(Context& context) {
  const auto [level, width] = usual_window(*context.views->image->image);
  context.views->image->level = level;
  context.views->image->width = width;
}

Operator rendering_operator(const char* id, const char* label, const char* description,
                            render::GreyRendering rendering) {
  return {id,
          label,
          "",
          "View",
          description,
          [rendering](Context& c) {
            c.views->image->rendering = rendering;
            c.views->display = render::Display::Image;
          },
          needs_image,
          [rendering](const Context& c) { return c.views->image && c.views->image->rendering == rendering; }};
}

}  // namespace

std::vector<Operator> image_operators() {
  std::vector<Operator> all = {
      {"image.close", "Close image", "", "View", "Stop showing the grey image. The project does not change.",
       close_image, needs_image},
      {"image.drag_window", "Change window by dragging", "", "View",
       "Drag in a slice: right to widen the window, up to raise its level.", drag_window, needs_image},
      {"image.window_all", "All values", "", "View", "Show the image from its darkest to its brightest values.",
       show_all_values, needs_image},
      {"view.image_display", "Image", "", "View", "Show the grey image in 3D instead of the tissues.",
       [](Context& c) { c.views->display = render::Display::Image; }, needs_image,
       [](const Context& c) { return c.views->display == render::Display::Image; }},
      rendering_operator("image.render_bone", "Bone in 3D", "Show everything as dense as bone (CT).",
                         render::GreyRendering::Bone),
      rendering_operator("image.render_muscle", "Muscle in 3D", "Show muscle, translucent, with the bones in it (CT).",
                         render::GreyRendering::Muscle),
      rendering_operator("image.render_skin", "Skin in 3D", "Show the surface between body and air (CT).",
                         render::GreyRendering::Skin),
      rendering_operator("image.render_window", "Window in 3D",
                         "Show the image in 3D by its window (level and width): brighter values are more opaque.",
                         render::GreyRendering::Window),
      rendering_operator("image.render_maximum", "Maximum in 3D",
                         "Show the largest value along each line of sight (maximum intensity projection).",
                         render::GreyRendering::Maximum),
      {"image.labels", "Labels from CT...", icon::kTissues, "Edit",
       "Make a label volume from the open CT by thresholds: skin, soft tissue, fat, lung, gas, bone.", ask_for_labels,
       needs_image},
      {"image.body", "Labels from MR...", icon::kTissues, "Edit",
       "Make a label volume of body and skin from the open MR or other image, by a threshold.", ask_for_body,
       needs_image},
  };
  for (const ImageWindow& window : ct_windows()) all.push_back(window_operator(window));
  return all;
}

}  // namespace limber::editor
