// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/skin/weight_problems.h"
#include "editor/context/background_task.h"
#include "editor/context/context.h"
#include "editor/context/preferences.h"
#include "editor/context/selection.h"
#include "editor/context/views.h"
#include "editor/seams/seam_view.h"
#include "editor/ui/messages.h"
#include "editor/ui/ui.h"

#include <algorithm>
#include <utility>

#include "core/study/text.h"
#include "editor/skin/brush_settings.h"
#include "editor/skin/weight_display.h"
#include "editor/skin/weight_layers.h"

namespace limber::editor {

namespace {

constexpr char kFinding[] = "Find problems";

void show_place(Context& context, const glm::dvec3& place) {
  Views& views = *context.views;
  render::Camera camera = views.body.move ? views.body.move->to : views.body.camera;
  camera.centre = place;
  if (context.preferences->reduce_motion) views.body.camera = camera;
  else views.body.move = CameraMove{views.body.camera, camera, context.ui->now};
  const Box box = world_box(context.document());
  views.cross_hair = glm::clamp(place, box.low, box.high);
  for (SliceState& slice : views.slices) slice.camera.centre = place;
  context.ui->touch();
}

EditScope scope_of(const Context& context) {
  const StrokeSettings settings = stroke_settings(context, BrushKind::Smooth);
  return {settings.locked, settings.normalize, true, {}};
}

}  // namespace

std::string why_not_these_weights(const Context& context) {
  if (context.workspace() != Workspace::Skin) return "Switch to the Skin workspace first";
  if (!seen_weights(context)) return "Compute the weights first";
  const auto& bones = context.document().armature->bones;
  const auto& names = context.document().weights->bones();
  if (!std::equal(bones.begin(), bones.end(), names.begin(), names.end(),
                  [](const Bone& bone, const std::string& name) { return bone.name == name; }))
    return "The weights belong to another rig: compute them again";
  return "";
}

void start_finding_problems(Context& context) {
  const Document of = context.document();
  start_task(context, kFinding, [of, tissue = tissue_voxels(*context.views, of)](Progress& progress) -> Finish {
    auto found = std::make_shared<FoundProblems>();
    found->in = of.weights;
    found->armature = of.armature;
    found->problems = find_problems({*of.volume, *tissue, *of.tissues, *of.armature}, *of.weights, {}, progress);
    found->repaired.resize(found->problems.size());
    return [found](Context& c) {
      c.skin->painting->problems = found;
      c.skin->painting->problem = -1;
      const auto count = found->problems.size();
      c.messages->ok(kFinding,
                     count == 0 ? "The weights have no problems"
                                : grouped(static_cast<std::int64_t>(count)) + (count == 1 ? " problem" : " problems"),
                     count == 0 ? "" : "skin.next_problem");
      c.ui->touch();
    };
  });
}

bool finds_problems(const Jobs& jobs) {
  const auto all = jobs.statuses();
  return std::any_of(all.begin(), all.end(),
                     [](const JobStatus& job) { return job.label == kFinding && job.active(); });
}

bool problems_stale(const Context& context) {
  const auto& found = context.skin->painting->problems;
  return found && (found->in != context.document().weights || found->armature != context.document().armature);
}

void go_to_problem(Context& context, int problem) {
  Painting& painting = *context.skin->painting;
  const WeightProblem& there = painting.problems->problems[static_cast<std::size_t>(problem)];
  painting.problem = problem;
  const auto& bones = painting.problems->in->bones();
  const auto bone = there.bone >= 0 && there.bone < std::ssize(bones)
                        ? context.document().armature->find(bones[static_cast<std::size_t>(there.bone)])
                        : std::nullopt;
  if (bone) {
    *context.selection = {};
    context.selection->bone = *bone;
    context.selection->bones = {*bone};
  }
  show_place(context, there.place);
}

void repair_problem(Context& context, int index) {
  const auto found = context.skin->painting->problems;
  const WeightProblem& problem = found->problems[static_cast<std::size_t>(index)];
  const std::string label = "Repair " + describe(problem, *found->armature);
  start_task(
      context, label,
      [found, index, label, of = context.document(), tissue = parted_tissue(context), edited = layer_to_edit(context),
       scope = scope_of(context)](Progress& progress) -> Finish {
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
        return [=](Context& c) {
          if (!made && lock >= 0)
            return c.messages->toast_error(lock_message(*of.armature, lock),
                                           "No other unlocked bone can give or take weight here", "skin.unlock_all");
          if (!made) return c.messages->info(label, "No weight needed to change");
          const bool fresh = !problems_stale(c);
          commit_weights(c, label, edited, *made);
          if (c.skin->painting->problems != found) return;
          // Mark this problem as repaired, but keep it in the list, so that the other problems keep their
          // indices.
          auto next = std::make_shared<FoundProblems>(*found);
          next->repaired[static_cast<std::size_t>(index)] = true;
          if (fresh) next->in = c.document().weights;
          c.skin->painting->problems = next;
          c.ui->touch();
        };
      });
}

const char* name_of(WeightProblem::Kind kind) {
  constexpr const char* kNames[] = {"Not reached by a bone", "Isolated weights", "Distant bones",
                                    "Bone tissue that is not rigid", "Abrupt weights"};
  return kNames[static_cast<int>(kind)];
}

}  // namespace limber::editor
