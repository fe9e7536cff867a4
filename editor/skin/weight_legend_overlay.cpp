// SPDX-License-Identifier: AGPL-3.0-or-later
// Draws over the views of the Skin workspace: the legend of the weight colours, and a readout of the weights under the
// pointer.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "editor/context/context.h"
#include "editor/context/interaction.h"
#include "editor/context/operator.h"
#include "editor/context/operator_button.h"
#include "editor/context/panels.h"
#include "editor/context/pointer_context.h"
#include "editor/context/screen.h"
#include "editor/context/views.h"
#include "editor/labels/label_brush.h"
#include "editor/shown/test_pose.h"
#include "editor/skin/painting.h"
#include "editor/skin/weight_display.h"
#include "editor/viewport/gizmo_draw.h"
#include "editor/volume/tissue_edits.h"
#include "render/scene/weight_colormap.h"

namespace limber::editor {

namespace {

// Sizes of the legend, px at scale 1. A view that is narrower than kNeeded shows no legend.
constexpr float kWidth = 322, kNarrow = 210, kHeight = 56, kMargin = 8, kNeeded = 460;

Colour colour_of(const glm::vec3& srgb) { return rgb(srgb.r, srgb.g, srgb.b); }

// Draws the colour ramp between two boxes with the colours of the weights 0 (left) and 1 (right).
void draw_ramp(Context& context, const Rect& box) {
  const Look& look = context.ui->look;
  const float top = box.low.y + look.px(26), bottom = top + look.px(12), cap = look.px(22), gap = look.px(4);
  const Rect zero{{box.low.x + look.px(10), top}, {box.low.x + look.px(10) + cap, bottom}},
      one{{box.high.x - look.px(10) - cap, top}, {box.high.x - look.px(10), bottom}};
  const Rect ramp{{zero.high.x + gap, top}, {one.low.x - gap, bottom}};
  fill(zero, colour_of(render::kExactZero), look.px(2));
  fill(one, colour_of(render::kExactOne), look.px(2));
  constexpr int kSteps = static_cast<int>(render::kWeightRamp.size()) - 1;
  for (int step = 0; step < kSteps; ++step) {
    const Colour left = colour_of(render::kWeightRamp[static_cast<std::size_t>(step)]),
                 right = colour_of(render::kWeightRamp[static_cast<std::size_t>(step) + 1]);
    const float from = ramp.low.x + ramp.width() * static_cast<float>(step) / kSteps,
                to = ramp.low.x + ramp.width() * static_cast<float>(step + 1) / kSteps;
    ImGui::GetWindowDrawList()->AddRectFilledMultiColor({from, top}, {to, bottom}, left, right, right, left);
  }
  for (const float level : {0.25f, 0.5f, 0.75f}) {
    const float x = std::round(ramp.low.x + ramp.width() * level);
    if (context.skin->contours) fill({{x, top}, {x + look.line(), bottom}}, with_alpha(0xFF000000, 0.45f));
  }
  const Rect labels{{zero.low.x, bottom + look.px(1)}, {one.high.x, box.high.y - look.px(2)}};
  put_text(context.ui, look.fonts.small, look.theme.view_text2, labels, "exactly 0");
  put_text(context.ui, look.fonts.small, look.theme.view_text2,
           Rect{{ramp.low.x, labels.low.y}, {ramp.high.x, labels.high.y}}, "0.5", Align::Centre);
  put_text(context.ui, look.fonts.small, look.theme.view_text2, labels, "exactly 1", Align::Right);
}

// Draws a row of colour swatches, each with a label at its right, and stops at the first that does not fit into the
// box.
void draw_chips(Ui& ui, const Rect& box, const std::vector<std::pair<Colour, std::string>>& chips) {
  const Look& look = ui.look;
  float x = box.low.x + look.px(10);
  const float y = box.low.y + look.px(28);
  for (const auto& [colour, words] : chips) {
    const float width = text_size(look.fonts.small, words).x;
    if (x + look.px(18) + width > box.high.x - look.px(10)) break;
    fill({{x, y}, {x + look.px(12), y + look.px(12)}}, colour, look.px(3));
    x += look.px(18);
    put_text(ui, look.fonts.small, look.theme.view_text2, Rect{{x, y - look.px(2)}, {x + width + 1, y + look.px(14)}},
             words);
    x += width + look.px(12);
  }
}

// Returns the colour and the name of each bone that has weight: the active bone first, then the others by their share
// of the body's total weight, the largest first.
std::vector<std::pair<Colour, std::string>> bones_by_share(Context& context, const SkinWeights& weights) {
  const auto& bones = context.document().armature->bones;
  std::vector<std::pair<double, int>> order;
  for (int bone = 0; bone < std::ssize(bones); ++bone)
    order.push_back(
        {-context.skin->shares.of(weights_bone(weights, bones[static_cast<std::size_t>(bone)].name)).value_or(0) -
             (skin_bone(context) == bone ? 2 : 0),
         bone});
  std::sort(order.begin(), order.end());
  std::vector<std::pair<Colour, std::string>> chips;
  for (const auto& [share, bone] : order)
    if (share < 0) chips.push_back({swatch_of(context, bone), bones[static_cast<std::size_t>(bone)].name});
  return chips;
}

std::string three_digits(double value) {
  char text[16];
  std::snprintf(text, sizeof text, "%.3f", value);
  return text;
}

std::string tissue_and_depth(const Context& context) {
  const Hover& hover = context.views->hover;
  const LabelVolume& volume = *context.document().volume;
  const Tissue* tissue = context.document().tissues ? context.document().tissues->find(hover.label) : nullptr;
  const double depth = depth_of(volume, hover.voxel);
  const glm::dvec3& spacing = volume.grid.spacing;
  const std::string words =
      (tissue ? shown_name(*tissue) : std::string("Label")) + " \u00b7 " + std::to_string(hover.label) + ", ";
  return words + (depth <= std::max({spacing.x, spacing.y, spacing.z})
                      ? std::string("surface")
                      : std::to_string(static_cast<int>(std::lround(depth))) + " mm deep");
}

}  // namespace

bool draw_weight_legend(Context& context, const Rect& view) {
  if (!context.views->scene.weights || !context.views->scene.weights->weights ||
      view.width() < context.ui->look.px(kNeeded) || view.height() < context.ui->look.px(200))
    return false;
  const Look& look = context.ui->look;
  const auto weights = context.views->scene.weights->weights;
  const glm::vec2 low{view.low.x + look.px(kMargin), view.high.y - look.px(kMargin + kHeight)};
  const render::WeightDisplay display = context.views->scene.weights->display;
  const float narrowest = look.px(display == render::WeightDisplay::Active ? kNarrow : kWidth);
  const Rect box{low, low + glm::vec2(std::clamp(0.4f * view.width(), narrowest, look.px(kWidth)), look.px(kHeight))};
  fill(box, with_alpha(look.theme.view_plate, 0.85f), look.px(5));
  const Pressed pressed = press_area(context.ui, "legend", box);
  if (pressed.hovered) operator_tooltip(context, *find_operator(context.operators, "skin.display_pie"), box);
  if (pressed.clicked) run(context, "skin.display_pie");
  const std::string title =
      display == render::WeightDisplay::Active
          ? "Weight of " + context.document().armature->bones[static_cast<std::size_t>(*skin_bone(context))].name
      : display == render::WeightDisplay::Count ? std::string("Bones that a voxel follows")
                                                : std::string(name_of(context.skin->display));
  put_text(context.ui, look.fonts.regular, look.theme.view_text,
           Rect{{box.low.x + look.px(10), box.low.y + look.px(3)}, {box.high.x - look.px(10), box.low.y + look.px(23)}},
           title);
  if (display == render::WeightDisplay::Active) draw_ramp(context, box);
  else if (display != render::WeightDisplay::Count) draw_chips(context.ui, box, bones_by_share(context, *weights));
  else {
    std::vector<std::pair<Colour, std::string>> counts;
    for (int count = 1; count <= 4; ++count)
      counts.push_back({colour_of(render::count_colour(count)), std::to_string(count)});
    draw_chips(context.ui, box, counts);
  }
  return true;
}

void draw_weights_at_pointer(Context& context) {
  const Hover& hover = context.views->hover;
  const InputState& input = context.ui->input;
  if (context.workspace() != Workspace::Skin || hover.weights.empty() || !hover.inside || context.interaction->drag ||
      context.interaction->modal || context.skin->painting->labels->on || input.down(MouseButton::Left))
    return;
  const ViewPlace* place = hovered_view(context);
  if (!place || ImGui::IsPopupOpen(nullptr, ImGuiPopupFlags_AnyPopupId)) return;
  const Look& look = context.ui->look;
  const float row = look.px(20), width = look.px(176),
              height = row * static_cast<float>(hover.weights.size()) + look.px(8 + 6 + 20 + 20);
  const float off = look.px(22) + context.skin->ring;
  glm::vec2 low{input.pointer.x + off, input.pointer.y - look.px(20)};
  // The readout is drawn to the right of the pointer. If the pointer's view has too little room there, but enough to
  // the left, the readout is drawn to the left. It is also drawn to the left if it would cross the right edge of all
  // views.
  const Rect& all = context.screen->layout.views;
  const float edge = look.px(4);
  if (low.x + width > place->rect.high.x - edge && input.pointer.x - off - width >= place->rect.low.x)
    low.x = input.pointer.x - off - width;
  if (low.x + width > all.high.x - edge) low.x = input.pointer.x - off - width;
  low.y = std::clamp(low.y, all.low.y + edge, std::max(all.low.y + edge, all.high.y - height - edge));
  const Rect box{glm::round(low), glm::round(low) + glm::vec2(width, height)};
  fill(box, with_alpha(look.theme.view_plate, 0.92f), look.px(5));
  const Colour ground = look.theme.view_text2;
  float y = box.low.y + look.px(6), sum = 0;
  for (const BoneWeight& weight : hover.weights) {
    const auto bone = context.document().armature ? context.document().armature->find(weight.bone) : std::nullopt;
    const float swatch = look.px(8), at = std::round(y + (row - swatch) / 2);
    fill({{box.low.x + look.px(12), at}, {box.low.x + look.px(12) + swatch, at + swatch}},
         bone ? swatch_of(context, *bone) : ground, look.line());
    put_text(context.ui, look.fonts.regular, look.theme.view_text,
             Rect{{box.low.x + look.px(28), y}, {box.high.x - look.px(58), y + row}}, weight.bone);
    put_text(context.ui, look.fonts.mono, look.theme.view_text,
             Rect{{box.high.x - look.px(62), y}, {box.high.x - look.px(12), y + row}}, three_digits(weight.value),
             Align::Right);
    y += row;
    sum += static_cast<float>(weight.value);
  }
  y += look.px(3);
  fill({{box.low.x + look.px(12), y}, {box.high.x - look.px(12), y + look.line()}}, with_alpha(ground, 0.35f));
  y += look.px(3);
  const bool whole = std::abs(sum - 1) < 0.5f / kFullWeight;
  put_text(context.ui, look.fonts.regular, ground,
           Rect{{box.low.x + look.px(12), y}, {box.high.x - look.px(62), y + row}}, "Sum");
  put_text(context.ui, look.fonts.mono, whole ? kViewOk : kViewError,
           Rect{{box.high.x - look.px(62), y}, {box.high.x - look.px(12), y + row}}, three_digits(sum), Align::Right);
  y += row - look.px(2);
  put_text(context.ui, look.fonts.small, ground, Rect{{box.low.x + look.px(12), y}, {box.high.x - look.px(8), y + row}},
           tissue_and_depth(context));
}

}  // namespace limber::editor
