// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/rig/rig_edits.h"

#include <algorithm>
#include <functional>
#include <numeric>

#include "core/motion/moved_targets.h"
#include "core/project/bone_names.h"
#include "core/rig/edit_armature.h"
#include "core/rig/mirror.h"
#include "core/skin/transfer_to_volume.h"
#include "core/skin/weight_layers.h"
#include "editor/context/context.h"
#include "editor/context/document_edits.h"
#include "editor/context/pose_editing.h"
#include "editor/context/selection.h"
#include "editor/context/transform_settings.h"
#include "editor/context/views.h"
#include "editor/ui/messages.h"
#include "editor/ui/ui.h"

namespace limber::editor {

namespace {

std::vector<std::string> names_of(const Armature& armature) {
  std::vector<std::string> names;
  for (const Bone& bone : armature.bones) names.push_back(bone.name);
  return names;
}

// Returns for each bone of the old rig the index of the bone in the new rig that takes over the old bone's weights.
// This is the old bone itself or, if the edit removed it, its nearest ancestor in the new rig; -1: there is no such
// bone.
//   from  for each bone of the new rig, its index in the old rig; -1: a new bone
std::vector<int> heirs(const Armature& before, const std::vector<int>& from) {
  std::vector<int> to(before.bones.size(), -1);
  for (int bone = 0; bone < std::ssize(from); ++bone)
    if (from[bone] >= 0) to[from[bone]] = bone;
  for (std::size_t bone = 0; bone < to.size(); ++bone)
    if (const int parent = before.bones[bone].parent; to[bone] < 0 && parent >= 0) to[bone] = to[parent];
  return to;
}

using Follow = std::function<void(Document&, const Armature& before, const Armature& after)>;

// Commits the rig `next` as one edit that keeps pose and weights, and selects the bones `chosen`.
//   from    for each bone of `next`, its index in the old rig; -1: the edit added the bone
//   follow  updates the parts of the document that refer to bones by name
void commit_followed(Context& context, const std::string& label, Armature next, const std::vector<int>& from,
                     const std::vector<int>& chosen, const Follow& follow = {}) {
  drop_shown_rig(context);
  const std::shared_ptr<const Armature> before = context.document().armature;
  if (before && next == *before) return;
  check_armature(next, "rig");
  Document document = context.document();
  const std::string lost = "The weights belonged to deleted bones: compute them again";
  bool weights_lost = false;
  if (before && document.pose) document.pose = std::make_shared<const Pose>(carried(*document.pose, from));
  if (before && document.weights) {
    const bool fits = document.weights->bones().size() == before->bones.size();
    const auto weights = fits ? carried(*document.weights, heirs(*before, from), names_of(next)) : std::nullopt;
    weights_lost = !weights;
    document.weights = weights ? std::make_shared<const SkinWeights>(*weights) : nullptr;
    const auto layers =
        weights && document.layers ? carried(*document.layers, heirs(*before, from), names_of(next)) : std::nullopt;
    document.layers = layers ? std::make_shared<const WeightLayers>(*layers) : nullptr;
  }
  if (follow) follow(document, *before, next);
  document.armature = std::make_shared<const Armature>(std::move(next));
  commit(context, label, std::move(document));
  if (weights_lost) context.messages->info(label, lost);
  if (before) warn_of_moved_targets(context, label, *before, from);
  *context.selection = {};
  for (const int bone : chosen) {
    context.selection->bone = bone;
    context.selection->bones.insert(bone);
  }
}

}  // namespace

void warn_of_moved_targets(Context& context, const std::string& label, const Armature& before,
                           const std::vector<int>& from) {
  constexpr std::size_t kMostNamed = 3;
  std::vector<std::string> moved;
  for (const auto& clip : context.document().clips)
    if (clip->constraints)
      for (const std::string& name : moved_targets(*clip->constraints, before, *context.document().armature, from))
        moved.push_back(name + " (" + clip->name + ")");
  if (moved.empty()) return;
  std::string names;
  for (std::size_t i = 0; i < std::min(moved.size(), kMostNamed); ++i) names += (i == 0 ? "" : ", ") + moved[i];
  if (moved.size() > kMostNamed) names += " and " + std::to_string(moved.size() - kMostNamed) + " more";
  context.messages->warn(label + ": targets of constraints moved",
                         names + ". Check their positions in the Pose workspace");
}

void warn_of_moved_targets(Context& context, const std::string& label, const Armature& before) {
  warn_of_moved_targets(context, label, before, bones_of(before, *context.document().armature));
}

std::shared_ptr<const Armature> shown_rig(const Context& context) {
  return context.views->preview_armature ? context.views->preview_armature : context.document().armature;
}

void show_rig(Context& context, Armature armature) {
  context.views->preview_armature = std::make_shared<const Armature>(std::move(armature));
  context.ui->touch();
}

void drop_shown_rig(Context& context) {
  context.views->preview_armature.reset();
  context.ui->touch();
}

Armature mirrored_too(const Context& context, Armature next) {
  const std::shared_ptr<const Armature> before = context.document().armature;
  return before && context.transform_settings->x_mirror ? with_mirrored_changes(*before, next) : next;
}

void commit_rig(Context& context, const std::string& label, Armature next, const std::vector<int>& chosen) {
  const std::shared_ptr<const Armature> before = context.document().armature;
  const std::vector<int> from = before ? bones_of(*before, next) : std::vector<int>(next.bones.size(), -1);
  commit_followed(context, label, std::move(next), from, chosen);
}

void rename_bone(Context& context, int bone, const std::string& name) {
  const std::shared_ptr<const Armature> before = context.document().armature;
  commit_names(context, "Rename " + before->bones[bone].name, renamed(*before, bone, name), {bone});
}

void commit_names(Context& context, const std::string& label, Armature next, const std::vector<int>& chosen) {
  const std::shared_ptr<const Armature> before = context.document().armature;
  std::vector<int> from(before->bones.size());
  std::iota(from.begin(), from.end(), 0);
  std::map<std::string, glm::dquat> copied;
  for (std::size_t bone = 0; bone < from.size(); ++bone)
    if (const auto found = context.posing->copied.find(before->bones[bone].name); found != context.posing->copied.end())
      copied[next.bones[bone].name] = found->second;
  context.posing->copied = std::move(copied);
  commit_followed(context, label, std::move(next), from, chosen, follow_names);
}

void mirror_bones(Context& context, const std::vector<int>& bones, const std::string& label) {
  const std::shared_ptr<const Armature> before = context.document().armature;
  Armature next = mirrored_bones(*before, bones);
  std::vector<int> from(next.bones.size()), chosen;
  for (int bone = 0; bone < std::ssize(from); ++bone) from[bone] = before->find(next.bones[bone].name).value_or(bone);
  for (const int bone : bones) chosen.push_back(next.find(before->bones[bone].name).value_or(bone));
  context.transform_settings->part = TransformSettings::Part::Whole;
  commit_followed(
      context, label, std::move(next), from, chosen,
      [&](Document& document, const Armature& was, const Armature& is) { follow_mirrored(document, was, is, bones); });
}

std::vector<int> with_other_sides(const Context& context, const std::vector<int>& bones) {
  if (!context.transform_settings->x_mirror) return bones;
  const std::vector<int> pairs = mirror_pairs(*context.document().armature);
  std::vector<int> both;
  for (const int bone : bones)
    if (std::find(bones.begin(), bones.end(), pairs[bone]) == bones.end()) both.push_back(pairs[bone]);
  both.insert(both.end(), bones.begin(), bones.end());
  return both;
}

Armature hung(const Context& context, const std::vector<int>& bones, int parent, Join join) {
  const Armature& before = *context.document().armature;
  if (parent < 0) return unparented(before, with_other_sides(context, bones));
  Armature next = parented(before, bones, parent, join);
  std::vector<int> others = with_other_sides(context, bones);
  others.resize(others.size() - bones.size());
  const int other_parent = mirror_pairs(before)[parent];
  const bool one_sided = other_parent == parent && mirrored_name(before.bones[parent].name);
  if (one_sided) return next;
  const auto there = [&](int bone) { return next.find(before.bones[bone].name).value(); };
  for (const int other : others) {
    bool hangs_below = false;
    for (int above = there(other_parent); above >= 0; above = next.bones[above].parent)
      hangs_below = hangs_below || above == there(other);
    if (!hangs_below) next = parented(next, {there(other)}, there(other_parent), join);
  }
  return next;
}

void hang_on(Context& context, const std::vector<int>& bones, int parent) {
  const std::shared_ptr<const Armature> before = context.document().armature;
  Armature next = hung(context, bones, parent, Join::KeepOffset);
  std::vector<int> chosen;
  for (const int bone : bones) chosen.push_back(next.find(before->bones[bone].name).value());
  const std::string what = bones.size() == 1 ? before->bones[bones[0]].name : std::to_string(bones.size()) + " bones";
  commit_rig(context, parent < 0 ? "Clear parent of " + what : "Parent " + what + " to " + before->bones[parent].name,
             std::move(next), chosen);
}

void drop_missing_bones(Context& context) {
  const int count = context.document().armature ? static_cast<int>(context.document().armature->bones.size()) : 0;
  Selection& selection = context.selection;
  std::erase_if(selection.bones, [&](int bone) { return bone >= count; });
  if (selection.bone && *selection.bone >= count) selection.bone.reset();
}

}  // namespace limber::editor
