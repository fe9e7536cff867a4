// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/context/pointer_context.h"

#include <algorithm>

#include <imgui_internal.h>

#include "editor/context/context.h"
#include "editor/context/screen.h"
#include "editor/context/views.h"
#include "editor/ui/ui.h"

namespace limber::editor {

namespace {

// Returns true if the pointer is over the ImGui window of a region: the sidebar or the bottom area, where the 3D view's
// keys must not work.
bool is_over(const char* region) {
  const ImGuiWindow* window = ImGui::GetCurrentContext()->HoveredWindow;
  return window && std::string_view(window->RootWindow->Name) == region;
}

bool over_strips(const Ui& ui) {
  const auto& widgets = ui.widgets.widgets();
  return std::any_of(widgets.begin(), widgets.end(), [&](const Widget& widget) {
    return widget.region == Region::Bottom && widget.name.ends_with("timeline/strips") &&
           widget.rect.contains(ui.input.pointer);
  });
}

}  // namespace

bool over_timeline(const Context& context) {
  const ImGuiWindow* window = ImGui::GetCurrentContext()->HoveredWindow;
  return window && std::string_view(window->RootWindow->Name) == "##bottom" &&
         context.screen->timeline_area.contains(context.ui->input.pointer) && context.screen->arrangement().timeline &&
         !context.screen->arrangement().console;
}

bool over_widget(const Ui& ui) {
  const auto& widgets = ui.widgets.widgets();
  return std::any_of(widgets.begin(), widgets.end(), [&](const Widget& widget) {
    return widget.region == Region::Views && !widget.name.ends_with("/view") && widget.rect.contains(ui.input.pointer);
  });
}

const ViewPlace* hovered_view(const Context& context) {
  const ImGuiWindow* window = ImGui::GetCurrentContext()->HoveredWindow;
  if (window && std::string_view(window->RootWindow->Name) != "##views") return nullptr;
  return context.screen->layout.view_at(context.ui->input.pointer);
}

std::vector<std::string> contexts(const Context& context) {
  std::vector<std::string> contexts;
  const ViewPlace* view = hovered_view(context);
  if (view && view->id != ViewId::Body) contexts.push_back("slice");
  if (view && view->id == ViewId::Body) contexts.push_back("view3d");
  if (over_timeline(context) && context.screen->graph_area.contains(context.ui->input.pointer))
    contexts.push_back("graph");
  if (over_timeline(context) && over_strips(context.ui)) contexts.push_back("strips");
  if (over_timeline(context)) contexts.push_back("timeline");
  if (is_over("##sidebar")) contexts.push_back("sidebar");
  constexpr const char* kWorkspaces[] = {"rig", "skin", "pose", "resample"};
  contexts.push_back(kWorkspaces[static_cast<int>(context.workspace())]);
  contexts.push_back("select");
  if (!view && !is_over("##sidebar") && !is_over("##bottom")) contexts.push_back("view3d");
  contexts.push_back("global");
  return contexts;
}

}  // namespace limber::editor
