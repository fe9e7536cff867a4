// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/ui/widget_registry.h"

#include "core/base/error.h"

namespace limber::editor {

void WidgetRegistry::begin_frame() {
  building_.clear();
  building_texts_.clear();
}

void WidgetRegistry::end_frame() {
  shown_.swap(building_);
  shown_texts_.swap(building_texts_);
}

const Widget* WidgetRegistry::find(std::string_view name) const {
  const Widget* ending = nullptr;
  int endings = 0;
  for (const Widget& widget : shown_) {
    if (widget.name == name) return &widget;
    if (widget.name.size() > name.size() && widget.name.ends_with(name) &&
        widget.name[widget.name.size() - name.size() - 1] == '/') {
      ending = &widget;
      ++endings;
    }
  }
  if (endings > 1)
    throw Error("several widgets have this name", std::string(name), "write its path, such as " + ending->name);
  return ending;
}

}  // namespace limber::editor
