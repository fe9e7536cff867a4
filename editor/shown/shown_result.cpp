// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/shown/shown_result.h"

#include "editor/context/comparison.h"
#include "editor/context/context.h"
#include "editor/context/views.h"
#include "editor/context/workspace.h"
#include "editor/shown/fem_live_view.h"
#include "editor/shown/shown_pose.h"

namespace limber::editor {

std::shared_ptr<const Result> result_named(const Document& document, const std::string& name) {
  for (const auto& result : document.results)
    if (result->name == name) return result;
  return nullptr;
}

namespace {

// Returns the result that the user selected to be shown: A or B, or B while both are compared. Returns this result even
// if the workspace shows something else.
std::shared_ptr<const Result> result_of_side(const Context& context) {
  const Comparison& comparison = context.comparison;
  return result_named(context.document(), comparison.shows_a && !comparing(context) ? comparison.a : comparison.b);
}

}  // namespace

std::shared_ptr<const Result> shown_result(const Context& context) {
  if (watched_solve(context)) return nullptr;
  auto result = result_of_side(context);
  // The Rig and Skin workspaces never show a result: bones are fitted and weights are painted on the original volume.
  if (context.workspace() == Workspace::Rig || context.workspace() == Workspace::Skin) return nullptr;
  if (result && context.workspace() == Workspace::Pose &&
      !(result->from_pose && *result->from_pose == shown_pose(context)))
    return nullptr;
  return result;
}

std::shared_ptr<const Result> chosen_result(const Context& context) {
  if (auto chosen = result_of_side(context)) return chosen;
  return context.document().results.empty() ? nullptr : context.document().results.back();
}

std::string why_no_comparison(const Context& context) {
  if (context.document().results.empty()) return "Resample a pose first";
  const bool same = result_named(context.document(), context.comparison->a) ==
                    result_named(context.document(), context.comparison->b);
  return same ? "Select two results: click a row for B, Shift+click a row for A" : "";
}

bool wiping(const Context& context) {
  return context.comparison->views == Comparison::Views::Wipe && context.workspace() == Workspace::Resample &&
         why_no_comparison(context).empty();
}

bool side_by_side(const Context& context) {
  return context.comparison->views == Comparison::Views::SideBySide && context.workspace() == Workspace::Resample &&
         why_no_comparison(context).empty();
}

bool comparing(const Context& context) { return wiping(context) || side_by_side(context); }

std::string name_of_side(const Document& document, const std::string& result) {
  return result_named(document, result) ? result : "At rest";
}

std::shared_ptr<const LabelVolume> shown_volume(const Context& context) {
  const auto shown = shown_result(context);
  return shown ? shown->volume : context.document().volume;
}

Document shown_document(const Context& context) {
  Document document = context.document();
  document.volume = shown_volume(context);
  return document;
}

}  // namespace limber::editor
