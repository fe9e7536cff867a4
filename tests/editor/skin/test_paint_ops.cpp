// SPDX-License-Identifier: AGPL-3.0-or-later
// Tests the operators that select and set brushes, and painting with these brushes.
#include "editor/context/menu_state.h"
#include "editor/skin/brush_presets.h"
#include "editor/skin/brush_settings.h"
#include "editor/skin/weight_display.h"
#include "tests/editor/operator_proofs.h"
#include "tests/editor/weighed_limb.h"

namespace limber::test {

using namespace editor;

namespace {

// Makes the lower half follow the second bone, which is active.
void weigh(Stage& s) {
  Document next = s.document();
  next.weights = test::half_weights(*next.volume);
  s.editor().history->commit("Weigh", next);
  s.editor().selection->bone = 1;
  s.editor().selection->bones = {1};
  s.play("key Ctrl+2\n move \"3D view/view\"\n key Num1\n wait-idle");
}

std::function<bool(Stage&, const Seen&)> edit_is(const char* label) {
  return [=](Stage& s, const Seen& b) {
    return s.is("edit", label) && static_cast<int>(s.editor().history->position()) == b.position + 1;
  };
}

template <class Value>
std::function<bool(Stage&, const Seen&)> is(Value Painting::*member, Value value) {
  return [=](Stage& s, const Seen&) { return (*s.editor().skin->painting).*member == value; };
}
std::function<bool(Stage&, const Seen&)> is_near(double Painting::*member, double value) {
  return [=](Stage& s, const Seen&) { return std::abs((*s.editor().skin->painting).*member - value) < 1e-6; };
}
std::function<void(Stage&)> with(const std::function<void(Painting&)>& set) {
  return [=](Stage& s) { set(*s.editor().skin->painting); };
}

}  // namespace

std::vector<Proof> proofs_of_painting() {
  const std::string at_middle = "move \"3D view/view\"\n wait-idle\n ";
  std::vector<Proof> all = {
      {"skin.brush_subtract", "key 2", is(&Painting::kind, BrushKind::Subtract), Shows::Nothing, "", weigh},
      {"skin.brush_set", "key 3", is(&Painting::kind, BrushKind::Set)},
      {"skin.brush_multiply", "key 4", is(&Painting::kind, BrushKind::Multiply)},
      {"skin.brush_smooth", "key 5", is(&Painting::kind, BrushKind::Smooth)},
      {"skin.brush_sharpen", "key 6", is(&Painting::kind, BrushKind::Sharpen)},
      {"skin.brush_average", "key 7", is(&Painting::kind, BrushKind::Average)},
      {"skin.brush_smear", "key 8", is(&Painting::kind, BrushKind::Smear)},
      {"skin.brush_capsule", "key 9", is(&Painting::kind, BrushKind::JointCapsule)},
      {"skin.brush_add", "click \"strip/skin.brush_add\"", is(&Painting::kind, BrushKind::Add)},
      {"skin.brush_pie", at_middle + "key W",
       [](Stage& s, const Seen&) { return s.editor().menus->shown_popup == "Brushes"; }},
      {"skin.preset_save",
       "click Edit/Brush/Presets/\"Save brush preset...\"\n wait-idle\n type Wide\n key Return\n wait-idle",
       [](Stage& s, const Seen&) {
         const auto& presets = brush_presets(s.editor());
         return presets.size() == 1 && presets[0].name == "Wide" && presets[0].radius == 77;
       },
       Shows::Nothing, "", with([](Painting& p) { p.radius = 77; })},
      {"skin.preset_use", "click Edit/Brush/Presets/\"Use brush preset...\"\n wait-idle\n key Return\n wait-idle",
       is_near(&Painting::radius, 77), Shows::Nothing, "", with([](Painting& p) { p.radius = 5; })},
      {"skin.preset_delete", "click Edit/Brush/Presets/\"Delete brush preset...\"\n wait-idle\n key Return\n wait-idle",
       [](Stage& s, const Seen&) { return brush_presets(s.editor()).empty(); }},
      {"skin.paint", "press \"3D view/view\"\n release\n wait-idle", edit_is("Add Fore"), Shows::InBody, at_middle,
       with([](Painting& p) { p.radius = 25, p.strength = 1; })},
      {"skin.paint_smooth", "key-down Shift\n press \"3D view/view\"\n release\n key-up Shift\n wait-idle",
       edit_is("Smooth Fore"), Shows::InBody, at_middle},
      {"skin.paint_subtract", "key-down Ctrl\n press \"3D view/view\"\n release\n key-up Ctrl\n wait-idle",
       edit_is("Subtract Fore"), Shows::InBody, at_middle},
      {"skin.radius", at_middle + "key F\n key 7\n key Return", is_near(&Painting::radius, 7)},
      {"skin.strength", at_middle + "key Shift+F\n key .\n key 4\n key Return", is_near(&Painting::strength, 0.4)},
      {"skin.value", at_middle + "key Ctrl+F\n key .\n key 6\n key Return", is_near(&Painting::value, 0.6)},
      {"skin.radius_down", "key [", is_near(&Painting::radius, 10 / 1.15), Shows::Nothing, "",
       with([](Painting& p) { p.radius = 10; })},
      {"skin.radius_up", "key ]", is_near(&Painting::radius, 11.5), Shows::Nothing, "",
       with([](Painting& p) { p.radius = 10; })},
      {"skin.strength_down", "key Shift+[", is_near(&Painting::strength, 0.45), Shows::Nothing, "",
       with([](Painting& p) { p.strength = 0.5; })},
      {"skin.strength_up", "key Shift+]", is_near(&Painting::strength, 0.55), Shows::Nothing, "",
       with([](Painting& p) { p.strength = 0.5; })},
      {"skin.sample", "key Shift+X", [](Stage& s, const Seen&) { return s.editor().skin->painting->value != 0.3; },
       Shows::Nothing, "move \"3D view/view\"\n wait-idle", with([](Painting& p) { p.value = 0.3; })},
      {"skin.reach_surface", "click \"Edit/Brush reach/Surface\"", is(&Painting::depth, BrushDepth::Surface)},
      {"skin.reach_through", "click \"Edit/Brush reach/All depths\"", is(&Painting::depth, BrushDepth::Through)},
      {"skin.reach_depth", "click \"Edit/Brush reach/To a depth\"", is(&Painting::depth, BrushDepth::ToDepth)},
      {"skin.along_tissue", "click \"Edit/Brush reach/Geodesic\"", is(&Painting::distance, BrushDistance::Euclidean)},
      {"skin.paint_soft", "click \"Edit/Brush reach/Soft tissue\"", is(&Painting::tissue, PaintedTissue::Soft)},
      {"skin.paint_chosen", "click \"Edit/Brush reach/Selected tissue\"", is(&Painting::tissue, PaintedTissue::Chosen)},
      {"skin.paint_visible", "click \"Edit/Brush reach/Visible tissue\"",
       is(&Painting::tissue, PaintedTissue::Visible)},
      {"skin.paint_all", "click \"Edit/Brush reach/All tissue\"", is(&Painting::tissue, PaintedTissue::All)},
      {"skin.subtree", "click \"Edit/Brush reach/Bone hierarchy\"", is(&Painting::subtree, true)},
      {"skin.normalize_all", "click \"Edit/Brush reach/Normalize: all\"", is(&Painting::normalize, Normalize::All)},
      {"skin.normalize_unlocked", "click \"Edit/Brush reach/Normalize: unlocked\"",
       is(&Painting::normalize, Normalize::Unlocked)},
      {"skin.normalize_off", "click \"Edit/Brush reach/Normalize: off\"",
       is(&Painting::normalize, Normalize::WhenComposed), Shows::Nothing,
       "move \"3D view/view\"\n key Shift+Ctrl+L\n wait-idle"},
      {"skin.relative_to_locks", "click \"Edit/Brush reach/Relative to locks\"",
       is(&Painting::relative_to_locks, true)},
      {"skin.accumulate", "click \"Edit/Brush/Accumulate\"", is(&Painting::accumulate, true)},
      {"skin.falloff_sphere", "click \"Edit/Brush/Falloff/Sphere falloff\"",
       is(&Painting::falloff, FalloffShape::Sphere)},
      {"skin.falloff_root", "click \"Edit/Brush/Falloff/Root falloff\"", is(&Painting::falloff, FalloffShape::Root)},
      {"skin.falloff_sharp", "click \"Edit/Brush/Falloff/Sharp falloff\"", is(&Painting::falloff, FalloffShape::Sharp)},
      {"skin.falloff_linear", "click \"Edit/Brush/Falloff/Linear falloff\"",
       is(&Painting::falloff, FalloffShape::Linear)},
      {"skin.falloff_constant", "click \"Edit/Brush/Falloff/Constant falloff\"",
       is(&Painting::falloff, FalloffShape::Constant)},
      {"skin.falloff_own", "click \"Edit/Brush/Falloff/Custom falloff\"",
       [](Stage& s, const Seen&) { return !s.editor().skin->painting->falloff_curve.empty(); }},
      {"skin.falloff_smooth", "click \"Edit/Brush/Falloff/Smooth falloff\"",
       is(&Painting::falloff, FalloffShape::Smooth)},
  };
  // Covers the brushes that have no key of their own.
  for (const BrushRule& rule : brush_rules())
    if (const std::string id = operator_of(rule);
        std::none_of(all.begin(), all.end(), [&](const Proof& proof) { return proof.id == id; }))
      all.insert(all.begin() + 1, Proof{id, "click \"strip/" + id + "\"", is(&Painting::kind, rule.kind)});
  return all;
}

TEST_CASE("operators: weights are painted with brushes") {
  Stage stage;
  stage.open_limb();
  prove(stage, proofs_of_painting());
}

}  // namespace limber::test
