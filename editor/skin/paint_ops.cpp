// SPDX-License-Identifier: AGPL-3.0-or-later
// Operators of weight painting: brushes, their settings, and the tissue they may paint.
#include <algorithm>
#include <cmath>

#include "editor/context/context.h"
#include "editor/context/interaction.h"
#include "editor/context/menu_state.h"
#include "editor/context/operator.h"
#include "editor/context/views.h"
#include "editor/shown/test_pose.h"
#include "editor/skin/brush_tools.h"
#include "editor/skin/label_strokes.h"
#include "editor/skin/paint_mode.h"
#include "editor/skin/seam_brush.h"
#include "editor/skin/weight_display.h"
#include "editor/skin/weight_layers.h"
#include "editor/ui/icons.h"
#include "editor/ui/messages.h"
#include "editor/viewport/transform_tool.h"

namespace limber::editor {

namespace {

// Change of the brush per key press: the radius is multiplied by kGrowth, kStep is added to the strength.
constexpr double kGrowth = 1.15, kStep = 0.05;

bool paints_labels(const SkinDisplay& skin) { return skin.painting->labels->on; }

std::string needs_paint_below(const Context& context) {
  if (paints_labels(context.skin)) {
    const std::string why = why_not_paint_labels(context);
    return !why.empty() || context.views->hover.view ? why : "Put the pointer on the body";
  }
  if (context.seams->brush) {
    const std::string why = why_not_cut(context);
    return !why.empty() || context.views->hover.view ? why : "Put the pointer on the body";
  }
  for (const auto& disabled_reason : {why_not_paint, why_brush_reaches_nothing})
    if (std::string why = disabled_reason(context); !why.empty()) return why;
  return context.views->hover.view ? "" : "Put the pointer on the body";
}

void begin_number(Context& context, BrushNumber which) {
  context.interaction->modal = begin_brush_number(context, which);
  context.interaction->modal_wrap = {};
}

const char* icon_of(BrushKind kind) {
  constexpr const char* kIcons[] = {icon::kBrushAdd,      icon::kBrushSubtract, icon::kBrushSet,
                                    icon::kBrushMultiply, icon::kBrushSmooth,   icon::kBrushSharpen,
                                    icon::kBrushAverage,  icon::kBrushSmear,    icon::kBrushCapsule};
  const auto place = static_cast<std::size_t>(kind);
  return place < std::size(kIcons) ? kIcons[place] : icon::kSkin;
}

// Returns one operator for each brush in brush_rules().
std::vector<Operator> brush_operators() {
  std::vector<Operator> all;
  for (const BrushRule& rule : brush_rules())
    all.push_back({operator_of(rule), rule.name, icon_of(rule.kind), "Brush", rule.description,
                   [kind = rule.kind](Context& c) {
                     c.skin->painting->kind = kind;
                     c.seams->brush = c.skin->painting->labels->on = false;
                   },
                   nullptr,
                   [kind = rule.kind](const Context& c) {
                     return c.skin->painting->kind == kind && !c.seams->brush && !paints_labels(c.skin);
                   }});
  return all;
}

// Returns an operator that sets a member of Painting to `value`. It is shown as checked while the member has this
// value.
template <class Value>
Operator setting(const char* id, const char* label, const char* description, Value Painting::*member, Value value) {
  return {id,          label,
          "",          "Brush",
          description, [=](Context& c) { (*c.skin->painting).*member = value; },
          nullptr,     [=](const Context& c) { return (*c.skin->painting).*member == value; }};
}

Operator normalizing(const char* id, const char* label, const char* description, Normalize how) {
  return {id,          label,
          "",          "Brush",
          description, [how](Context& c) { c.skin->painting->normalize = how; },
          nullptr,     [how](const Context& c) { return normalize_of(c) == how; }};
}

Operator shape(const char* id, const char* label, const char* description, FalloffShape falloff) {
  return {id,
          label,
          "",
          "Brush",
          description,
          [falloff](Context& c) {
            c.skin->painting->falloff = falloff;
            c.skin->painting->falloff_curve.clear();
          },
          nullptr,
          [falloff](const Context& c) {
            return c.skin->painting->falloff_curve.empty() && c.skin->painting->falloff == falloff;
          }};
}

std::string needs_layer(const Context& context) {
  if (!active_layer(context)) return "Select a layer first: strokes on the base are always normalized";
  return context.skin->painting->mask ? "The layer's mask is being painted, and a mask is not normalized" : "";
}

Operator leaving_normalizing() {
  Operator off = normalizing(
      "skin.normalize_off", "Normalize: off",
      "Strokes do not change the layer's other bones. The painted bone takes its weight from the layers below, "
      "and weights are normalized when the layers are combined. Edits of the whole body always normalize.",
      Normalize::WhenComposed);
  off.disabled_reason = needs_layer;
  return off;
}

void scale_radius(SkinDisplay& skin, double by) {
  skin.painting->radius = std::clamp(skin.painting->radius * by, Painting::kLeastRadius, Painting::kMostRadius);
}
void add_strength(SkinDisplay& skin, double step) {
  skin.painting->strength = std::clamp(std::round((skin.painting->strength + step) / kStep) * kStep, 0.0, 1.0);
}

// Sets the brush's value to the active bone's weight under the pointer.
void sample(Context& context) {
  const std::string& name = context.document().armature->bones[*skin_bone(context)].name;
  double value = 0;
  for (const BoneWeight& weight : context.views->hover.weights)
    if (weight.bone == name) value = weight.value;
  context.skin->painting->value = value;
  context.messages->info("Value " + text_of_number("%.3f", value), name);
}

}  // namespace

std::vector<Operator> paint_operators() {
  std::vector<Operator> all = {
      {"skin.paint", "Paint", icon::kSkin, "Brush",
       "Paint the active bone's weight with the brush until the mouse button is released.",
       [](Context& c) {
         if (paints_labels(c.skin)) return begin_label_stroke(c, false);
         c.seams->brush ? begin_seam_stroke(c, SeamStroke::Cut) : begin_stroke(c, c.skin->painting->kind);
       },
       needs_paint_below},
      {"skin.paint_subtract", "Paint inverse", "", "Brush",
       "Paint with the opposite effect: subtract weight, or add weight if the brush subtracts.",
       [](Context& c) {
         if (paints_labels(c.skin)) return begin_label_stroke(c, true);
         c.seams->brush
             ? begin_seam_stroke(c, SeamStroke::Join)
             : begin_stroke(c, c.skin->painting->kind == BrushKind::Subtract ? BrushKind::Add : BrushKind::Subtract);
       },
       needs_paint_below},
      {"skin.paint_smooth", "Smooth weights", "", "Brush", "Smooth weights with the brush.",
       [](Context& c) { c.seams->brush ? begin_seam_stroke(c, SeamStroke::Join) : begin_stroke(c, BrushKind::Smooth); },
       [](const Context& c) {
         return paints_labels(c.skin) ? "The label brush does not smooth: select another brush" : needs_paint_below(c);
       }},
      {"skin.brush_pie", "Brushes", icon::kSkin, "Brush", "Open a menu at the pointer to select a brush.",
       [](Context& c) { c.menus->open_popup = "Brushes"; }},
      {"skin.radius", "Radius", "", "Brush", "Set the brush's radius by moving the pointer.",
       [](Context& c) { begin_number(c, BrushNumber::Radius); },
       [](const Context& c) {
         return paints_labels(c.skin) ? why_not_paint_labels(c) : c.seams->brush ? why_not_cut(c) : why_not_paint(c);
       }},
      {"skin.strength", "Strength", "", "Brush", "Set the brush's strength by moving the pointer.",
       [](Context& c) { begin_number(c, BrushNumber::Strength); }, why_not_paint},
      {"skin.value", "Value", "", "Brush", "Set the brush's value by moving the pointer.",
       [](Context& c) { begin_number(c, BrushNumber::Value); }, why_not_paint},
      {"skin.radius_down", "Smaller brush", "", "Brush", "Make the brush smaller.",
       [](Context& c) { scale_radius(c.skin, 1 / kGrowth); }},
      {"skin.radius_up", "Larger brush", "", "Brush", "Make the brush larger.",
       [](Context& c) { scale_radius(c.skin, kGrowth); }},
      {"skin.strength_down", "Weaker brush", "", "Brush", "Lower the brush's strength.",
       [](Context& c) { add_strength(c.skin, -kStep); }},
      {"skin.strength_up", "Stronger brush", "", "Brush", "Raise the brush's strength.",
       [](Context& c) { add_strength(c.skin, kStep); }},
      {"skin.sample", "Sample value", icon::kPick, "Brush",
       "Set the brush's value to the active bone's weight under the pointer. With the label brush, select the tissue "
       "under the pointer.",
       [](Context& c) { paints_labels(c.skin) ? run(c, "labels.pick") : sample(c); },
       [](const Context& c) {
         if (paints_labels(c.skin)) return disabled_reason(c, *find_operator(c.operators, "labels.pick"));
         return !why_not_paint(c).empty()        ? why_not_paint(c)
                : c.views->hover.weights.empty() ? std::string("Put the pointer on the body")
                                                 : std::string();
       }},
      setting("skin.reach_surface", "Surface", "Paint only the outermost tissue.", &Painting::depth,
              BrushDepth::Surface),
      setting("skin.reach_depth", "To a depth", "Paint tissue down to a set depth below the body's surface.",
              &Painting::depth, BrushDepth::ToDepth),
      setting("skin.reach_through", "All depths", "Paint all tissue within the brush's radius.", &Painting::depth,
              BrushDepth::Through),
      {"skin.along_tissue", "Geodesic", "", "Brush",
       "Measure the brush's distances inside the tissue, so that a stroke never crosses air to the next finger.",
       [](Context& c) {
         c.skin->painting->distance =
             c.skin->painting->distance == BrushDistance::Geodesic ? BrushDistance::Euclidean : BrushDistance::Geodesic;
       },
       nullptr, [](const Context& c) { return c.skin->painting->distance == BrushDistance::Geodesic; }},
      setting("skin.paint_all", "All tissue", "Paint every tissue, including hidden ones.", &Painting::tissue,
              PaintedTissue::All),
      setting("skin.paint_soft", "Soft tissue", "Paint all visible tissue except bone.", &Painting::tissue,
              PaintedTissue::Soft),
      setting("skin.paint_chosen", "Selected tissue", "Paint only the tissues selected in the list.", &Painting::tissue,
              PaintedTissue::Chosen),
      setting("skin.paint_visible", "Visible tissue", "Paint all visible tissues.", &Painting::tissue,
              PaintedTissue::Visible),
      {"skin.subtree", "Bone hierarchy", "", "Brush",
       "Paint only where the active bone, its parent or one of its descendants has most of the weight.",
       [](Context& c) { c.skin->painting->subtree = !c.skin->painting->subtree; }, nullptr,
       [](const Context& c) { return c.skin->painting->subtree; }},
      normalizing("skin.normalize_unlocked", "Normalize: unlocked",
                  "Keep the sum of weights at 1 by changing the other unlocked bones, not the painted one.",
                  Normalize::Unlocked),
      normalizing("skin.normalize_all", "Normalize: all",
                  "Keep the sum of weights at 1 by scaling all unlocked bones, including the painted one.",
                  Normalize::All),
      leaving_normalizing(),
      {"skin.relative_to_locks", "Relative to locks", "", "Brush",
       "Apply values to the weight that is left by locked bones: 0.5 sets half of the weight that is left.",
       [](Context& c) { c.skin->painting->relative_to_locks = !c.skin->painting->relative_to_locks; }, nullptr,
       [](const Context& c) { return c.skin->painting->relative_to_locks; }},
      {"skin.accumulate", "Accumulate", "", "Brush", "Let a stroke act again each time it passes over the same tissue.",
       [](Context& c) { c.skin->painting->accumulate = !c.skin->painting->accumulate; }, nullptr,
       [](const Context& c) { return c.skin->painting->accumulate; }},
      shape("skin.falloff_smooth", "Smooth falloff", "Fade the brush from its centre to its rim along an S curve.",
            FalloffShape::Smooth),
      shape("skin.falloff_sphere", "Sphere falloff",
            "Fade the brush from its centre to its rim along a quarter circle.", FalloffShape::Sphere),
      shape("skin.falloff_root", "Root falloff", "Fade the brush mostly near its rim.", FalloffShape::Root),
      shape("skin.falloff_sharp", "Sharp falloff", "Fade the brush mostly near its centre.", FalloffShape::Sharp),
      shape("skin.falloff_linear", "Linear falloff", "Fade the brush evenly from its centre to its rim.",
            FalloffShape::Linear),
      shape("skin.falloff_constant", "Constant falloff", "Paint with full effect up to the brush's rim.",
            FalloffShape::Constant),
      {"skin.falloff_own", "Custom falloff", "", "Brush",
       "Fade the brush by a curve of your own. Drag its points in the sidebar; a click adds a point, a right click "
       "removes it.",
       [](Context& c) {
         if (c.skin->painting->falloff_curve.empty()) begin_falloff_curve(*c.skin->painting);
       },
       nullptr, [](const Context& c) { return !c.skin->painting->falloff_curve.empty(); }},
  };
  for (Operator& op : brush_operators()) all.push_back(std::move(op));
  return all;
}

}  // namespace limber::editor
