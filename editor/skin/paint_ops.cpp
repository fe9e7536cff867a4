// SPDX-License-Identifier: AGPL-3.0-or-later
// Painting weights: brushes, how they are set, what they may reach.
#include <algorithm>
#include <cmath>

#include "editor/skin/brush_tools.h"
#include "editor/skin/paint_mode.h"
#include "editor/skin/seam_brush.h"
#include "editor/skin/weight_display.h"
#include "editor/skin/weight_layers.h"
#include "editor/ui/icons.h"
#include "editor/viewport/transform_tool.h"

namespace limber::editor {

namespace {

constexpr double kGrowth = 1.15, kStep = 0.05;  // of the radius; of the strength

std::string needs_paint_below(const Editor& editor) {
  if (editor.seams->brush) {
    const std::string why = why_not_cut(editor);
    return !why.empty() || editor.views->hover.view ? why : "Put the pointer on the body";
  }
  for (const auto& disabled_reason : {why_not_paint, why_brush_reaches_nothing})
    if (std::string why = disabled_reason(editor); !why.empty()) return why;
  return editor.views->hover.view ? "" : "Put the pointer on the body";
}

void begin_number(Editor& editor, BrushNumber which) {
  editor.modal = begin_brush_number(editor, which);
  editor.modal_wrap = {};
}

const char* icon_of(BrushKind kind) {
  constexpr const char* kIcons[] = {icon::kBrushAdd,      icon::kBrushSubtract, icon::kBrushSet,
                                    icon::kBrushMultiply, icon::kBrushSmooth,   icon::kBrushSharpen,
                                    icon::kBrushAverage,  icon::kBrushSmear,    icon::kBrushCapsule};
  const auto place = static_cast<std::size_t>(kind);
  return place < std::size(kIcons) ? kIcons[place] : icon::kSkin;
}

// One for each brush of the table.
std::vector<Operator> brush_operators() {
  std::vector<Operator> all;
  for (const BrushRule& rule : brush_rules())
    all.push_back({operator_of(rule), rule.name, icon_of(rule.kind), "Brush", rule.description,
                   [kind = rule.kind](Editor& e) { e.skin->painting->kind = kind, e.seams->brush = false; }, nullptr,
                   [kind = rule.kind](const Editor& e) { return e.skin->painting->kind == kind && !e.seams->brush; }});
  return all;
}

// One of several settings.
template <class Value>
Operator setting(const char* id, const char* label, const char* description, Value Painting::*member, Value value) {
  return {id,          label,
          "",          "Brush",
          description, [=](Editor& e) { (*e.skin->painting).*member = value; },
          nullptr,     [=](const Editor& e) { return (*e.skin->painting).*member == value; }};
}

Operator normalizing(const char* id, const char* label, const char* description, Normalize how) {
  return {id,          label,
          "",          "Brush",
          description, [how](Editor& e) { e.skin->painting->normalize = how; },
          nullptr,     [how](const Editor& e) { return normalize_of(e) == how; }};
}

Operator shape(const char* id, const char* label, const char* description, FalloffShape falloff) {
  return {id,
          label,
          "",
          "Brush",
          description,
          [falloff](Editor& e) {
            e.skin->painting->falloff = falloff;
            e.skin->painting->falloff_curve.clear();
          },
          nullptr,
          [falloff](const Editor& e) {
            return e.skin->painting->falloff_curve.empty() && e.skin->painting->falloff == falloff;
          }};
}

std::string needs_layer(const Editor& editor) {
  if (!active_layer(editor)) return "Choose a layer first: the base is normalized as it is painted";
  return editor.skin->painting->mask ? "The layer's mask is painted, which has nothing to normalize" : "";
}

Operator leaving_normalizing() {
  Operator off = normalizing(
      "skin.normalize_off", "Normalize: off",
      "Strokes leave the layer's other bones what they have: what lies below it makes room for the painted bone, and "
      "weights are normalized when the layers are put together. Edits of the whole body normalize all the same.",
      Normalize::WhenComposed);
  off.disabled_reason = needs_layer;
  return off;
}

void scale_radius(Editor& editor, double by) {
  editor.skin->painting->radius =
      std::clamp(editor.skin->painting->radius * by, Painting::kLeastRadius, Painting::kMostRadius);
}
void add_strength(Editor& editor, double step) {
  editor.skin->painting->strength =
      std::clamp(std::round((editor.skin->painting->strength + step) / kStep) * kStep, 0.0, 1.0);
}

// The active bone's weight under the pointer becomes the value of the brush.
void sample(Editor& editor) {
  const std::string& name = editor.document().armature->bones[*skin_bone(editor)].name;
  double value = 0;
  for (const BoneWeight& weight : editor.views->hover.weights)
    if (weight.bone == name) value = weight.value;
  editor.skin->painting->value = value;
  editor.messages.info("Value " + text_of_number("%.3f", value), name);
}

}  // namespace

std::vector<Operator> paint_operators() {
  std::vector<Operator> all = {
      {"skin.paint", "Paint", icon::kSkin, "Brush",
       "Paints the active bone's weight with the brush, until the button is let go.",
       [](Editor& e) {
         e.seams->brush ? begin_seam_stroke(e, SeamStroke::Cut) : begin_stroke(e, e.skin->painting->kind);
       },
       needs_paint_below},
      {"skin.paint_subtract", "Paint less", "", "Brush",
       "Takes weight away with the brush, or adds where the brush takes away.",
       [](Editor& e) {
         e.seams->brush
             ? begin_seam_stroke(e, SeamStroke::Join)
             : begin_stroke(e, e.skin->painting->kind == BrushKind::Subtract ? BrushKind::Add : BrushKind::Subtract);
       },
       needs_paint_below},
      {"skin.paint_smooth", "Paint smooth", "", "Brush", "Smooths weights with the brush.",
       [](Editor& e) { e.seams->brush ? begin_seam_stroke(e, SeamStroke::Join) : begin_stroke(e, BrushKind::Smooth); },
       needs_paint_below},
      {"skin.brush_pie", "Brushes", icon::kSkin, "Brush", "Lists the brushes at the pointer.",
       [](Editor& e) { e.open_popup = "Brushes"; }},
      {"skin.radius", "Radius", "", "Brush", "Sets the brush's radius with the pointer.",
       [](Editor& e) { begin_number(e, BrushNumber::Radius); },
       [](const Editor& e) { return e.seams->brush ? why_not_cut(e) : why_not_paint(e); }},
      {"skin.strength", "Strength", "", "Brush", "Sets the brush's strength with the pointer.",
       [](Editor& e) { begin_number(e, BrushNumber::Strength); }, why_not_paint},
      {"skin.value", "Value", "", "Brush", "Sets the brush's value with the pointer.",
       [](Editor& e) { begin_number(e, BrushNumber::Value); }, why_not_paint},
      {"skin.radius_down", "Smaller", "", "Brush", "Makes the brush smaller.",
       [](Editor& e) { scale_radius(e, 1 / kGrowth); }},
      {"skin.radius_up", "Larger", "", "Brush", "Makes the brush larger.", [](Editor& e) { scale_radius(e, kGrowth); }},
      {"skin.strength_down", "Weaker", "", "Brush", "Makes the brush weaker.",
       [](Editor& e) { add_strength(e, -kStep); }},
      {"skin.strength_up", "Stronger", "", "Brush", "Makes the brush stronger.",
       [](Editor& e) { add_strength(e, kStep); }},
      {"skin.sample", "Sample value", icon::kPick, "Brush",
       "The active bone's weight under the pointer becomes the value of the brush.", sample,
       [](const Editor& e) {
         return !why_not_paint(e).empty()        ? why_not_paint(e)
                : e.views->hover.weights.empty() ? std::string("Put the pointer on the body")
                                                 : std::string();
       }},
      setting("skin.reach_surface", "Surface", "Only the outermost tissue is painted.", &Painting::depth,
              BrushDepth::Surface),
      setting("skin.reach_depth", "To a depth", "Tissue down to a depth below the air is painted.", &Painting::depth,
              BrushDepth::ToDepth),
      setting("skin.reach_through", "Through", "All tissue within the radius is painted.", &Painting::depth,
              BrushDepth::Through),
      {"skin.along_tissue", "Geodesic", "", "Brush",
       "Distances go inside the tissue, so that the brush never crosses air to the next finger.",
       [](Editor& e) {
         e.skin->painting->distance =
             e.skin->painting->distance == BrushDistance::Geodesic ? BrushDistance::Euclidean : BrushDistance::Geodesic;
       },
       nullptr, [](const Editor& e) { return e.skin->painting->distance == BrushDistance::Geodesic; }},
      setting("skin.paint_all", "All tissue", "Every tissue is painted, hidden ones as well.", &Painting::tissue,
              PaintedTissue::All),
      setting("skin.paint_soft", "Soft tissue", "Everything that is shown is painted, but for bone.", &Painting::tissue,
              PaintedTissue::Soft),
      setting("skin.paint_chosen", "Chosen tissue", "The tissues that are chosen in the list are painted.",
              &Painting::tissue, PaintedTissue::Chosen),
      setting("skin.paint_visible", "Visible tissue", "Tissues that are shown are painted.", &Painting::tissue,
              PaintedTissue::Visible),
      {"skin.subtree", "Below the bone", "", "Brush",
       "Only where the active bone, the one it hangs on or one below it has most of the weight is painted.",
       [](Editor& e) { e.skin->painting->subtree = !e.skin->painting->subtree; }, nullptr,
       [](const Editor& e) { return e.skin->painting->subtree; }},
      normalizing("skin.normalize_unlocked", "Normalize: unlocked",
                  "Other unlocked bones make room for what is painted.", Normalize::Unlocked),
      normalizing("skin.normalize_all", "Normalize: all", "All unlocked bones are scaled alike, the painted one too.",
                  Normalize::All),
      leaving_normalizing(),
      {"skin.relative_to_locks", "Relative to locks", "", "Brush",
       "To strokes that add, subtract, set or multiply, what locked bones leave of a place counts as the whole: half "
       "of it is what a value of a half sets.",
       [](Editor& e) { e.skin->painting->relative_to_locks = !e.skin->painting->relative_to_locks; }, nullptr,
       [](const Editor& e) { return e.skin->painting->relative_to_locks; }},
      {"skin.accumulate", "Accumulate", "", "Brush", "A stroke adds up where it comes over a place again.",
       [](Editor& e) { e.skin->painting->accumulate = !e.skin->painting->accumulate; }, nullptr,
       [](const Editor& e) { return e.skin->painting->accumulate; }},
      shape("skin.falloff_smooth", "Smooth falloff", "The brush fades in an S.", FalloffShape::Smooth),
      shape("skin.falloff_sphere", "Sphere falloff", "The brush fades as a ball's side does.", FalloffShape::Sphere),
      shape("skin.falloff_root", "Root falloff", "The brush fades late.", FalloffShape::Root),
      shape("skin.falloff_sharp", "Sharp falloff", "The brush fades early.", FalloffShape::Sharp),
      shape("skin.falloff_linear", "Linear falloff", "The brush fades evenly.", FalloffShape::Linear),
      shape("skin.falloff_constant", "Constant falloff", "The brush does not fade.", FalloffShape::Constant),
      {"skin.falloff_own", "Own falloff", "", "Brush",
       "The brush fades by a curve whose points are dragged in the sidebar; a click adds one, the right button takes "
       "it away.",
       [](Editor& e) {
         if (e.skin->painting->falloff_curve.empty()) begin_falloff_curve(*e.skin->painting);
       },
       nullptr, [](const Editor& e) { return !e.skin->painting->falloff_curve.empty(); }},
  };
  for (Operator& op : brush_operators()) all.push_back(std::move(op));
  return all;
}

}  // namespace limber::editor
