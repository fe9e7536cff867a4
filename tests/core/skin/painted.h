// SPDX-License-Identifier: AGPL-3.0-or-later
// A body with weights that tests can set voxel by voxel.
#pragma once

#include <functional>
#include <memory>

#include "core/paint/stroke.h"
#include "tests/core/skin/small_body.h"

namespace limber::test {

struct Painted {
  SmallBody body;
  TissueVoxels tissue;
  std::shared_ptr<const SkinWeights> weights;

  explicit Painted(SmallBody made) : body(std::move(made)), tissue(body.volume) {
    std::vector<std::string> names;
    for (const Bone& bone : body.armature.bones) names.push_back(bone.name);
    weights = std::make_shared<const SkinWeights>(names, tissue);
  }
  WeightedBody weighted_body() const { return {body.volume, tissue, body.tissues, body.armature}; }
  void set(const std::function<Influence(const glm::ivec3&)>& of) {
    SkinWeights all = *weights;
    for (std::int64_t b = 0; b < all.chunk_count(); ++b) {
      SkinWeights::Influences chunk = all.chunk(b);
      tissue.for_each(
          b, b + 1, [&](std::int64_t place, const glm::ivec3& v) { chunk[place - tissue.bricks()[b].first] = of(v); });
      all.set_chunk(b, std::move(chunk));
    }
    weights = std::make_shared<const SkinWeights>(std::move(all));
  }
};

inline Influence at(const TissueVoxels& tissue, const SkinWeights& weights, const glm::ivec3& v) {
  const int brick = tissue.brick_at(v);
  return weights.chunk(brick)[tissue.index_of(v) - tissue.bricks()[brick].first];
}

// A block across a plane of symmetry, x = 31 mm, with two arms and a trunk.
inline SmallBody two_sided_body() {
  SmallBody body;
  body.volume.grid.size = {32, 14, 14};
  body.volume.grid.spacing = glm::dvec3(2);
  body.volume.voxels.assign(body.volume.grid.voxel_count(), 0);
  for (int z = 2; z < 12; ++z)
    for (int y = 2; y < 12; ++y)
      for (int x = 2; x < 30; ++x) body.volume.at({x, y, z}) = kMuscle;
  body.tissues = muscle_and_bone();
  body.armature.bones = {bone_between("Trunk", -1, {31, 14, 2}, {31, 14, 26}),
                         bone_between("LeftArm", 0, {31, 14, 14}, {58, 14, 14}),
                         bone_between("RightArm", 0, {31, 14, 14}, {4, 14, 14})};
  return body;
}

}  // namespace limber::test
