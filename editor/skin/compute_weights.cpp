// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/skin/compute_weights.h"

#include <algorithm>

#include "core/base/error.h"
#include "core/binding/geodesic.h"
#include "core/binding/rigid.h"
#include "core/bones/bone_parts.h"
#include "core/skin/merge_recomputed.h"
#include "editor/context/background_task.h"
#include "editor/context/context.h"
#include "editor/context/dialogs.h"
#include "editor/context/selection.h"
#include "editor/dialogs/form_dialog.h"
#include "editor/seams/seam_view.h"
#include "editor/shown/test_pose.h"
#include "editor/skin/painting.h"
#include "editor/skin/weight_display.h"
#include "editor/skin/weight_layers.h"
#include "editor/ui/messages.h"
#include "editor/ui/ui.h"
#include "editor/volume/body_seams.h"
#include "editor/volume/tissue_edits.h"
#include "editor/volume/volume_edits.h"

namespace limber::editor {

namespace {

std::string label_of(BindingMethod method) {
  return method == BindingMethod::Heat       ? "Heat diffusion"
         : method == BindingMethod::Geodesic ? "Geodesic weights"
                                             : "Rigid weights";
}

bool of_rig(const Document& document) {
  if (!document.weights || !document.armature) return false;
  const auto& names = document.weights->bones();
  const auto& bones = document.armature->bones;
  return std::equal(names.begin(), names.end(), bones.begin(), bones.end(),
                    [](const std::string& name, const Bone& bone) { return name == bone.name; });
}

// The bones and the voxels whose weights change when only a part of the weights is computed.
struct Part {
  LayerToEdit edited;
  std::vector<int> bones;
  EditScope scope{.rigid_bone_tissue = false};
  std::vector<std::uint8_t> labels;  // for each label, nonzero if voxels with this label change; empty: all change
  // Indices of bones. A voxel changes only if one of these bones has the largest weight there; empty: all voxels
  // change.
  std::vector<int> regions;
};

std::vector<int> chosen_of(const Context& context) {
  std::vector<int> chosen(context.selection->bones.begin(), context.selection->bones.end());
  if (chosen.empty()) chosen.push_back(*skin_bone(context));
  return chosen;
}

Part part_of(Context& context, const Computation& computation) {
  Part part{.edited = layer_to_edit(context)};
  const Document& document = context.document();
  if (computation.bones == Computation::Bones::Chosen) part.bones = chosen_of(context);
  if (computation.bones == Computation::Bones::Unlocked)
    for (const Bone& bone : document.armature->bones) part.scope.locked.push_back(is_locked(document, bone.name));
  if (computation.where == Computation::Where::ChosenBones) part.regions = chosen_of(context);
  if (computation.where == Computation::Where::ChosenTissue) {
    part.labels.assign(65536, 0);
    for (const Label label : context.selection->tissues) part.labels[label] = 1;
  }
  return part;
}

TissueRegion region_of(const Part& part, const LabelVolume& volume, const TissueVoxels& tissue) {
  if (part.labels.empty() && part.regions.empty()) return {};
  return region_where(tissue, [&](std::int64_t place, const glm::ivec3& voxel) {
    if (!part.labels.empty() && !part.labels[volume.at(voxel)]) return false;
    if (part.regions.empty()) return true;
    const int brick = tissue.brick_at(voxel);
    const Influence& influence = part.edited.weights->chunk(brick)[place - tissue.bricks()[brick].first];
    return std::find(part.regions.begin(), part.regions.end(), influence.bone[0]) != part.regions.end();
  });
}

SkinWeights computed(const Document& from, TissueVoxels tissue, const Computation& computation, Progress& progress,
                     WeightsReport& report) {
  const LabelVolume& volume = *from.volume;
  const BoneParts parts =
      split_bones(volume, tissue, *from.tissues, *from.armature, progress, usable_bone_map(seam_source(from)));
  tissue.set_seams(body_seams().of(seam_source(from), progress));
  switch (computation.method) {
    case BindingMethod::Rigid:
      return bind_rigid(volume, tissue, *from.armature, parts, progress, &report, from.tissues.get());
    case BindingMethod::Geodesic:
      return bind_geodesic(volume, tissue, *from.armature, parts, {.stiffness = computation.stiffness}, progress,
                           &report, from.tissues.get());
    case BindingMethod::Heat: break;
  }
  return diffuse_heat(volume, tissue, *from.tissues, *from.armature, parts, {.stiffness = computation.stiffness},
                      progress, &report);
}

void require_same(const Document& now, const Document& from) {
  if (now.volume != from.volume)
    throw Error("the volume was changed meanwhile", "computing weights", "compute them again");
  if (now.armature != from.armature)
    throw Error("the rig was changed meanwhile", "computing weights", "compute them again");
}

}  // namespace

void start_binding(Context& context, const Computation& computation) {
  const Document from = context.document();
  auto report = std::make_shared<WeightsReport>();
  auto changed = std::make_shared<std::int64_t>(0);
  const std::string label = label_of(computation.method);
  const std::optional<Part> part = computation.in_part() ? std::optional(part_of(context, computation)) : std::nullopt;
  const int id = context.jobs->start(label, [from, computation, report, changed, part](Progress& progress) -> Edit {
    const TissueVoxels tissue(*from.volume);
    auto weights = std::make_shared<const SkinWeights>(computed(from, tissue, computation, progress, *report));
    if (!part) {
      Document made = from;
      set_weights(made, weights);
      return [from, made, weights](const Document& now) {
        require_same(now, from);
        Document next = now;
        if (now.layers != from.layers) set_weights(next, weights);
        else next.weights = made.weights, next.layers = made.layers;
        return next;
      };
    }
    EditScope scope = part->scope;
    scope.region = region_of(*part, *from.volume, tissue);
    const WeightEdit edit = recomputed({*from.volume, tissue, *from.tissues, *from.armature}, *part->edited.weights,
                                       *weights, part->bones, scope);
    *changed = edit.changed;
    const EditedLayers made = edited_layers(part->edited, std::make_shared<const SkinWeights>(edit.weights));
    return [from, made, edited = part->edited, changed](const Document& now) {
      require_same(now, from);
      return *changed ? with_edited(now, edited, made) : now;
    };
  });
  context.background->step_of_job[id] = StepOfWork::Skin;
  context.background->after_job[id] = [label, report, changed, in_part = part.has_value(), source = seam_source(from)](
                                          Context& c, const JobStatus& job) {
    if (job.state != JobState::Done || !c.document().weights) return;
    if (!in_part) c.seams->weights_from = source;
    if (in_part)
      c.messages->ok(label, *changed ? grouped(*changed) + " voxels were computed again" : "No weight changed");
    else
      c.messages->ok(label, grouped(c.document().weights->size()) + " voxels follow " +
                                std::to_string(c.document().armature->bones.size()) + " bones");
    for (const std::string& warning : report->warnings) c.messages->warn(label, capitalized(warning));
  };
  context.ui->touch();
}

void ask_computation(Context& context) {
  enum Field { Method, Bones, Where, Skin, Fat, Muscle, Other };
  constexpr double kSoftest = 0.1, kStiffest = 10;
  const auto stiffness = [&](const char* name) {
    return number_of(name,
                     "Relative stiffness of this tissue. 2 halves the distance over which the weight passes from one "
                     "bone to the next.",
                     1, kSoftest, kStiffest, "%.2f", "\u00d7");
  };
  const auto asked = [](const Context& c, const std::vector<FormField>& fields) {
    Computation computation{static_cast<BindingMethod>(fields[Method].chosen),
                            static_cast<Computation::Bones>(fields[Bones].chosen),
                            static_cast<Computation::Where>(fields[Where].chosen),
                            {}};
    for (const Tissue& tissue : c.document().tissues->tissues) {
      if (is_bone(tissue.kind)) continue;
      const Field of = tissue.kind == TissueKind::Skin     ? Skin
                       : tissue.kind == TissueKind::Fat    ? Fat
                       : tissue.kind == TissueKind::Muscle ? Muscle
                                                           : Other;
      if (fields[of].value != 1) computation.stiffness[tissue.label] = fields[of].value;
    }
    return computation;
  };
  const auto outcome = [asked](const Context& c, const std::vector<FormField>& fields) -> std::string {
    const Computation computation = asked(c, fields);
    if (!computation.in_part())
      return c.document().layers ? "Computes the base weights below all layers again." : "Computes all weights again.";
    if (!of_rig(c.document()))
      throw Error("there are no weights of this rig yet", "computing some of the weights", "compute all weights first");
    if (computation.where == Computation::Where::ChosenTissue && c.selection->tissues.empty())
      throw NotYet{"Select tissues in the list first"};
    const std::string what =
        computation.bones == Computation::Bones::Chosen
            ? "Changes the weights of the selected bones. The other bones keep the ratio of their weights."
        : computation.bones == Computation::Bones::Unlocked
            ? "Changes the weights of all bones except the locked ones."
            : "Changes the weights of all bones in the selected tissues or regions.";
    return what;
  };
  context.dialogs->open(make_form(
      {"Compute weights",
       "Changes only the weights selected by Bones and Where. In stiffer tissue, the weights of two bones blend over a "
       "shorter distance.",
       "Compute",
       {choice_of("Method", "Heat: the smoothest weights. Geodesic: faster. Rigid: each voxel follows only one bone.",
                  {"Heat", "Geodesic", "Rigid"}),
        choice_of("Bones", "The bones whose weights are computed.", {"All", "Selected", "Unlocked"}),
        choice_of("Where",
                  "Where weights change: everywhere, in the tissues selected in the list, or where a selected bone has "
                  "the largest weight.",
                  {"Everywhere", "Selected tissue", "Selected bones"}),
        stiffness("Skin"), stiffness("Fat"), stiffness("Muscle"), stiffness("Other tissue")},
       outcome,
       [asked](Context& c, const std::vector<FormField>& fields) { start_binding(c, asked(c, fields)); }}));
}

}  // namespace limber::editor
