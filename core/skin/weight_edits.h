// SPDX-License-Identifier: AGPL-3.0-or-later
// Edits of the weights of a whole body or a region of it, under the same rules as a stroke (normalize.h): sums stay
// exact, locked bones keep every bit, bricks that do not change stay shared. The same for any number of threads.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "core/base/progress.h"
#include "core/rig/mirror.h"
#include "core/skin/falloff.h"
#include "core/skin/normalize.h"
#include "core/skin/skin_weights.h"
#include "core/skin/weighted_body.h"

namespace limber {

// A byte per tissue voxel in brick order, not 0 for those that belong to it.
using TissueRegion = std::vector<std::uint8_t>;

struct EditScope {
  BoneSet locked;
  Normalize normalize = Normalize::Unlocked;
  bool rigid_bone_tissue = true;  // bone tissue is not changed
  TissueRegion region;            // empty: everywhere
  Progress* progress = nullptr;   // told how far an edit is, and ends it when it is cancelled
};

struct WeightEdit {
  SkinWeights weights;
  std::int64_t changed = 0;  // voxels
  std::int64_t blocked = 0;  // voxels that a lock kept from changing
  int blocked_by = -1;       // the bone that did so most often
};

// Regions

// Voxels for which `belongs` says so; called from several threads.
TissueRegion region_where(const TissueVoxels& tissue,
                          const std::function<bool(std::int64_t place, const glm::ivec3& voxel)>& belongs);
// The tissue that hangs together with a voxel through faces, all of it or as far as it has the same label. Nothing for
// air.
enum class Part { Tissue, Label };
TissueRegion connected_part(const LabelVolume& volume, const TissueVoxels& tissue, const glm::ivec3& voxel, Part part);
TissueRegion region_of_label(const LabelVolume& volume, const TissueVoxels& tissue, Label label);
// Where the bone has at least that weight, (0, 1].
TissueRegion region_of_bone(const SkinWeights& weights, const TissueVoxels& tissue, int bone, double least = 0.5);

// Edits. `bones` are painted as one.

enum class Flood { Add, Subtract, Set, Multiply };
//   value   Add, Subtract, Set: [0, 1]; Multiply: 0 and more
//   amount  [0, 1]
WeightEdit flooded(const WeightedBody& body, const SkinWeights& weights, std::span<const int> bones, Flood kind,
                   double value, double amount = 1, const EditScope& scope = {});

struct Gradient {
  glm::dvec3 from{0}, to{0};  // world, mm; apart
  bool radial = false;  // from the point `from` outwards to the distance of `to`, else along the line between them
  double from_value = 1, to_value = 0;
  Falloff falloff = FalloffShape::Linear;
};
WeightEdit with_gradient(const WeightedBody& body, const SkinWeights& weights, std::span<const int> bones,
                         const Gradient& gradient, double amount = 1, const EditScope& scope = {});

// Every bone's weights, towards the mean of the six neighbours.    amount  [0, 1] a pass
WeightEdit smoothed(const WeightedBody& body, const SkinWeights& weights, int passes, double amount = 1,
                    const EditScope& scope = {}, Progress& progress = no_progress());

enum class Copy {
  Replace,  // `to` gets the weight that `from` has
  Add,      // and keeps its own
  Move,     // and `from` gives it up
  Swap,
};
WeightEdit copied(const WeightedBody& body, const SkinWeights& weights, int from, int to, Copy kind,
                  const EditScope& scope = {});

// Voxel by voxel, as in normalize.h.
WeightEdit limited(const WeightedBody& body, const SkinWeights& weights, int most, const EditScope& scope = {});
WeightEdit pruned(const WeightedBody& body, const SkinWeights& weights, double least, const EditScope& scope = {});
WeightEdit in_steps(const WeightedBody& body, const SkinWeights& weights, int steps, const EditScope& scope = {});
WeightEdit with_levels(const WeightedBody& body, const SkinWeights& weights, int bone,
                       const WeightRules::Levels& levels, const EditScope& scope = {});

// The side that the plane's normal points to takes over what the other side has, bone by bone of the pairs
// (mirror_pairs): each voxel from the nearest tissue of that side to its mirror image that is bone where it is bone, at
// most `reach` away. Bodies need not be symmetric: voxels without a match keep their weights and are reported. Done
// twice it is as done once.
struct MirrorSettings {
  MirrorPlane plane;
  double reach = 10;  // mm
};
struct MirrorEdit : WeightEdit {
  std::vector<std::int64_t> unmatched;  // places in the tissue list
};
MirrorEdit mirrored(const WeightedBody& body, const SkinWeights& weights, const MirrorSettings& settings,
                    const EditScope& scope = {});

// Weights of another volume of the same place in the world, whatever its spacing, interpolated between its voxels;
// bones are matched by name.
struct TransferEdit : WeightEdit {
  std::vector<std::string>
      missing;  // bones of the other rig with weight that this one lacks: their nearest ancestor that it has takes over
};
struct TransferSource {
  const LabelVolume& volume;
  const TissueVoxels& tissue;
  const Armature& armature;
  const SkinWeights& weights;
};
// Throws Error where the two rigs have no bone name in common.
TransferEdit transferred(const WeightedBody& body, const SkinWeights& weights, const TransferSource& from,
                         const EditScope& scope = {}, Progress& progress = no_progress());

// Any other edit: change(rules, influence, place, voxel), called from several threads, one for each voxel of the scope.
using VoxelChange = std::function<WeightChange(const WeightRules& rules, Influence& influence, std::int64_t place,
                                               const glm::ivec3& voxel)>;
WeightEdit edited(const WeightedBody& body, const SkinWeights& weights, const EditScope& scope,
                  const VoxelChange& change);

}  // namespace limber
