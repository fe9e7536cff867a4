// SPDX-License-Identifier: AGPL-3.0-or-later
// Declares the functions that draw the window's regions and the panels in them. Panels only draw and read the input; to
// change something, they run an operator.
#pragma once

#include "editor/ui/section.h"

namespace limber::editor {

struct Context;
struct ViewPlace;

// Regions of the window
void draw_top_bar(Context& context);
void draw_tool_header(Context& context);
void draw_tool_strip(Context& context);
void draw_views_region(Context& context);
void draw_sidebar(Context& context);
void draw_bottom(Context& context);
void draw_status_bar(Context& context);
void draw_splitters(Context& context);
void draw_start_screen(Context& context);
void draw_tour(Context& context);

// Overlays, drawn over the pictures of the views
void draw_body_overlay(Context& context, const ViewPlace& place);
void draw_slice_overlay(Context& context, const ViewPlace& place);
bool draw_weight_legend(Context& context, const Rect& view);  // returns true if a legend was drawn
bool draw_fem_legend(Context& context, const Rect& view);     // returns true if a legend was drawn
// Draws the legend of the marked voxels. These are the voxels in which two volumes differ, or the voxels in which
// parts of the posed body overlap. Returns the legend's height in pixels at scale 1; 0: no legend.
float draw_marks_legend(Context& context, const Rect& view);
// Draws a label in place of the title of a view that shows one of two compared results: A or B, and the result's name.
void draw_side_chip(Context& context, const ViewPlace& place);
void put_swatch(const Look& look, const glm::vec2& corner, Colour colour);
void draw_weights_at_pointer(Context& context);
void draw_empty_view(Context& context, const Rect& rect);
void draw_scale_bar(Context& context, const Rect& rect, double millimetres_per_pixel);
void draw_view_title(Ui& ui, const Rect& rect, const std::string& title, const std::string& state);
// Updates Views::hover, which says what is under the pointer.
void hover_views(Context& context);

// Sections of the sidebar
void draw_outliner(Context& context, Column& column);
void draw_bones(Context& context, Column& column);
void draw_tissues(Context& context, Column& column);
void draw_tissue(Context& context, Column& column);
void draw_bone(Context& context, Column& column);
void draw_fit_check(Context& context, Column& column);
void draw_display(Context& context, Column& column);
void draw_clipping(Context& context, Column& column);
void draw_image_section(Context& context, Column& column);
void draw_under_cursor(Context& context, Column& column);
void draw_measurements(Context& context, Column& column);
void draw_motion(Context& context, Column& column);
void draw_layers(Context& context, Column& column);
void draw_weight_problems(Context& context, Column& column);
void draw_seam_section(Context& context, Column& column);
void draw_bone_table(Context& context, Column& column);
void draw_brush_section(Context& context, Column& column);
void draw_history(Context& context, Column& column);
void draw_live_volume(Context& context, Column& column);
void draw_steps(Context& context, Column& column);
void draw_running(Context& context, Column& column);
void draw_resample(Context& context, Column& column);
void draw_gates(Context& context, Column& column);
void draw_provenance(Context& context, Column& column);

// Panels of the bottom area
void draw_console(Context& context, const Rect& rect);
void draw_results(Context& context, const Rect& rect);
void draw_change_plot(Context& context, const Rect& rect);
void draw_timeline(Context& context, const Rect& rect);

// Draws the running job in the status bar, with its right end at x = `right`. Returns the x of its left end; the bar
// is still free to the left of it.
float draw_job_slot(Context& context, const Rect& bar, float right);

// Messages to the user
void draw_toasts(Context& context);
void draw_error_message(Context& context);

}  // namespace limber::editor
