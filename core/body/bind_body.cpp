// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/body/bind_body.h"

#include <algorithm>

#include "core/base/error.h"
#include "core/binding/geodesic.h"
#include "core/binding/rigid.h"
#include "core/bones/unsure_bones.h"
#include "core/seams/find_seams.h"
#include "core/skin/weights_io.h"

namespace limber {

namespace {
void set_seams(const Body& body, BoundBody& bound, const SeamChoice& seams, Progress& progress) {
  if (seams) return bound.tissue.set_seams(*seams);
  bound.tissue.set_seams(std::make_shared<const Seams>(
      find_seams(body.file.volume, bound.tissue, body.tissues, body.rig, parts_of(body, bound, progress), progress)));
}

SkinWeights weights_of(const Body& body, BoundBody& bound, Binding binding, Progress& progress) {
  const LabelVolume& volume = body.file.volume;
  const BoneParts& parts = parts_of(body, bound, progress);
  switch (binding) {
    case Binding::Rigid:
      return bind_rigid(volume, bound.tissue, body.rig, parts, progress, &bound.solve, &body.tissues);
    case Binding::Geodesic:
      return bind_geodesic(volume, bound.tissue, body.rig, parts, {}, progress, &bound.solve, &body.tissues);
    case Binding::Heat: break;
  }
  return diffuse_heat(volume, bound.tissue, body.tissues, body.rig, parts, {}, progress, &bound.solve);
}
}  // namespace

std::vector<std::string> binding_words() { return {"heat", "geodesic", "rigid"}; }

Binding require_binding(const std::string& word, const std::string& where) {
  const std::vector<std::string> words = binding_words();
  const auto found = std::find(words.begin(), words.end(), word);
  if (found == words.end())
    throw Error("there is no such method to compute weights", where, "write heat, geodesic or rigid");
  return static_cast<Binding>(found - words.begin());
}

const BoneParts& parts_of(const Body& body, BoundBody& bound, Progress& progress) {
  if (!bound.parts)
    bound.parts = split_bones(body.file.volume, bound.tissue, body.tissues, body.rig, progress, body.bone_map);
  return *bound.parts;
}

BoundBody bind_body(const Body& body, Binding binding, const SeamChoice& seams, Progress& progress) {
  BoundBody bound;
  bound.tissue = TissueVoxels(body.file.volume);
  set_seams(body, bound, seams, progress);
  bound.weights = weights_of(body, bound, binding, progress);
  bound.warnings = unsure_bones(parts_of(body, bound, progress), body.tissues, body.rig);
  bound.warnings.insert(bound.warnings.end(), bound.solve.warnings.begin(), bound.solve.warnings.end());
  return bound;
}

BoundBody read_bound_body(const Body& body, const Path& weights, const SeamChoice& seams, Progress& progress) {
  BoundBody bound;
  bound.tissue = TissueVoxels(body.file.volume);
  WeightsFile file = read_weights(weights, body.file.volume, bound.tissue, body.rig);
  set_seams(body, bound, seams ? seams : file.seams, progress);
  bound.weights = std::move(file.weights);
  bound.is_from_file = true;
  bound.warnings = std::move(file.warnings);
  return bound;
}

}  // namespace limber
