// SPDX-License-Identifier: AGPL-3.0-or-later
#include <utility>

#include "editor/context/comparison.h"
#include "editor/context/context.h"
#include "editor/context/document_edits.h"
#include "editor/context/interaction.h"
#include "editor/context/menu_state.h"
#include "editor/context/modal_tool.h"
#include "editor/context/operator.h"
#include "editor/context/operator_polls.h"
#include "editor/context/platform_window.h"
#include "editor/context/pointer_context.h"
#include "editor/context/resampling_settings.h"
#include "editor/context/screen.h"
#include "editor/context/views.h"
#include "editor/input/keymap.h"
#include "editor/resample/difference_overlay.h"
#include "editor/resample/fem_overlay.h"
#include "editor/resample/overlap_overlay.h"
#include "editor/resample/resample_job.h"
#include "editor/resample/result_list.h"
#include "editor/resample/results.h"
#include "editor/shown/fem_live_view.h"
#include "editor/ui/icons.h"
#include "editor/ui/keyboard.h"

namespace limber::editor {

namespace {

Operator method_operator(const DeformationMethod& method) {
  const std::string& word = method.word;
  return {"resample." + word,
          method.label,
          "",
          "Result",
          method.description,
          [word](Context& c) { c.resampling->method = word; },
          nullptr,
          [word](const Context& c) { return c.resampling->method == word; }};
}

std::string needs_result(const Context& context) {
  return context.document().results.empty() ? "Resample a pose first" : "";
}

std::string needs_solve(const Context& context) {
  return context.fem->solves.empty() ? "No finite elements are being solved: resample by FEM first" : "";
}

void toggle_watching(Context& context) {
  if (context.fem->watched != 0) return stop_watching(context.fem);
  context.screen->workspace = Workspace::Resample;
  watch(context);
}

Operator colours_operator(const char* id, const char* label, const char* description,
                          std::optional<FemMeasure> measure) {
  return {id,
          label,
          "",
          "Finite elements",
          description,
          [measure](Context& c) {
            show_difference_overlay(c, false);
            show_overlap_overlay(c, false);
            c.fem_overlay->measure = measure;
          },
          measure ? why_no_fem_overlay : nullptr,
          [measure](const Context& c) {
            return c.fem_overlay->measure == measure && !c.difference->shown && !c.overlap->shown;
          }};
}

void toggle_posed(Context& context) { show_result(context, shown_result(context) ? "" : chosen_result(context)->name); }

// Makes sure that two different volumes can be compared. If they cannot, selects the document's last result as B. If
// they still cannot, selects the volume at rest as A.
void choose_sides(Context& context) {
  if (!why_no_comparison(context).empty()) context.comparison->b = context.document().results.back()->name;
  if (!why_no_comparison(context).empty()) context.comparison->a.clear();
}

// Shows only volume A or only volume B of the comparison, over the whole view.
void show_side(Context& context, bool a) {
  stop_watching(context.fem);
  choose_sides(context);
  context.comparison->views = Comparison::Views::One;
  context.comparison->shows_a = a;
}

// Shows both volumes of the comparison, with a dividing line or side by side. For Views::One, shows only volume B.
void show_sides(Context& context, Comparison::Views views) {
  stop_watching(context.fem);
  choose_sides(context);
  context.comparison->views = views;
  context.comparison->shows_a = false;
}

void toggle_wipe(Context& context) {
  show_sides(context, wiping(context) ? Comparison::Views::One : Comparison::Views::Wipe);
  context.screen->workspace = Workspace::Resample;
}

void toggle_side_by_side(Context& context) {
  show_sides(context, side_by_side(context) ? Comparison::Views::One : Comparison::Views::SideBySide);
  context.screen->workspace = Workspace::Resample;
}

void toggle_difference(Context& context) {
  const bool on = !shows_difference(context);
  context.screen->workspace = Workspace::Resample;
  stop_watching(context.fem);
  choose_sides(context);
  show_difference_overlay(context, on);
}

void toggle_overlap(Context& context) {
  const bool on = !shows_overlap(context);
  context.screen->workspace = Workspace::Resample;
  stop_watching(context.fem);
  if (on && !shown_result(context) && !comparing(context)) show_result(context, chosen_result(context)->name);
  show_overlap_overlay(context, on);
}

// Shows A in place of B, or B in place of A, while the user holds the operator's key. If the views show both sides next
// to each other, swaps A and B.
class Flicker final : public Modal {
 public:
  explicit Flicker(Context& context) : key_(Key::F) {
    if (const auto chord = context.keymap->chord_of("compare.flicker", contexts(context))) key_ = chord->key;
    choose_sides(context);
    before_ = context.comparison;
    if (side_by_side(context)) std::swap(context.comparison->a, context.comparison->b);
    else show_side(context, !before_.shows_a);
  }
  bool key(Context& context, const KeyChanged& event) override {
    if (event.key != key_ || event.down) return true;
    cancel(context);
    return false;
  }
  void cancel(Context& context) override {
    const float share = context.comparison->share;
    *context.comparison = before_;
    context.comparison->share = share;
  }
  std::vector<KeyHint> hints(const Context&) const override {
    return {{{std::string(name_of(key_))}, "Release to show the other result again"}};
  }

