// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/binding.h"

#include "core/base/error.h"
#include "core/rig/bone_parts.h"
#include "core/skin/geodesic.h"
#include "core/skin/heat_diffusion.h"
#include "core/skin/rigid.h"
#include "editor/prepare.h"

namespace limber::editor {

namespace {

std::string label_of(BindingMethod method) {
  return method == BindingMethod::Heat ? "Heat diffusion" : method == BindingMethod::Geodesic ? "Geodesic weights" : "Rigid weights";
}

}  // namespace

void start_binding(Editor& editor, BindingMethod method) {
  const Document from = editor.document();
  auto report = std::make_shared<WeightsReport>();
  const int id = editor.jobs.start(label_of(method), [from, method, report](Progress& progress) -> Edit {
    const LabelVolume& volume = *from.volume;
    const TissueVoxels tissue(volume);
    const BoneParts parts = split_bones(volume, tissue, *from.tissues, *from.armature, progress);
    auto weights = std::make_shared<const SkinWeights>(
        method == BindingMethod::Rigid      ? bind_rigid(volume, tissue, *from.armature, parts, progress, report.get())
        : method == BindingMethod::Geodesic ? bind_geodesic(volume, tissue, *from.armature, parts, {}, progress, report.get())
                                            : diffuse_heat(volume, tissue, *from.tissues, *from.armature, parts, {}, progress, report.get()));
    return [from, weights](const Document& now) {
      if (now.volume != from.volume) throw Error("the volume was changed meanwhile", "computing weights", "start it again");
      if (now.armature != from.armature) throw Error("the rig was changed meanwhile", "computing weights", "start it again");
      Document next = now;
      next.weights = weights;
      return next;
    };
  });
  editor.step_of_job[id] = StepOfWork::Skin;
  editor.after_job[id] = [method, report](Editor& e, const JobStatus& job) {
    if (job.state != JobState::Done || !e.document().weights) return;
    e.messages.ok(label_of(method), grouped(e.document().weights->size()) + " voxels follow " + std::to_string(e.document().armature->bones.size()) + " bones");
    for (const std::string& warning : report->warnings) e.messages.warn(label_of(method), warning);
  };
  editor.touch();
}

}  // namespace limber::editor
