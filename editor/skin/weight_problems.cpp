// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/skin/weight_problems.h"
#include "editor/seams/seam_view.h"

#include <algorithm>
#include <utility>

#include "core/study/text.h"
#include "editor/skin/brush_settings.h"
#include "editor/skin/weight_display.h"
#include "editor/skin/weight_layers.h"

namespace limber::editor {

namespace {

constexpr char kFinding[] = "Find problems";

void show_place(Editor& editor, const glm::dvec3& place) {
  Views& views = *editor.views;
  render::Camera camera = views.body.move ? views.body.move->to : views.body.camera;
  camera.centre = place;
  if (editor.preferences.reduce_motion) views.body.camera = camera;
  else views.body.move = CameraMove{views.body.camera, camera, editor.now};
  const Box box = world_box(editor.document());
  views.cross_hair = glm::clamp(place, box.low, box.high);
  for (SliceState& slice : views.slices) slice.camera.centre = place;
  editor.touch();
}

EditScope scope_of(const Editor& editor) {
  const StrokeSettings settings = stroke_settings(editor, BrushKind::Smooth);
  return {settings.locked, settings.normalize, true, {}};
}

}  // namespace

std::string why_not_these_weights(const Editor& editor) {
  if (editor.workspace != Workspace::Skin) return "Switch to the Skin workspace first";
  if (!seen_weights(editor)) return "Compute the weights first";
  const auto& bones = editor.document().armature->bones;
  const auto& names = editor.document().weights->bones();
  if (!std::equal(bones.begin(), bones.end(), names.begin(), names.end(),
                  [](const Bone& bone, const std::string& name) { return bone.name == name; }))
    return "The weights belong to another rig: compute them again";
  return "";
}

void start_finding_problems(Editor& editor) {
  const Document of = editor.document();
  start_task(editor, kFinding, [of, tissue = tissue_voxels(*editor.views, of)](Progress& progress) -> Finish {
    auto found = std::make_shared<FoundProblems>();
    found->in = of.weights;
    found->armature = of.armature;
    found->problems = find_problems({*of.volume, *tissue, *of.tissues, *of.armature}, *of.weights, {}, progress);
    found->repaired.resize(found->problems.size());
    return [found](Editor& e) {
      e.skin->painting->problems = found;
      e.skin->painting->problem = -1;
      const auto count = found->problems.size();
      e.messages.ok(kFinding,
                    count == 0 ? "The weights have no problems"
                               : grouped(static_cast<std::int64_t>(count)) + (count == 1 ? " problem" : " problems"),
                    count == 0 ? "" : "skin.next_problem");
      e.touch();
    };
  });
}

bool finds_problems(const Editor& editor) {
  const auto all = editor.jobs.statuses();
  return std::any_of(all.begin(), all.end(),
                     [](const JobStatus& job) { return job.label == kFinding && job.active(); });
}

bool problems_stale(const Editor& editor) {
  const auto& found = editor.skin->painting->problems;
  return found && (found->in != editor.document().weights || found->armature != editor.document().armature);
}

void go_to_problem(Editor& editor, int problem) {
  Painting& painting = *editor.skin->painting;
  const WeightProblem& there = painting.problems->problems[static_cast<std::size_t>(problem)];
  painting.problem = problem;
  const auto& bones = painting.problems->in->bones();
  const auto bone = there.bone >= 0 && there.bone < std::ssize(bones)
                        ? editor.document().armature->find(bones[static_cast<std::size_t>(there.bone)])
                        : std::nullopt;
  if (bone) {
    editor.selection = {};
    editor.selection.bone = *bone;
    editor.selection.bones = {*bone};
  }
  show_place(editor, there.place);
}

void repair_problem(Editor& editor, int index) {
  const auto found = editor.skin->painting->problems;
  const WeightProblem& problem = found->problems[static_cast<std::size_t>(index)];
  const std::string label = "Repair " + describe(problem, *found->armature);
  start_task(
      editor, label,
      [found, index, label, of = editor.document(), tissue = parted_tissue(editor), edited = layer_to_edit(editor),
       scope = scope_of(editor)](Progress& progress) -> Finish {
        progress.update("weights", 0);
        const WeightEdit edit = repaired({*of.volume, *tissue, *of.tissues, *of.armature}, *edited.weights,
                                         found->problems[static_cast<std::size_t>(index)], scope);
        const auto made = edit.changed > 0
                              ? std::optional(edited_layers(edited, std::make_shared<const SkinWeights>(edit.weights)))
                              : std::nullopt;
        const auto first_lock = std::find(scope.locked.begin(), scope.locked.end(), 1);
        const int lock = edit.blocked_by >= 0               ? edit.blocked_by
                         : first_lock != scope.locked.end() ? static_cast<int>(first_lock - scope.locked.begin())
                                                            : -1;
        return [=](Editor& e) {
          if (!made && lock >= 0)
            return e.messages.toast_error(lock_message(*of.armature, lock),
                                          "No other unlocked bone can give or take weight here", "skin.unlock_all");
          if (!made) return e.messages.info(label, "No weight needed to change");
          const bool fresh = !problems_stale(e);
          commit_weights(e, label, edited, *made);
          if (e.skin->painting->problems != found) return;
          // Mark this problem as repaired, but keep it in the list, so that the other problems keep their
          // indices.
          auto next = std::make_shared<FoundProblems>(*found);
          next->repaired[static_cast<std::size_t>(index)] = true;
          if (fresh) next->in = e.document().weights;
          e.skin->painting->problems = next;
          e.touch();
        };
      });
}

const char* name_of(WeightProblem::Kind kind) {
  constexpr const char* kNames[] = {"Not reached by a bone", "Isolated weights", "Distant bones",
                                    "Bone tissue that is not rigid", "Abrupt weights"};
  return kNames[static_cast<int>(kind)];
}

}  // namespace limber::editor
