// SPDX-License-Identifier: AGPL-3.0-or-later
// How the window and its pictures are arranged and shown.
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

// What is under the pointer becomes what the menu's commands work on.
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
      layout_operator("view.one", "One view", icon::kOneView, "The 3D view alone.", ViewLayout::One),
      layout_operator("view.split", "3D and slices", icon::kSplitViews, "The 3D view and two slices beside it.",
                      ViewLayout::Split),
      layout_operator("view.four", "Four views", icon::kFourViews, "The 3D view and three linked slices.",
                      ViewLayout::Four),
      {"view.maximize", "Maximize area", icon::kFullScreen, "View",
       "The area under the pointer fills the window, or shrinks back.", maximize, nullptr,
       [](const Editor& e) { return e.arrangement().maximized.has_value(); }},
      display_operator("view.solid", "Solid", "Shows the outermost visible tissue, opaque.", render::Display::Solid),
      display_operator("view.xray_display", "X-ray", "Shows flesh as a ghost around the bones.", render::Display::XRay),
      display_operator("view.tissue", "Tissue", "Shows every tissue with its own opacity.", render::Display::Tissue),
      {"view.xray", "Toggle X-ray", "", "View", "Changes between solid and X-ray.", toggle_xray, nullptr,
       [](const Editor& e) { return e.views->display == render::Display::XRay; }},
      overlay_operator("view.grid", "Grid", "Shows the ground grid.", &Views::grid),
      overlay_operator("view.axes", "Axes", "Shows the axis ball.", &Views::axes),
      overlay_operator("view.scale_bar", "Scale bar", "Shows a scale bar in every view.", &Views::scale_bar),
      overlay_operator("view.letters", "Orientation letters", "Shows which side of the body is where.",
                       &Views::letters),
      overlay_operator("view.bones", "Bones", "Shows the skeleton in the views.", &Views::bones),
      shape_operator("view.bones_octahedron", "Octahedra", "Draws bones as octahedra, wide at the head.",
                     render::BoneShape::Octahedron),
      shape_operator("view.bones_stick", "Sticks", "Draws bones as thin sticks between their joints.",
                     render::BoneShape::Stick),
      shape_operator("view.bones_cylinder", "Cylinders", "Draws bones as cylinders.", render::BoneShape::Cylinder),
      overlay_operator("view.bone_names", "Bone names", "Shows bones' names beside them in the 3D view.",
                       &Views::bone_names),
      overlay_operator("view.bone_axes", "Bone axes",
                       "Shows bones' own axes at their tails in the 3D view: y along the bone.", &Views::bone_axes),
      overlay_operator("view.bones_in_front", "Bones in front", "Draws bones over the body that hides them.",
                       &Views::bones_in_front),
      overlay_operator("view.cross_hair", "Cross-hair", "Shows where the slices meet.", &Views::show_cross_hair),
      {"view.find", "Search the project", icon::kSearch, "View", "Finds a tissue, a bone or a result in the outliner.",
       search_outliner},
      {"view.sidebar", "Sidebar", "", "View", "Opens or closes the sidebar.",
       [](Editor& e) { e.arrangement().sidebar = e.layout.sidebar.empty(); }, nullptr,
       [](const Editor& e) { return !e.layout.sidebar.empty(); }},
      {"view.tool_strip", "Tool strip", "", "View", "Shows or hides the tools at the left.",
       [](Editor& e) { e.arrangement().tool_strip = !e.arrangement().tool_strip; }, nullptr,
       [](const Editor& e) { return e.arrangement().tool_strip; }},
      {"view.timeline", "Timeline", icon::kMotion, "View", "Opens or closes the timeline below the views.",
       toggle_timeline, nullptr, timeline_seen},
      {"view.console", "Console", icon::kConsole, "Help", "Opens or closes the list of messages below the views.",
       [](Editor& e) { e.arrangement().console = !e.arrangement().console; }, nullptr,
       [](const Editor& e) { return e.arrangement().console; }},
      {"view.context_menu", "Menu", "", "View", "Lists what can be done with what is under the pointer.",
       open_context_menu},
      {"view.pie", "View menu", icon::kCamera, "View", "Lists the standard views at the pointer.",
       [](Editor& e) { e.open_popup = "Views"; }},
      {"view.shading_pie", "Display menu", "", "View", "Lists the displays at the pointer.",
       [](Editor& e) { e.open_popup = "Display"; }},
      {"view.full_screen", "Full screen", icon::kExpand, "View", "The window fills the screen, or shrinks back.",
       [](Editor& e) { e.host.toggle_full_screen(); }},
  };
}

}  // namespace limber::editor
