// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/paint/brush_rule.h"

namespace limber {

// Each function returns one brush of the table, and is defined in that brush's source file in core/paint/brushes.
BrushRule add_brush();
BrushRule subtract_brush();
BrushRule set_brush();
BrushRule multiply_brush();
BrushRule smooth_brush();
BrushRule sharpen_brush();
BrushRule average_brush();
BrushRule smear_brush();
BrushRule joint_capsule_brush();
BrushRule clone_brush();

namespace {

std::vector<BrushRule> numbered(std::vector<BrushRule> rules) {
  for (std::size_t i = 0; i < rules.size(); ++i) rules[i].kind = static_cast<BrushKind>(i);
  return rules;
}

}  // namespace

std::span<const BrushRule> brush_rules() {
  static const std::vector<BrushRule> kBrushes = numbered({
      add_brush(),
      subtract_brush(),
      set_brush(),
      multiply_brush(),
      smooth_brush(),
      sharpen_brush(),
      average_brush(),
      smear_brush(),
      joint_capsule_brush(),
      clone_brush(),
  });
  return kBrushes;
}

const BrushRule& rule_of(BrushKind kind) { return brush_rules()[static_cast<std::size_t>(kind)]; }

const BrushRule* find_brush(std::string_view id) {
  for (const BrushRule& rule : brush_rules())
    if (rule.id == id) return &rule;
  return nullptr;
}

}  // namespace limber
