// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/shown/shown_result.h"

#include "editor/shown/fem_live_view.h"
#include "editor/shown/shown_pose.h"

namespace limber::editor {

std::shared_ptr<const Result> result_named(const Document& document, const std::string& name) {
  for (const auto& result : document.results)
    if (result->name == name) return result;
  return nullptr;
}

namespace {

// Returns the result of the side that the user selected, even if the workspace shows something else.
std::shared_ptr<const Result> result_of_side(const Editor& editor) {
  const Comparison& comparison = editor.comparison;
  return result_named(editor.document(), comparison.shows_a && !comparing(editor) ? comparison.a : comparison.b);
}

}  // namespace

std::shared_ptr<const Result> shown_result(const Editor& editor) {
  if (watched_solve(editor)) return nullptr;
  auto result = result_of_side(editor);
  // The Rig and Skin workspaces never show a result: bones are fitted and weights are painted on the original volume.
  if (editor.workspace == Workspace::Rig || editor.workspace == Workspace::Skin) return nullptr;
  if (result && editor.workspace == Workspace::Pose && !(result->from_pose && *result->from_pose == shown_pose(editor)))
    return nullptr;
  return result;
}

std::shared_ptr<const Result> chosen_result(const Editor& editor) {
  if (auto chosen = result_of_side(editor)) return chosen;
  return editor.document().results.empty() ? nullptr : editor.document().results.back();
}

std::string why_no_comparison(const Editor& editor) {
  if (editor.document().results.empty()) return "Resample a pose first";
  const bool same =
      result_named(editor.document(), editor.comparison.a) == result_named(editor.document(), editor.comparison.b);
  return same ? "Select two results: click a row for B, Shift+click a row for A" : "";
}

bool wiping(const Editor& editor) {
  return editor.comparison.views == Comparison::Views::Wipe && editor.workspace == Workspace::Resample &&
         why_no_comparison(editor).empty();
}

bool side_by_side(const Editor& editor) {
  return editor.comparison.views == Comparison::Views::SideBySide && editor.workspace == Workspace::Resample &&
         why_no_comparison(editor).empty();
}

bool comparing(const Editor& editor) { return wiping(editor) || side_by_side(editor); }

std::string name_of_side(const Editor& editor, const std::string& result) {
  return result_named(editor.document(), result) ? result : "At rest";
}

std::shared_ptr<const LabelVolume> shown_volume(const Editor& editor) {
  const auto shown = shown_result(editor);
  return shown ? shown->volume : editor.document().volume;
}

Document shown_document(const Editor& editor) {
  Document document = editor.document();
  document.volume = shown_volume(editor);
  return document;
}

}  // namespace limber::editor
