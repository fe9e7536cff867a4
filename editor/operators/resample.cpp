// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/icons.h"
#include "editor/operators/polls.h"
#include "editor/resampling.h"
#include "editor/results.h"

namespace limber::editor {

namespace {

Operator method_operator(const char* id, const char* label, const char* sentence, const char* method) {
  return {id, label, "", "Result", sentence, [method](Editor& e) { e.resampling.method = method; }, nullptr,
          [method](const Editor& e) { return e.resampling.method == method; }};
}

std::string needs_result(const Editor& editor) { return editor.document().results.empty() ? "Nothing was resampled yet" : ""; }

void toggle_posed(Editor& editor) { editor.shown_result = shown_result(editor) ? "" : chosen_result(editor)->name; }

void delete_result(Editor& editor) {
  const auto gone = chosen_result(editor);
  Document next = editor.document();
  std::erase(next.results, gone);
  if (editor.shown_result == gone->name) editor.shown_result.clear();
  editor.history.commit("Delete " + gone->name, std::move(next));
}

void delete_stale(Editor& editor) {
  Document next = editor.document();
  std::erase_if(next.results, [&](const auto& result) { return !stale_reason(editor.document(), *result).empty(); });
  editor.history.commit("Delete stale results", std::move(next));
}

std::string needs_stale(const Editor& editor) {
  for (const auto& result : editor.document().results)
    if (!stale_reason(editor.document(), *result).empty()) return "";
  return "No result is stale";
}

}  // namespace

std::vector<Operator> resample_operators() {
  return {
      {"resample.run", "Resample this pose", icon::kResample, "Result", "Writes the posed body as a new label volume, beside the work.", [](Editor& e) { start_resampling(e); }, why_no_resampling},
      method_operator("resample.lbs", "LBS", "Linear blending: quick, loses volume at bent and twisted joints.", "lbs"),
      method_operator("resample.dqs", "DQ", "Dual quaternions: keeps the thickness of twisted limbs.", "dqs"),
      {"result.toggle", "Posed volume", icon::kPose, "Result", "The views show the chosen result, or the volume at rest again.", toggle_posed, needs_result,
       [](const Editor& e) { return shown_result(e) != nullptr; }},
      {"result.show_last", "Show", icon::kVisible, "Result", "The views show the last result.", [](Editor& e) { e.shown_result = e.document().results.back()->name; }, needs_result},
      {"result.delete", "Delete result", icon::kTrash, "Result", "Takes the chosen result out of the project.", delete_result, needs_result},
      {"result.delete_stale", "Delete stale results", icon::kTrash, "Result", "Takes out the results whose inputs have changed.", delete_stale, needs_stale},
      {"result.copy_report", "Copy report", icon::kCopy, "Result", "Puts the chosen result's report on the clipboard, as JSON.",
       [](Editor& e) { e.host.set_clipboard(chosen_result(e)->report); }, needs_result},
      {"view.results", "Results", icon::kTable, "View", "Opens or closes the table of results below the views.",
       [](Editor& e) { e.arrangement().results = !e.arrangement().results; }, nullptr, [](const Editor& e) { return e.arrangement().results; }},
  };
}

}  // namespace limber::editor
