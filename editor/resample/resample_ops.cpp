// SPDX-License-Identifier: AGPL-3.0-or-later
#include <utility>

#include "editor/context/document_edits.h"
#include "editor/context/operator_polls.h"
#include "editor/context/pointer_context.h"
#include "editor/resample/difference_overlay.h"
#include "editor/resample/fem_overlay.h"
#include "editor/resample/overlap_overlay.h"
#include "editor/resample/resample_job.h"
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
          [word](Editor& e) { e.resampling.method = word; },
          nullptr,
          [word](const Editor& e) { return e.resampling.method == word; }};
}

std::string needs_result(const Editor& editor) {
  return editor.document().results.empty() ? "Resample a pose first" : "";
}

std::string needs_solve(const Editor& editor) {
  return editor.fem->solves.empty() ? "No finite elements are being solved" : "";
}

void toggle_watching(Editor& editor) {
  if (editor.fem->watched != 0) return stop_watching(editor);
  editor.workspace = Workspace::Resample;
  watch(editor);
}

Operator colours_operator(const char* id, const char* label, const char* description,
                          std::optional<FemMeasure> measure) {
  return {id,
          label,
          "",
          "Finite elements",
          description,
          [measure](Editor& e) {
            show_difference_overlay(e, false);
            show_overlap_overlay(e, false);
            e.fem_overlay->measure = measure;
          },
          measure ? why_no_fem_overlay : nullptr,
          [measure](const Editor& e) {
            return e.fem_overlay->measure == measure && !e.difference->shown && !e.overlap->shown;
          }};
}

void toggle_posed(Editor& editor) { show_result(editor, shown_result(editor) ? "" : chosen_result(editor)->name); }

// Completes the comparison: if side A or B is not a valid result, side B becomes the last result. If the comparison is
// still not valid, side A becomes the volume at rest.
void choose_sides(Editor& editor) {
  if (!why_no_comparison(editor).empty()) editor.comparison.b = editor.document().results.back()->name;
  if (!why_no_comparison(editor).empty()) editor.comparison.a.clear();
}

// Shows only side A or only side B of the comparison, over the whole view.
void show_side(Editor& editor, bool a) {
  stop_watching(editor);
  choose_sides(editor);
  editor.comparison.views = Comparison::Views::One;
  editor.comparison.shows_a = a;
}

// Shows both sides of the comparison, with a dividing line or side by side. For Views::One, shows only side B.
void show_sides(Editor& editor, Comparison::Views views) {
  stop_watching(editor);
  choose_sides(editor);
  editor.comparison.views = views;
  editor.comparison.shows_a = false;
}

void toggle_wipe(Editor& editor) {
  show_sides(editor, wiping(editor) ? Comparison::Views::One : Comparison::Views::Wipe);
  editor.workspace = Workspace::Resample;
}

void toggle_side_by_side(Editor& editor) {
  show_sides(editor, side_by_side(editor) ? Comparison::Views::One : Comparison::Views::SideBySide);
  editor.workspace = Workspace::Resample;
}

void toggle_difference(Editor& editor) {
  const bool on = !shows_difference(editor);
  editor.workspace = Workspace::Resample;
  stop_watching(editor);
  choose_sides(editor);
  show_difference_overlay(editor, on);
}

void toggle_overlap(Editor& editor) {
  const bool on = !shows_overlap(editor);
  editor.workspace = Workspace::Resample;
  stop_watching(editor);
  if (on && !shown_result(editor) && !comparing(editor)) show_result(editor, chosen_result(editor)->name);
  show_overlap_overlay(editor, on);
}

// Shows the other side of the comparison while the user holds the operator's key. If the views show both sides next to
// each other, swaps A and B.
class Flicker final : public Modal {
 public:
  explicit Flicker(Editor& editor) : key_(Key::F) {
    if (const auto chord = editor.keymap.chord_of("compare.flicker", contexts(editor))) key_ = chord->key;
    choose_sides(editor);
    before_ = editor.comparison;
    if (side_by_side(editor)) std::swap(editor.comparison.a, editor.comparison.b);
    else show_side(editor, !before_.shows_a);
  }
  bool key(Editor& editor, const KeyChanged& event) override {
    if (event.key != key_ || event.down) return true;
    cancel(editor);
    return false;
  }
  void cancel(Editor& editor) override {
    const float share = editor.comparison.share;
    editor.comparison = before_;
    editor.comparison.share = share;
  }
  std::vector<KeyHint> hints(const Editor&) const override {
    return {{{std::string(name_of(key_))}, "Release to show the other result again"}};
  }

