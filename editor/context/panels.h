// SPDX-License-Identifier: AGPL-3.0-or-later
// Declares the functions that draw the window's regions and the panels in them. Panels only draw and read the input; to
// change something, they run an operator.
#pragma once

#include "editor/context/editor.h"
#include "editor/ui/section.h"

namespace limber::editor {

// Regions of the window
void draw_top_bar(Editor& editor);
void draw_tool_header(Editor& editor);
void draw_tool_strip(Editor& editor);
void draw_views_region(Editor& editor);
void draw_sidebar(Editor& editor);
void draw_bottom(Editor& editor);
void draw_status_bar(Editor& editor);
void draw_splitters(Editor& editor);
void draw_start_screen(Editor& editor);
void draw_tour(Editor& editor);

// Overlays, drawn over the pictures of the views
void draw_body_overlay(Editor& editor, const ViewPlace& place);
void draw_slice_overlay(Editor& editor, const ViewPlace& place);
bool draw_weight_legend(Editor& editor, const Rect& view);  // returns true if a legend was drawn
bool draw_fem_legend(Editor& editor, const Rect& view);     // returns true if a legend was drawn
// Draws the legend of the marked voxels. These are the voxels in which two volumes differ, or the voxels in which
// parts of the posed body overlap. Returns the legend's height in pixels at scale 1; 0: no legend.
float draw_marks_legend(Editor& editor, const Rect& view);
// Draws a label in place of the title of a view that shows one of two compared results: A or B, and the result's name.
void draw_side_chip(Editor& editor, const ViewPlace& place);
void put_swatch(const Look& look, const glm::vec2& corner, Colour colour);
void draw_weights_at_pointer(Editor& editor);
void draw_empty_view(Editor& editor, const Rect& rect);
void draw_scale_bar(Editor& editor, const Rect& rect, double millimetres_per_pixel);
void draw_view_title(Editor& editor, const Rect& rect, const std::string& title, const std::string& state);
// Updates Views::hover, which says what is under the pointer.
void hover_views(Editor& editor);

// Sections of the sidebar
void draw_outliner(Editor& editor, Column& column);
void draw_bones(Editor& editor, Column& column);
void draw_tissues(Editor& editor, Column& column);
void draw_tissue(Editor& editor, Column& column);
void draw_bone(Editor& editor, Column& column);
void draw_fit_check(Editor& editor, Column& column);
void draw_display(Editor& editor, Column& column);
void draw_clipping(Editor& editor, Column& column);
void draw_image_section(Editor& editor, Column& column);
void draw_under_cursor(Editor& editor, Column& column);
void draw_measurements(Editor& editor, Column& column);
void draw_motion(Editor& editor, Column& column);
void draw_layers(Editor& editor, Column& column);
void draw_weight_problems(Editor& editor, Column& column);
void draw_seam_section(Editor& editor, Column& column);
void draw_bone_table(Editor& editor, Column& column);
void draw_brush_section(Editor& editor, Column& column);
void draw_history(Editor& editor, Column& column);
void draw_live_volume(Editor& editor, Column& column);
void draw_steps(Editor& editor, Column& column);
void draw_running(Editor& editor, Column& column);
void draw_resample(Editor& editor, Column& column);
void draw_gates(Editor& editor, Column& column);
void draw_provenance(Editor& editor, Column& column);

// Panels of the bottom area
void draw_console(Editor& editor, const Rect& rect);
void draw_results(Editor& editor, const Rect& rect);
void draw_change_plot(Editor& editor, const Rect& rect);
void draw_timeline(Editor& editor, const Rect& rect);

// Draws the running job in the status bar, with its right end at x = `right`. Returns the x of its left end; the bar
// is still free to the left of it.
float draw_job_slot(Editor& editor, const Rect& bar, float right);

// Messages to the user
void draw_toasts(Editor& editor);
void draw_error_message(Editor& editor);

}  // namespace limber::editor