 private:
  Comparison before_;
  Key key_;
};

bool results_seen(const Context& context) {
  return context.screen->arrangement().results && !context.screen->arrangement().console &&
         !context.screen->arrangement().timeline;
}

// Shows or hides the table of results. Showing it hides the console and the timeline, because they use the same area.
void show_results(Screen& screen, bool shown) {
  screen.arrangement().results = shown;
  if (shown) screen.arrangement().console = screen.arrangement().timeline = false;
}
void toggle_results(Context& context) { show_results(context.screen, !results_seen(context)); }

void delete_result(Context& context) {
  const auto gone = chosen_result(context);
  Document next = context.document();
  std::erase(next.results, gone);
  commit(context, "Delete " + gone->name, std::move(next));
}

void delete_stale(Context& context) {
  Document next = context.document();
  std::erase_if(next.results, [&](const auto& result) { return !stale_reason(context.document(), *result).empty(); });
  commit(context, "Delete stale results", std::move(next));
}

std::string needs_stale(const Context& context) {
  for (const auto& result : context.document().results)
    if (!stale_reason(context.document(), *result).empty()) return "";
  return "No result is stale";
}

}  // namespace

std::vector<std::string> method_operators(Methods which) {
  std::vector<std::string> ids;
  for (const std::string& word : method_words(which)) ids.push_back("resample." + word);
  return ids;
}

std::vector<Operator> resample_operators() {
  std::vector<Operator> operators = {
      {"resample.run", "Resample this pose", icon::kResample, "Result",
       "Resample the posed body into a new label volume, in the background.", [](Context& c) { start_resampling(c); },
       why_no_resampling},
      {"result.watch", "Watch the solve", icon::kRunning, "Result",
       "Show in the views how the tissue moves into the pose while the finite elements are being solved.",
       toggle_watching, needs_solve, [](const Context& c) { return c.fem->watched != 0; }},
      {"result.toggle", "Posed volume", icon::kPose, "Result",
       "Switch the views between the selected result and the volume at rest.", toggle_posed, needs_result,
       [](const Context& c) { return shown_result(c) != nullptr; }},
      {"result.show_last", "Show result", icon::kVisible, "Result", "Show the last result in the views.",
       [](Context& c) { show_result(c, c.document().results.back()->name); }, needs_result},
      {"result.rename", "Rename result...", icon::kRename, "Result",
       "Give the selected result another name, in the table below the views.",
       [](Context& c) {
         c.results->renaming = {chosen_result(c)->name, chosen_result(c)->name};
         await_field(c.ui);
         show_results(c.screen, true);
       },
       needs_result},
      {"result.delete", "Delete result", icon::kTrash, "Result", "Delete the selected result from the project.",
       delete_result, needs_result},
      {"result.delete_stale", "Delete stale results", icon::kTrash, "Result",
       "Delete all results that are out of date because the volume, weights or other inputs have changed.",
       delete_stale, needs_stale},
      {"result.copy_report", "Copy report", icon::kCopy, "Result",
       "Copy the selected result's report to the clipboard, as JSON.",
       [](Context& c) { c.host->set_clipboard(chosen_result(c)->report); }, needs_result},
      {"compare.show_a", "Show A", icon::kVisible, "Result", "Show side A of the comparison in the views.",
       [](Context& c) { show_side(c, true); }, needs_result,
       [](const Context& c) { return !comparing(c) && c.comparison->shows_a; }},
      {"compare.show_b", "Show B", icon::kVisible, "Result", "Show side B of the comparison in the views.",
       [](Context& c) { show_side(c, false); }, needs_result,
       [](const Context& c) { return !comparing(c) && !c.comparison->shows_a; }},
      {"compare.wipe", "Wipe", icon::kWipe, "Result",
       "In every view, show A on the left and B on the right of a line that you can drag.", toggle_wipe, needs_result,
       wiping},
      {"compare.side_by_side", "Side by side", icon::kSplitViews, "Result",
       "Show every view twice, with A and B side by side from the same camera. Drag the line between them to resize.",
       toggle_side_by_side, needs_result, side_by_side},
      {"compare.difference", "Difference", icon::kDifference, "Result",
       "Mark and count the voxels whose tissue differs between A and B.", toggle_difference, needs_result,
       shows_difference},
      {"result.overlap", "Overlap", icon::kOverlap, "Result",
       "Mark and count the voxels into which the pose moves two parts of the body.", toggle_overlap, why_no_overlap,
       shows_overlap},
      {"compare.flicker", "Flicker", "", "Result", "Show the other side of the comparison while the key is held.",
       [](Context& c) { c.interaction->modal = std::make_unique<Flicker>(c); }, needs_result},
      {"compare.swap", "Swap A and B", icon::kMirror, "Result", "Swap sides A and B of the comparison.",
       [](Context& c) { std::swap(c.comparison->a, c.comparison->b); }, needs_result},
      colours_operator("fem.show_tissues", "Tissue colours", "Show a FEM result in its tissue colours.", std::nullopt),
      colours_operator("fem.show_volume_ratio", "Volume ratio",
                       "Colour by volume ratio (det F): compressed tetrahedra are blue, swollen ones red.",
                       FemMeasure::VolumeRatio),
      colours_operator(
          "fem.show_energy", "Strain energy",
          "Colour by the strain energy density, in kPa: high values show where stiff tissue is deformed most.",
          FemMeasure::EnergyDensity),
      colours_operator("fem.show_gap", "Contact gap",
                       "Colour by the distance between skin surfaces that face each other in a fold, in mm.",
                       FemMeasure::Gap),
      {"fem.tets", "Tetrahedra", icon::kTissues, "Finite elements",
       "Draw the solved mesh as lines where slices, the clip box and the clip plane cut it.",
       [](Context& c) { c.fem_overlay->tets = !c.fem_overlay->tets; }, why_no_fem_overlay,
       [](const Context& c) { return c.fem_overlay->tets; }},
      {"fem.display_pie", "Colour menu", icon::kVisible, "Finite elements",
       "Open a menu at the pointer that selects what the colours of FEM results show.",
       [](Context& c) { c.menus->open_popup = "Finite elements"; }, why_no_fem_overlay},
      {"view.results", "Results", icon::kTable, "View", "Open or close the table of results below the views.",
       toggle_results, nullptr, results_seen},
  };
  std::vector<Operator> methods;
  for (const DeformationMethod& method : deformation_methods()) methods.push_back(method_operator(method));
  operators.insert(operators.begin() + 1, methods.begin(), methods.end());
  return operators;
}

}  // namespace limber::editor
