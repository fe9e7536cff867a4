// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/screen/menus.h"

#include "core/motion/constraint_rule.h"
#include "editor/context/context.h"
#include "editor/context/operator_button.h"
#include "editor/context/operator_registry.h"
#include "editor/context/views.h"
#include "editor/resample/resample_job.h"
#include "editor/skin/painting.h"
#include "editor/ui/widgets.h"

namespace limber::editor {

namespace {

using Entry = std::vector<std::string>::const_iterator;

// Returns the entry "<" that ends the submenu whose title is `entry`. A submenu may contain other submenus.
Entry end_of(Entry entry, Entry end) {
  int depth = 0;
  for (; entry != end; ++entry) {
    if (entry->starts_with("> ")) ++depth;
    if (*entry == "<" && --depth == 0) return entry;
  }
  return end;
}

// Replaces the entry "* methods" by one operator for each deformation method.
std::vector<std::string> with_methods(std::vector<std::string> list) {
  const std::vector<std::string> methods = method_operators(Methods::All);
  const auto place = std::find(list.begin(), list.end(), "* methods");
  if (place != list.end()) list.insert(list.erase(place), methods.begin(), methods.end());
  return list;
}

// Replaces the entry "* constraints" by one operator for each kind of constraint, which adds a constraint of this
// kind.
std::vector<std::string> with_constraints(std::vector<std::string> list) {
  const auto place = std::find(list.begin(), list.end(), "* constraints");
  if (place == list.end()) return list;
  std::vector<std::string> adding;
  for (const ConstraintRule& rule : constraint_rules()) adding.push_back("constraint.add_" + rule.id);
  list.insert(list.erase(place), adding.begin(), adding.end());
  return list;
}

bool any_operator(const OperatorRegistry& operators, Entry begin, Entry end) {
  return std::any_of(begin, end, [&](const std::string& id) { return find_operator(operators, id) != nullptr; });
}

// Draws the row that opens a submenu, and begins the submenu if it is open. The row has the height of the other rows,
// 22 px plus the spacing between rows. Its highlight is as wide as theirs: ImGui's own would begin at the title, so
// this function draws the highlight below the row once it is known whether the pointer is on the row.
bool begin_submenu(const Look& look, const std::string& title) {
  const ImVec2 corner = ImGui::GetCursorScreenPos(), spacing = ImGui::GetStyle().ItemSpacing;
  const float above = std::round((look.px(22) - ImGui::GetFontSize()) / 2), wide = ImGui::GetContentRegionAvail().x;
  ImDrawList& canvas = *ImGui::GetWindowDrawList();
  canvas.ChannelsSplit(2);
  canvas.ChannelsSetCurrent(1);
  ImGui::SetCursorPos({ImGui::GetCursorPosX() + look.px(34), ImGui::GetCursorPosY() + above});
  ImGui::PushStyleVar(ImGuiStyleVar_ItemSpacing,
                      ImVec2(spacing.x, look.px(22) - ImGui::GetFontSize() - above + spacing.y));
  for (const ImGuiCol colour : {ImGuiCol_Header, ImGuiCol_HeaderHovered, ImGuiCol_HeaderActive})
    ImGui::PushStyleColor(colour, 0u);
  const bool open = ImGui::BeginMenu(title.c_str());
  ImGui::PopStyleColor(3);
  ImGui::PopStyleVar();
  canvas.ChannelsSetCurrent(0);
  if (open || ImGui::IsItemHovered() || ImGui::IsItemFocused()) {
    const ImVec2 half{std::floor(spacing.x / 2), std::floor(spacing.y / 2)};
    canvas.AddRectFilled({corner.x - half.x, corner.y - half.y},
                         {corner.x + wide + half.x, corner.y + look.px(22) + half.y},
                         ImGui::GetColorU32(ImGuiCol_HeaderHovered));
  }
  canvas.ChannelsMerge();
  return open;
}

//   submenu  title of the submenu that the entries belong to; "": none
void draw_entries(Context& context, Entry begin, Entry end, const std::string& submenu = "") {
  bool line_wanted = false, any = false;
  for (Entry entry = begin; entry != end; ++entry) {
    if (*entry == "-") {
      line_wanted = any;
      continue;
    }
    const bool opens = entry->starts_with("> ");
    const Entry last = opens ? end_of(entry, end) : entry + 1;
    if (any_operator(context.operators, entry, last)) {
      if (line_wanted) ImGui::Separator();
      line_wanted = false;
      any = true;
      if (!opens) operator_menu_item(context, *entry, submenu);
      else {
        const std::string title = entry->substr(2);
        const bool open = begin_submenu(context.ui->look, title);
        if (!open)
          register_widget(context.ui, title, {from_im(ImGui::GetItemRectMin()), from_im(ImGui::GetItemRectMax())});
        if (open) {
          push_path(context.ui, title);
          draw_entries(context, entry + 1, last, title);
          pop_path(context.ui);
          ImGui::EndMenu();
        }
      }
    }
    entry = opens ? last : entry;
  }
}

}  // namespace

// clang-format is off here, because it would put the id of each operator on a line of its own.
// clang-format off
std::vector<Menu> menus() {
  std::vector<Menu> all = {
      {"File",
       {"file.new", "file.open",
        "> Open recent", "file.recent_1", "file.recent_2", "file.recent_3", "file.recent_4", "file.recent_5",
        "file.recent_6", "file.recent_7", "file.recent_8", "file.recent_9", "file.recent_10", "<",
        "> Samples", "file.sample_arm", "file.sample_arm_xray", "file.sample_body", "file.sample_body_open", "<",
        "file.open_recent", "-", "file.save", "file.save_as", "file.save_copy", "file.recover", "-",
        "> Import", "file.import", "file.import_volume", "file.import_dicom", "file.import_image", "file.import_rig",
        "file.import_motion", "file.import_weights", "file.import_tissues", "file.import_pose", "<",
        "> Export", "file.export_volume", "file.export_rig", "file.export_pose", "file.export_motion",
        "file.export_weights", "file.export_tissues", "file.export_gltf", "file.export_image",
        "view.screenshot", "file.export_figure", "view.turntable", "file.export_motion_pictures", "<",
        "-", "file.quit"}},
      {"Edit",
       {"edit.undo", "edit.redo", "edit.history", "-", "edit.repeat_last", "edit.adjust_last", "-",
        "> Select", "select.all", "select.none", "select.invert", "-", "select.box", "select.circle", "-",
        "select.parent", "select.child", "select.chain", "select.mirror", "-", "select.siblings", "select.children",
        "select.same_joint", "select.same_length", "<",
        "-", "edit.rename", "-",
        "> Prepare volume", "prepare.regrid", "prepare.flip_x", "prepare.flip_y", "prepare.flip_z",
        "prepare.orient", "prepare.crop", "prepare.crop_to_clip_box", "prepare.pad", "prepare.merge",
        "prepare.specks", "prepare.statistics", "-", "image.labels", "image.body",
        "> Labels", "labels.fill_holes", "labels.islands", "labels.grow", "labels.shrink", "labels.split", "-",
        "labels.brush", "labels.new_tissue", "labels.pick", "-",
        "labels.over_all", "labels.over_air", "labels.over_tissue", "labels.over_underneath", "-",
        "labels.erase_to_surroundings", "labels.erase_to_air", "-", "labels.flat", "labels.in_range", "<", "<",
        "> Rig", "rig.auto_fit", "rig.templates", "-", "rig.fit_joint_axis", "rig.joint_fit_before",
        "rig.joint_fit_after", "rig.take_joint_fit", "rig.leave_joint_fit", "-", "rig.next_leaving",
        "pose.apply_as_rest", "-", "rig.colour_bones", "rig.clear_bone_map", "<",
        "> Weights", "skin.heat", "skin.geodesic", "skin.rigid", "skin.compute", "skin.drop_weights", "-",
        "skin.find_seams", "skin.seam_brush", "skin.show_seams", "skin.clear_seams", "-", "skin.lock",
        "skin.lock_others", "skin.lock_all", "skin.unlock_all", "skin.invert_locks", "<",
        "> Brush", "*", "-", "skin.radius", "skin.strength", "skin.value", "skin.sample", "-",
        "> Falloff", "skin.falloff_smooth", "skin.falloff_sphere", "skin.falloff_root", "skin.falloff_sharp",
        "skin.falloff_linear", "skin.falloff_constant", "skin.falloff_own", "<",
        "skin.accumulate", "-",
        "> Presets", "skin.preset_save", "skin.preset_use", "skin.preset_delete", "<", "<",
        "> Brush reach", "skin.reach_surface", "skin.reach_depth", "skin.reach_through", "-", "skin.along_tissue",
        "-", "skin.paint_all", "skin.paint_soft", "skin.paint_chosen", "skin.paint_visible", "skin.subtree", "-",
        "skin.normalize_unlocked", "skin.normalize_all", "skin.normalize_off", "skin.relative_to_locks", "<",
        "> Bone", "rig.add", "rig.extrude", "rig.fill", "rig.duplicate", "rig.subdivide", "-", "rig.move",
        "rig.rotate", "rig.scale", "rig.roll", "rig.recalculate_roll", "rig.motion_range", "-", "rig.delete",
        "rig.dissolve", "-", "rig.parent", "rig.connect", "rig.clear_parent", "rig.separate", "rig.flip_direction",
        "-", "rig.mirror", "rig.symmetrize", "-", "rig.batch_rename", "<",
        "> Snapping", "rig.snap", "snap.steps", "snap.voxel", "snap.joint", "snap.bone_middle", "-",
        "rig.joints_to_bone", "rig.joints_to_voxels", "rig.joint_to_cross_hair", "rig.cross_hair_to_joint", "<",
        "> Pose", "pose.rotate", "pose.move", "-", "pose.push", "pose.relax", "pose.breakdown", "pose.blend_rest",
        "pose.blend_copied", "-", "pose.clear_rotation", "pose.clear_translation", "pose.clear", "-", "pose.copy",
        "pose.paste", "pose.paste_flipped", "pose.flip", "-", "pose.flex", "-", "pose.limits", "edit.x_mirror", "<",
        "> IK", "pose.auto_ik", "-", "pose.add_ik", "pose.pin", "pose.pole", "pose.clear_ik", "<",
        "> Pose library", "pose.library_add", "pose.library_apply", "pose.library_blend", "-",
        "pose.library_rename", "pose.library_delete", "<",
        "> Axes", "space.global", "space.local", "space.parent", "space.view", "<",
        "> Resample", "resample.run", "* methods",
        "result.watch", "result.toggle", "-", "compare.show_a", "compare.show_b", "compare.side_by_side",
        "compare.wipe", "compare.difference", "result.overlap", "compare.swap", "-", "result.rename", "report.open",
        "file.export", "result.copy_report", "result.delete", "result.delete_stale", "<",
        "-", "edit.keymap", "edit.preferences"}},
      {"View",
       {"view.one", "view.split", "view.four", "view.maximize", "-",
        "> Standard views", "view.front", "view.back", "view.left", "view.right", "view.top", "view.bottom",
        "view.opposite", "-", "view.ortho", "<",
        "view.frame_selected", "view.frame_all",
        "> Navigate", "view.walk", "view.centre_on_pick", "view.orbit_left", "view.orbit_right", "view.orbit_up",
        "view.orbit_down", "view.zoom_in", "view.zoom_out", "<",
        "-",
        "> Display", "view.solid", "view.xray_display", "view.tissue", "view.image_display", "-",
        "> Image settings", "image.window_soft", "image.window_bone", "image.window_lung", "image.window_brain",
        "image.window_all", "-", "image.render_bone", "image.render_muscle", "image.render_skin",
        "image.render_window", "image.render_maximum", "-", "image.labels", "image.body",
        "image.close", "<", "<",
        "> Weights", "skin.show_active", "skin.show_dominant", "skin.show_mixed", "skin.show_count",
        "skin.show_tissues", "skin.contours", "-", "skin.isolate_region", "skin.hide_region", "skin.reveal_regions",
        "-", "skin.find_bone", "<",
        "> Finite elements", "fem.show_tissues", "fem.show_volume_ratio", "fem.show_energy", "fem.show_gap", "-",
        "fem.tets", "<",
        "> Clipping", "view.clip_box", "view.clip_plane", "view.reset_clipping", "<",
        "> Tissues", "view.hide", "view.isolate_selected", "view.reveal", "<",
        "> Slices", "slice.show_labels", "slice.show_outlines", "slice.next", "slice.previous", "<",
        "> Overlays", "view.grid", "view.axes", "view.scale_bar", "view.letters", "view.bones", "view.rig_check",
        "view.cross_hair", "view.rulers", "-",
        "> Measure", "measure.distance", "measure.angle", "measure.girth", "measure.thickness", "-", "measure.show",
        "measure.rename", "measure.copy", "-", "measure.delete", "measure.clear", "<", "<",
        "> Bones", "view.bones_octahedron", "view.bones_stick", "view.bones_cylinder", "-", "view.bone_names",
        "view.bone_axes", "view.bones_in_front", "<",
        "-", "view.find", "view.sidebar", "view.tool_strip",
        "> Bottom panel", "view.timeline", "view.results", "view.console", "<",
        "view.full_screen"}},
      {"Motion",
       {"> Import", "file.import_motion", "<",
        "> Retarget", "motion.retarget", "motion.map", "motion.map_by_names", "motion.load_map", "motion.save_map",
        "-", "motion.travel_locked", "motion.travel_in_place", "motion.travel_free", "motion.mirror", "-",
        "motion.reference_found", "motion.reference_rest", "motion.reference_first", "-",
        "> Rest poses", "motion.rest_file", "motion.rest_t", "motion.rest_a", "motion.rest_anatomical", "-",
        "motion.rig_rest_file", "motion.rig_rest_t", "motion.rig_rest_a", "motion.rig_rest_anatomical", "<", "<",
        "> Clip", "motion.rename_clip", "motion.trim", "motion.untrim", "motion.resample", "-",
        "> Whole clip", "motion.mirror_clip", "motion.loop_clip", "motion.join_clip", "motion.speed", "motion.bake",
        "<", "-",
        "motion.clean", "motion.hold", "motion.close_gap", "motion.reduce_keys", "-",
        "> Export", "file.export_motion", "file.export_motion_pictures", "<", "-",
        "motion.delete_clip", "<",
        "-", "motion.play", "motion.play_reverse", "motion.frame_back", "motion.frame_forward", "motion.first",
        "motion.last",
        "> Playing", "motion.loop", "motion.ping_pong", "motion.faster", "motion.slower",
        "motion.play_at_file_rate", "<",
        "-", "motion.insert_key", "motion.delete_key", "motion.auto_key",
        "> Keys", "motion.next_key", "motion.previous_key", "motion.choose_all_keys", "motion.choose_no_keys", "-",
        "motion.move_keys", "motion.scale_keys", "motion.duplicate_keys", "motion.delete_keys", "-",
        "pose.blend_neighbour", "pose.propagate", "<",
        "> Curves", "graph.show", "graph.view_all", "graph.view_selected", "-",
        "graph.select_all", "graph.select_none", "graph.move", "graph.scale", "graph.duplicate", "graph.delete", "-",
        "> Interpolation", "graph.constant", "graph.linear", "graph.bezier", "-",
        "graph.ease_in", "graph.ease_out", "graph.ease_in_out", "<",
        "> Handles", "graph.handles_automatic", "graph.handles_clamped", "graph.handles_aligned",
        "graph.handles_free", "graph.handles_flat", "<", "<",
        "> Strips", "strips.show", "strips.make", "strips.add", "strips.bake", "-",
        "strips.select_all", "strips.select_none", "strips.move", "strips.duplicate", "strips.split", "strips.mute",
        "strips.delete", "-",
        "> Strip", "strips.bones_selected", "strips.bones_all", "strips.begin_here", "strips.clear_place", "<",
        "> Track", "strips.add_track", "strips.rename_track", "strips.track_up", "strips.track_down",
        "strips.mute_track", "strips.solo_track", "strips.delete_track", "<", "<",
        "> Constraints", "* constraints", "-", "constraint.toggle", "constraint.up", "constraint.down",
        "constraint.key_weight", "constraint.switch",
        "constraint.to_cross_hair", "-", "constraint.remove", "constraint.apply", "<",
        "-",
        "> Markers", "motion.marker", "motion.rename_marker", "motion.delete_marker", "<",
        "> Range", "motion.set_start", "motion.set_end", "motion.preview_range", "motion.clear_range",
        "motion.view_all", "motion.view_selected", "motion.show_seconds", "-", "motion.show_rows", "motion.next_face",
        "<",
        "> Onion skin and paths", "motion.onion_skin", "motion.onion_frames", "-", "motion.paths", "<"}},
      {"Help", {"help.guide", "help.keys", "help.tour", "help.new", "-", "search.commands", "view.console",
        "help.last_error", "help.system_facts", "-", "help.about"}},
  };
  for (Menu& menu : all) menu.entries = with_constraints(with_methods(with_brushes(std::move(menu.entries))));
  return all;
}

Menu pointer_menu(const std::string& name, ViewId view) {
  if (name == "Views") return {name, {"view.front", "view.back", "view.left", "view.right", "view.top", "view.bottom",
        "view.opposite", "-",
        "view.ortho", "view.frame_selected", "view.frame_all", "view.walk"}};
  if (name == "Measure") return {name, {"measure.distance", "measure.angle", "measure.girth", "measure.thickness",
        "-", "measure.show", "measure.copy", "measure.clear"}};
  if (name == "Display") return {name, {"view.solid", "view.xray_display", "view.tissue",
        "view.image_display", "-", "view.clip_box", "view.clip_plane"}};
  if (name == "Weight display")
    return {name, {"skin.show_active", "skin.show_dominant", "skin.show_mixed", "skin.show_count",
        "skin.show_tissues", "-",
        "skin.contours", "-", "skin.isolate_region", "skin.reveal_regions"}};
  if (name == "Finite elements") return {name, {"fem.show_tissues", "fem.show_volume_ratio", "fem.show_energy",
        "fem.show_gap", "-", "fem.tets"}};
  if (name == "Add constraint") return {name, with_constraints({"* constraints"})};
  if (name == "Brushes") return {name, with_brushes({"*"})};
  if (name == "Edit weights") return {name, {"skin.flood", "skin.gradient", "skin.fill_part", "skin.assign_tissue",
        "-", "skin.smooth_all", "skin.limit",
        "skin.prune", "skin.levels", "skin.quantize", "-", "skin.mirror_weights", "skin.copy_weights",
        "skin.transfer_weights", "-",
        "> Region", "skin.region_box", "skin.region_lasso", "skin.region_bone", "skin.region_unmatched",
        "skin.region_invert", "skin.region_clear", "<",
        "> Layers", "skin.layer_add", "skin.layer_rename", "skin.layer_show", "-", "skin.layer_up",
        "skin.layer_down", "skin.layer_merge", "-", "skin.layer_mask", "skin.layer_cover", "skin.layer_uncover",
        "-", "skin.layer_remove", "<",
        "> Test pose", "skin.posed", "skin.bend_more", "skin.bend_less", "skin.unbend", "<",
        "> Problems", "skin.find_problems", "skin.next_problem", "skin.previous_problem", "skin.repair_problem", "<",
        "skin.repair_joint"}};
  if (name == "Locks") return {name, {"skin.lock", "skin.lock_others", "-", "skin.lock_all", "skin.unlock_all",
        "skin.invert_locks"}};
  if (name == "Bone weights") return {"Bone", {"skin.lock", "skin.lock_others", "skin.unlock_all", "-",
        "skin.isolate_region", "skin.hide_region", "skin.reveal_regions"}};
  if (name == "Keys") return {name, {"motion.insert_key", "motion.delete_key", "motion.auto_key", "-",
        "motion.next_key", "motion.previous_key",
        "-", "motion.onion_skin", "motion.onion_frames"}};
  if (name == "Interpolation") return {name, {"graph.constant", "graph.linear", "graph.bezier", "-",
        "graph.ease_in", "graph.ease_out", "graph.ease_in_out"}};
  if (name == "Handles") return {name, {"graph.handles_automatic", "graph.handles_clamped", "graph.handles_aligned",
        "graph.handles_free", "graph.handles_flat"}};
  if (name == "Snap") return {name, {"snap.steps", "snap.voxel", "snap.joint", "snap.bone_middle", "rig.snap", "-",
        "rig.joints_to_bone",
        "rig.joints_to_voxels", "rig.joint_to_cross_hair", "rig.cross_hair_to_joint"}};
  if (name == "Similar") return {name, {"select.siblings", "select.children", "select.chain", "select.mirror", "-",
        "select.same_joint", "select.same_length"}};
  if (name == "Pose library") return {name, {"pose.library_apply", "pose.library_blend", "-", "pose.library_rename",
        "pose.library_delete"}};
  if (name == "Workspaces") return {name, {"workspace.rig", "workspace.skin", "workspace.pose", "workspace.resample"}};
  if (name == "Posed bone") return {"Bone", {"pose.copy", "pose.paste", "pose.paste_flipped", "-",
        "pose.clear_rotation", "pose.breakdown",
        "pose.library_add", "-", "motion.insert_key", "motion.delete_key", "-", "pose.pin", "pose.pole",
        "select.mirror"}};
  if (name == "Bone") return {"Bone", {"rig.extrude", "rig.subdivide", "rig.duplicate", "-", "rig.parent",
        "rig.clear_parent", "rig.symmetrize",
        "-", "rig.motion_range", "rig.fit_joint_axis", "edit.rename", "-", "rig.dissolve", "rig.delete"}};
  if (name == "Tissue")
    return {name, {"view.hide", "view.isolate_selected", "view.reveal", "view.frame_selected", "-",
        "skin.assign_tissue", "-",
        "edit.rename", "prepare.merge",
        "> Labels", "labels.brush", "-", "labels.fill_holes", "labels.islands", "labels.grow", "labels.shrink",
        "labels.split", "-", "labels.new_tissue", "<"}};
  if (name == "Edit labels") return {name, {"labels.fill_holes", "labels.islands", "labels.grow", "labels.shrink",
        "labels.split", "-", "labels.new_tissue", "labels.pick", "-", "prepare.merge", "prepare.specks"}};
  if (name == "Volume") return {name, {"view.reveal", "-", "prepare.regrid", "prepare.orient", "prepare.crop",
        "prepare.pad", "prepare.specks",
        "prepare.statistics", "-", "file.export_volume", "file.export_tissues"}};
  if (name == "Rig") return {name, {"view.bones", "view.bone_names", "view.bone_axes", "view.bones_in_front",
        "-", "skin.heat", "pose.flex",
        "pose.clear", "-", "file.import_rig", "file.export_rig"}};
  if (name == "Result") return {name, {"result.toggle", "edit.rename", "result.copy_report", "-", "result.delete",
        "result.delete_stale"}};
  if (view == ViewId::Body)
    return {"3D view", {"view.hide", "view.isolate_selected", "view.reveal", "-", "view.frame_selected",
        "view.frame_all",
        "view.centre_on_pick", "-", "view.clip_box", "view.clip_plane", "view.xray"}};
  return {name_of(view), {"view.hide", "view.isolate_selected", "view.reveal", "-", "slice.outline", "view.cross_hair",
        "view.frame_all", "-", "view.maximize"}};
}

void draw_menu(Context& context, const Menu& menu) { draw_entries(context, menu.entries.begin(), menu.entries.end()); }

}  // namespace limber::editor
