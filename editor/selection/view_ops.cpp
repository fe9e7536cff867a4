// SPDX-License-Identifier: AGPL-3.0-or-later
// Operators that arrange the views and panels of the window, and that set what the views show.
#include "editor/context/context.h"
#include "editor/context/menu_state.h"
#include "editor/context/operator.h"
#include "editor/context/operator_polls.h"
#include "editor/context/outliner_state.h"
#include "editor/context/platform_window.h"
#include "editor/context/pointer_context.h"
#include "editor/context/screen.h"
#include "editor/context/selection.h"
#include "editor/context/views.h"
#include "editor/selection/transform_gizmo.h"
#include "editor/ui/icons.h"
#include "editor/ui/keyboard.h"
#include "editor/volume/tissue_edits.h"

namespace limber::editor {

namespace {

Operator layout_operator(const char* id, const char* label, const char* icon, const char* description,
                         ViewLayout views) {
  return {id,
          label,
          icon,
          "View",
          description,
          [views](Context& c) {
            c.screen->arrangement().views = views;
            c.screen->arrangement().maximized.reset();
          },
          nullptr,
          [views](const Context& c) {
            return c.screen->arrangement().views == views && !c.screen->arrangement().maximized;
          }};
}

Operator display_operator(const char* id, const char* label, const char* description, render::Display display) {
  return {id,          label,
          "",          "View",
          description, [display](Context& c) { c.views->display = display; },
          nullptr,     [display](const Context& c) { return c.views->display == display; }};
}

Operator overlay_operator(const char* id, const char* label, const char* description, bool Views::*shown) {
  return {id,          label,
          "",          "View",
          description, [shown](Context& c) { (*c.views).*shown = !((*c.views).*shown); },
          nullptr,     [shown](const Context& c) { return (*c.views).*shown; }};
}

Operator shape_operator(const char* id, const char* label, const char* description, render::BoneShape shape) {
  return {id,          label,
          "",          "View",
          description, [shape](Context& c) { c.views->bone_shape = shape; },
          nullptr,     [shape](const Context& c) { return c.views->bone_shape == shape; }};
}

void maximize(Context& context) {
  auto& maximized = context.screen->arrangement().maximized;
  if (maximized) return maximized.reset();
  const ViewPlace* view = hovered_view(context);
  maximized = view ? view->id : context.views->active;
}

// Selects the bone or tissue under the pointer, and opens a context menu with commands for the selection.
void open_context_menu(Context& context) {
  if (const auto bone = context.workspace() == Workspace::Rig || context.workspace() == Workspace::Pose
                            ? bone_at_pointer(context)
                            : std::nullopt) {
    if (!context.selection->bones.contains(*bone)) context.selection->bones = {*bone};
    context.selection->bone = bone;
    context.menus->open_popup = context.workspace() == Workspace::Pose ? "Posed bone" : "Bone";
    return;
  }
  const Hover& hover = context.views->hover;
  if (hover.inside && !context.selection->tissues.contains(hover.label)) select_tissue(context, hover.label, false);
  context.menus->open_popup = "context";
}

void search_outliner(Context& context) {
  context.screen->arrangement().sidebar = true;
  context.ui->open_sections["Outliner"] = context.outliner->searching = context.outliner->focus_search = true;
  await_field(context.ui);
}

void toggle_xray(Context& context) {
  context.views->display =
      context.views->display == render::Display::XRay ? render::Display::Solid : render::Display::XRay;
}

bool timeline_seen(const Context& context) {
  return context.screen->arrangement().timeline && !context.screen->arrangement().console;
}
void toggle_timeline(Context& context) {
  context.screen->arrangement().timeline = !timeline_seen(context);
  if (context.screen->arrangement().timeline) context.screen->arrangement().console = false;
}

}  // namespace

std::vector<Operator> view_operators() {
  return {
      layout_operator("view.one", "One view", icon::kOneView, "Show only the 3D view.", ViewLayout::One),
      layout_operator("view.split", "3D and slices", icon::kSplitViews, "Show the 3D view and two slices beside it.",
                      ViewLayout::Split),
      layout_operator("view.four", "Four views", icon::kFourViews, "Show the 3D view and three linked slices.",
                      ViewLayout::Four),
      {"view.maximize", "Maximize area", icon::kFullScreen, "View",
       "Enlarge the view under the pointer to the whole window, or restore it.", maximize, nullptr,
       [](const Context& c) { return c.screen->arrangement().maximized.has_value(); }},
      display_operator("view.solid", "Solid", "Show the outermost visible tissue opaque.", render::Display::Solid),
      display_operator("view.xray_display", "X-ray", "Show soft tissue transparent around the bones.",
                       render::Display::XRay),
      display_operator("view.tissue", "Tissue", "Show every tissue with the opacity that is set for it.",
                       render::Display::Tissue),
      {"view.xray", "Toggle X-ray", "", "View", "Switch between the displays Solid and X-ray.", toggle_xray, nullptr,
       [](const Context& c) { return c.views->display == render::Display::XRay; }},
      overlay_operator("view.grid", "Grid", "Show the grid on the ground.", &Views::grid),
      overlay_operator("view.axes", "Axes", "Show the axis ball, which shows the direction of view.", &Views::axes),
      overlay_operator("view.scale_bar", "Scale bar", "Show a scale bar in every view.", &Views::scale_bar),
      overlay_operator("view.rulers", "Rulers", "Show rulers in mm along the edges of the slices.", &Views::rulers),
      overlay_operator("view.letters", "Orientation letters",
                       "Show letters for the sides of the body, such as L and R.", &Views::letters),
      overlay_operator("view.bones", "Bones", "Show the rig's bones in the views.", &Views::bones),
      shape_operator("view.bones_octahedron", "Octahedra", "Draw bones as octahedra that are wide at the head.",
                     render::BoneShape::Octahedron),
      shape_operator("view.bones_stick", "Sticks", "Draw bones as thin sticks between their joints.",
                     render::BoneShape::Stick),
      shape_operator("view.bones_cylinder", "Cylinders", "Draw bones as cylinders.", render::BoneShape::Cylinder),
      overlay_operator("view.bone_names", "Bone names", "Show the name of each bone beside it in the 3D view.",
                       &Views::bone_names),
      overlay_operator("view.bone_axes", "Bone axes",
                       "Show each bone's local axes at its tail in the 3D view. The y axis points along the bone.",
                       &Views::bone_axes),
      overlay_operator("view.bones_in_front", "Bones in front", "Draw bones over the body instead of inside it.",
                       &Views::bones_in_front),
      overlay_operator("view.cross_hair", "Cross-hair", "Show the cross-hair at the point where the slices meet.",
                       &Views::show_cross_hair),
      {"view.find", "Search the project", icon::kSearch, "View", "Find a tissue, a bone or a result in the outliner.",
       search_outliner},
      {"view.sidebar", "Sidebar", "", "View", "Open or close the sidebar.",
       [](Context& c) { c.screen->arrangement().sidebar = c.screen->layout.sidebar.empty(); }, nullptr,
       [](const Context& c) { return !c.screen->layout.sidebar.empty(); }},
      {"view.tool_strip", "Tool strip", "", "View", "Show or hide the tools at the left edge of the window.",
       [](Context& c) { c.screen->arrangement().tool_strip = !c.screen->arrangement().tool_strip; }, nullptr,
       [](const Context& c) { return c.screen->arrangement().tool_strip; }},
      {"view.timeline", "Timeline", icon::kMotion, "View", "Open or close the timeline below the views.",
       toggle_timeline, nullptr, timeline_seen},
      {"view.console", "Console", icon::kConsole, "Help", "Open or close the list of messages below the views.",
       [](Context& c) { c.screen->arrangement().console = !c.screen->arrangement().console; }, nullptr,
       [](const Context& c) { return c.screen->arrangement().console; }},
      {"view.context_menu", "Context menu", "", "View",
       "Open a menu of commands for the bone or tissue under the pointer.", open_context_menu},
      {"view.pie", "View menu", icon::kCamera, "View", "Open a menu of the standard views at the pointer.",
       [](Context& c) { c.menus->open_popup = "Views"; }},
      {"view.shading_pie", "Display menu", "", "View",
       "Open a menu at the pointer that selects how tissue is shown, such as Solid or X-ray.",
       [](Context& c) { c.menus->open_popup = "Display"; }},
      {"view.full_screen", "Full screen", icon::kExpand, "View",
       "Enlarge the window to the full screen, or restore it.", [](Context& c) { c.host->toggle_full_screen(); }},
  };
}

}  // namespace limber::editor
