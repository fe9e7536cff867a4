// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/context/operator.h"

namespace limber::editor {

// Each function returns the operators that are defined in one file *_ops.cpp. The functions stand in the order of the
// menus.
std::vector<Operator> file_operators();
std::vector<Operator> import_operators();
std::vector<Operator> export_operators();
std::vector<Operator> edit_operators();
std::vector<Operator> workspace_operators();
std::vector<Operator> view_operators();
std::vector<Operator> navigation_operators();
std::vector<Operator> clip_operators();
std::vector<Operator> slice_operators();
std::vector<Operator> image_operators();
std::vector<Operator> measure_operators();
std::vector<Operator> tissue_operators();
std::vector<Operator> select_operators();
std::vector<Operator> search_operators();
std::vector<Operator> preferences_operators();
std::vector<Operator> prepare_operators();
std::vector<Operator> rig_fit_operators();
std::vector<Operator> skin_operators();
std::vector<Operator> paint_operators();
std::vector<Operator> brush_preset_operators();
std::vector<Operator> weight_edit_operators();
std::vector<Operator> region_operators();
std::vector<Operator> skin_display_operators();
std::vector<Operator> layer_operators();
std::vector<Operator> test_pose_operators();
std::vector<Operator> weight_problem_operators();
std::vector<Operator> joint_repair_operators();
std::vector<Operator> seam_operators();
std::vector<Operator> label_edit_operators();
std::vector<Operator> label_brush_operators();
std::vector<Operator> bone_table_operators();
std::vector<Operator> rig_operators();
std::vector<Operator> pose_operators();
std::vector<Operator> motion_operators();
std::vector<Operator> graph_operators();
std::vector<Operator> strip_operators();
std::vector<Operator> motion_clean_operators();
std::vector<Operator> clip_deed_operators();
std::vector<Operator> clip_join_operators();
std::vector<Operator> motion_reduce_operators();
std::vector<Operator> constraint_operators();
std::vector<Operator> motion_clip_operators();
std::vector<Operator> resample_operators();
std::vector<Operator> help_operators();

std::vector<Operator> gather_operators() {
  std::vector<Operator> all;
  for (auto list : {file_operators,         import_operators,         export_operators,       edit_operators,
                    workspace_operators,    view_operators,           navigation_operators,   clip_operators,
                    slice_operators,        image_operators,          measure_operators,      tissue_operators,
                    select_operators,       search_operators,         preferences_operators,  prepare_operators,
                    rig_fit_operators,      skin_operators,           paint_operators,        brush_preset_operators,
                    weight_edit_operators,  region_operators,         skin_display_operators, layer_operators,
                    test_pose_operators,    weight_problem_operators, joint_repair_operators, seam_operators,
                    label_edit_operators,   label_brush_operators,    bone_table_operators,   rig_operators,
                    pose_operators,         motion_operators,         graph_operators,        strip_operators,
                    motion_clean_operators, clip_deed_operators,      clip_join_operators,    motion_reduce_operators,
                    constraint_operators,   motion_clip_operators,    resample_operators,     help_operators})
    for (Operator& op : list()) all.push_back(std::move(op));
  return all;
}

}  // namespace limber::editor