 private:
  Comparison before_;
  Key key_;
};

bool results_seen(const Editor& editor) {
  return editor.arrangement().results && !editor.arrangement().console && !editor.arrangement().timeline;
}

// Shows or hides the table of results. Showing it hides the console and the timeline, because they use the same area.
void show_results(Editor& editor, bool shown) {
  editor.arrangement().results = shown;
  if (shown) editor.arrangement().console = editor.arrangement().timeline = false;
}
void toggle_results(Editor& editor) { show_results(editor, !results_seen(editor)); }

void delete_result(Editor& editor) {
  const auto gone = chosen_result(editor);
  Document next = editor.document();
  std::erase(next.results, gone);
  commit(editor, "Delete " + gone->name, std::move(next));
}

void delete_stale(Editor& editor) {
  Document next = editor.document();
  std::erase_if(next.results, [&](const auto& result) { return !stale_reason(editor.document(), *result).empty(); });
  commit(editor, "Delete stale results", std::move(next));
}

std::string needs_stale(const Editor& editor) {
  for (const auto& result : editor.document().results)
    if (!stale_reason(editor.document(), *result).empty()) return "";
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
       "Resample the posed body into a new label volume, in the background.", [](Editor& e) { start_resampling(e); },
       why_no_resampling},
      {"result.watch", "Watch the solve", icon::kRunning, "Result",
       "Show in the views how the tissue moves into the pose while the finite elements are being solved.",
       toggle_watching, needs_solve, [](const Editor& e) { return e.fem->watched != 0; }},
      {"result.toggle", "Posed volume", icon::kPose, "Result",
       "Switch the views between the selected result and the volume at rest.", toggle_posed, needs_result,
       [](const Editor& e) { return shown_result(e) != nullptr; }},
      {"result.show_last", "Show result", icon::kVisible, "Result", "Show the last result in the views.",
       [](Editor& e) { show_result(e, e.document().results.back()->name); }, needs_result},
      {"result.rename", "Rename result...", icon::kRename, "Result",
       "Give the selected result another name, in the table below the views.",
       [](Editor& e) {
         e.renaming_result = {chosen_result(e)->name, chosen_result(e)->name};
         await_field(e);
         show_results(e, true);
       },
       needs_result},
      {"result.delete", "Delete result", icon::kTrash, "Result", "Delete the selected result from the project.",
       delete_result, needs_result},
      {"result.delete_stale", "Delete stale results", icon::kTrash, "Result",
       "Delete all results that are out of date because the volume, weights or other inputs have changed.",
       delete_stale, needs_stale},
      {"result.copy_report", "Copy report", icon::kCopy, "Result",
       "Copy the selected result's report to the clipboard, as JSON.",
       [](Editor& e) { e.host.set_clipboard(chosen_result(e)->report); }, needs_result},
      {"compare.show_a", "Show A", icon::kVisible, "Result", "Show side A of the comparison in the views.",
       [](Editor& e) { show_side(e, true); }, needs_result,
       [](const Editor& e) { return !comparing(e) && e.comparison.shows_a; }},
      {"compare.show_b", "Show B", icon::kVisible, "Result", "Show side B of the comparison in the views.",
       [](Editor& e) { show_side(e, false); }, needs_result,
       [](const Editor& e) { return !comparing(e) && !e.comparison.shows_a; }},
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
       [](Editor& e) { e.modal = std::make_unique<Flicker>(e); }, needs_result},
      {"compare.swap", "Swap A and B", icon::kMirror, "Result", "Swap sides A and B of the comparison.",
       [](Editor& e) { std::swap(e.comparison.a, e.comparison.b); }, needs_result},
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
       [](Editor& e) { e.fem_overlay->tets = !e.fem_overlay->tets; }, why_no_fem_overlay,
       [](const Editor& e) { return e.fem_overlay->tets; }},
      {"fem.display_pie", "Colour menu", icon::kVisible, "Finite elements",
       "Open a menu at the pointer that selects what the colours of FEM results show.",
       [](Editor& e) { e.open_popup = "Finite elements"; }, why_no_fem_overlay},
      {"view.results", "Results", icon::kTable, "View", "Open or close the table of results below the views.",
       toggle_results, nullptr, results_seen},
  };
  std::vector<Operator> methods;
  for (const DeformationMethod& method : deformation_methods()) methods.push_back(method_operator(method));
  operators.insert(operators.begin() + 1, methods.begin(), methods.end());
  return operators;
}

}  // namespace limber::editor
