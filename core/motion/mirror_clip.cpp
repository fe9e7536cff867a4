// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/motion/mirror_clip.h"

#include <algorithm>
#include <cmath>

#include "core/motion/constraint.h"
#include "core/motion/key_curve.h"
#include "core/motion/strip_edits.h"
#include "core/rig/mirror.h"

namespace limber {

namespace {

bool lies_along_an_axis(const glm::dvec3& normal) {
  return std::max({std::abs(normal.x), std::abs(normal.y), std::abs(normal.z)}) > 1 - 1e-12;
}

// Replaces clamped handles of the body's shift by aligned handles with the same tangents.
void align_root_handles(Clip& clip, const ClipOnRig& on_rig) {
  std::map<int, glm::dvec3> shifts = clip.keys.root;
  if (on_rig.has_base())
    for (auto& [frame, shift] : shifts) shift -= on_rig.base_at(frame).root_translation;
  const KeyShapes before = clip.keys.root_shapes;
  for (const auto& [frame, shift] : shifts) {
    KeyShape shape = shape_at(before, frame);
    if (shape.handles != HandleKind::Clamped) continue;
    const Tangents tangents = tangents_at(shifts, before, frame);
    shape.handles = HandleKind::Aligned;
    shape.in = tangents.in;
    shape.out = tangents.out;
    set_root_shape(clip.keys, frame, shape);
  }
}

}  // namespace

Clip mirrored_clip(const std::shared_ptr<const Clip>& clip, const std::shared_ptr<const Armature>& armature) {
  Clip mirrored = *clip;
  mirrored.retarget.mirror = !clip->retarget.mirror;
  if (clip->strips) mirrored.strips = std::make_shared<const Strips>(mirrored_strips(*clip->strips, *armature));
  const MirrorPlane plane = mirror_plane(*armature);
  const bool is_eased = std::any_of(clip->keys.root_shapes.begin(), clip->keys.root_shapes.end(),
                                    [](const auto& key) { return key.second.next == Interpolation::Bezier; });
  if (is_eased && !lies_along_an_axis(plane.normal)) align_root_handles(mirrored, ClipOnRig(clip, armature));

  const std::vector<int> pairs = mirror_pairs(*armature);
  const auto counterpart = [&](const std::string& name) {
    const auto bone = armature->find(name);
    return bone ? armature->bones[pairs[*bone]].name : name;
  };
  Keys keys = std::move(mirrored.keys);
  mirrored.keys = {};
  for (auto& [name, track] : keys.bones) {
    for (auto& [frame, rotation] : track) rotation = plane.rotation(rotation);
    mirrored.keys.bones[counterpart(name)] = std::move(track);
  }
  for (auto& [name, shapes] : keys.shapes) {
    // A rotation reverses its sense in a mirror, so its vector is negated after the reflection.
    for (auto& [frame, shape] : shapes)
      for (glm::dvec3* tangent : {&shape.in, &shape.out}) *tangent = -plane.direction(*tangent);
    mirrored.keys.shapes[counterpart(name)] = std::move(shapes);
  }
  for (auto& [frame, shift] : keys.root) shift = plane.direction(shift);
  for (auto& [frame, shape] : keys.root_shapes)
    for (glm::dvec3* tangent : {&shape.in, &shape.out}) *tangent = plane.direction(*tangent);
  mirrored.keys.root = std::move(keys.root);
  mirrored.keys.root_shapes = std::move(keys.root_shapes);
  mirrored.keys.weights = std::move(keys.weights);
  mirrored.keys.weight_shapes = std::move(keys.weight_shapes);
  if (!clip->constraints) return mirrored;
  Constraints constraints = *clip->constraints;
  std::vector<std::string> bones;
  for (Constraint& constraint : constraints.list) {
    bones.push_back(constraint.bone);
    if (const auto bone = armature->find(constraint.bone))
      constraint = mirror_image(constraint, armature->bones[*bone], armature->bones[pairs[*bone]], plane);
    constraint.bone = counterpart(constraint.bone);
    constraint.target = counterpart(constraint.target);
  }
  name_after_bones(constraints.list, mirrored.keys, bones);
  mirrored.constraints = std::make_shared<const Constraints>(std::move(constraints));
  return mirrored;
}

}  // namespace limber
