// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/skin/painting.h"

#include <algorithm>
#include <span>
#include <utility>

#include "editor/labels/label_brush.h"

namespace limber::editor {

Painting::Painting() : labels(std::make_unique<LabelBrush>()) {}
Painting::~Painting() = default;

std::string name_of(BrushKind kind) { return rule_of(kind).name; }

std::string operator_of(const BrushRule& rule) { return "skin.brush_" + rule.id; }

std::vector<std::string> with_brushes(std::vector<std::string> list) {
  std::vector<std::string> brushes;
  bool plain = true;
  for (const BrushRule& rule : brush_rules()) {
    if (std::exchange(plain, rule.paint != nullptr) && !rule.paint) brushes.push_back("-");
    brushes.push_back(operator_of(rule));
  }
  const auto place = std::find(list.begin(), list.end(), "*");
  if (place != list.end()) list.insert(list.erase(place), brushes.begin(), brushes.end());
  return list;
}

Falloff falloff_of(const Painting& painting) {
  return painting.falloff_curve.empty() ? Falloff(painting.falloff)
                                        : Falloff(std::span<const glm::dvec2>(painting.falloff_curve));
}

void begin_falloff_curve(Painting& painting) {
  constexpr int kParts = 4;
  const Falloff shape = falloff_of(painting);
  painting.falloff_curve.clear();
  for (int i = 0; i <= kParts; ++i) painting.falloff_curve.emplace_back(double(i) / kParts, shape(float(i) / kParts));
}

}  // namespace limber::editor
