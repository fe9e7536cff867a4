// SPDX-License-Identifier: AGPL-3.0-or-later
// Operators that arrange the views and panels of the window, and that set what the views show.
#include "editor/context/operator_polls.h"
#include "editor/context/pointer_context.h"
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
          [views](Editor& e) {
            e.arrangement().views = views;
            e.arrangement().maximized.reset();
          },
          nullptr,
          [views](const Editor& e) { return e.arrangement().views == views && !e.arrangement().maximized; }};
}

Operator display_operator(const char* id, const char* label, const char* description, render::Display display) {
  return {id,          label,
          "",          "View",
          description, [display](Editor& e) { e.views->display = display; },
          nullptr,     [display](const Editor& e) { return e.views->display == display; }};
}

Operator overlay_operator(const char* id, const char* label, const char* description, bool Views::*shown) {
  return {id,          label,
          "",          "View",
          description, [shown](Editor& e) { (*e.views).*shown = !((*e.views).*shown); },
          nullptr,     [shown](const Editor& e) { return (*e.views).*shown; }};
}

Operator shape_operator(const char* id, const char* label, const char* description, render::BoneShape shape) {
  return {id,          label,
          "",          "View",
          description, [shape](Editor& e) { e.views->bone_shape = shape; },
          nullptr,     [shape](const Editor& e) { return e.views->bone_shape == shape; }};
}

void maximize(Editor& editor) {
  auto& maximized = editor.arrangement().maximized;
  if (maximized) return maximized.reset();
  const ViewPlace* view = hovered_view(editor);
  maximized = view ? view->id : editor.views->active;
}

// Selects the bone or tissue under the pointer, and opens a context menu with commands for the selection.
void open_context_menu(Editor& editor) {
  if (const auto bone = editor.workspace == Workspace::Rig || editor.workspace == Workspace::Pose
                            ? bone_at_pointer(editor)
                            : std::nullopt) {
    if (!editor.selection.bones.contains(*bone)) editor.selection.bones = {*bone};
    editor.selection.bone = bone;
    editor.open_popup = editor.workspace == Workspace::Pose ? "Posed bone" : "Bone";
    return;
  }
  const Hover& hover = editor.views->hover;
  if (hover.inside && !editor.selection.tissues.contains(hover.label)) select_tissue(editor, hover.label, false);
  editor.open_popup = "context";
}

void search_outliner(Editor& editor) {
  editor.arrangement().sidebar = true;
  editor.open_sections["Outliner"] = editor.outliner.searching = editor.outliner.focus_search = true;
  await_field(editor);
}

void toggle_xray(Editor& editor) {
  editor.views->display =
      editor.views->display == render::Display::XRay ? render::Display::Solid : render::Display::XRay;
}

bool timeline_seen(const Editor& editor) { return editor.arrangement().timeline && !editor.arrangement().console; }
void toggle_timeline(Editor& editor) {
  editor.arrangement().timeline = !timeline_seen(editor);
  if (editor.arrangement().timeline) editor.arrangement().console = false;
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
       [](const Editor& e) { return e.arrangement().maximized.has_value(); }},
      display_operator("view.solid", "Solid", "Show the outermost visible tissue opaque.", render::Display::Solid),
      display_operator("view.xray_display", "X-ray", "Show soft tissue transparent around the bones.",
                       render::Display::XRay),
      display_operator("view.tissue", "Tissue", "Show every tissue with the opacity that is set for it.",
                       render::Display::Tissue),
      {"view.xray", "Toggle X-ray", "", "View", "Switch between the displays Solid and X-ray.", toggle_xray, nullptr,
       [](const Editor& e) { return e.views->display == render::Display::XRay; }},
      overlay_operator("view.grid", "Grid", "Show the grid on the ground.", &Views::grid),
      overlay_operator("view.axes", "Axes", "Show the axis ball, which shows the direction of view.", &Views::axes),
      overlay_operator("view.scale_bar", "Scale bar", "Show a scale bar in every view.", &Views::scale_bar),
      overlay_operator("view.rulers", "Rulers", "Show rulers in mm along the edges of the slices.", &Views::rulers),
      overlay_operator("view.letters", "Orientation letters",
                       "Show letters for the sides of the body, such as L and R.", &Views::letters),
      overlay_operator("view.bones", "Bones", "Show the skeleton in the views.", &Views::bones),
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
       [](Editor& e) { e.arrangement().sidebar = e.layout.sidebar.empty(); }, nullptr,
       [](const Editor& e) { return !e.layout.sidebar.empty(); }},
      {"view.tool_strip", "Tool strip", "", "View", "Show or hide the tools at the left edge of the window.",
       [](Editor& e) { e.arrangement().tool_strip = !e.arrangement().tool_strip; }, nullptr,
       [](const Editor& e) { return e.arrangement().tool_strip; }},
      {"view.timeline", "Timeline", icon::kMotion, "View", "Open or close the timeline below the views.",
       toggle_timeline, nullptr, timeline_seen},
      {"view.console", "Console", icon::kConsole, "Help", "Open or close the list of messages below the views.",
       [](Editor& e) { e.arrangement().console = !e.arrangement().console; }, nullptr,
       [](const Editor& e) { return e.arrangement().console; }},
      {"view.context_menu", "Context menu", "", "View",
       "Open a menu of commands for the bone or tissue under the pointer.", open_context_menu},
      {"view.pie", "View menu", icon::kCamera, "View", "Open a menu of the standard views at the pointer.",
       [](Editor& e) { e.open_popup = "Views"; }},
      {"view.shading_pie", "Display menu", "", "View",
       "Open a menu at the pointer that selects how tissue is shown, such as Solid or X-ray.",
       [](Editor& e) { e.open_popup = "Display"; }},
      {"view.full_screen", "Full screen", icon::kExpand, "View",
       "Enlarge the window to the full screen, or restore it.", [](Editor& e) { e.host.toggle_full_screen(); }},
  };
}

}  // namespace limber::editor
