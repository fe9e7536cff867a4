// SPDX-License-Identifier: AGPL-3.0-or-later
// Edits the weights of a whole body or of a region of it, by the same rules as a brush stroke (normalize.h): sums stay
// exact, and the weights of locked bones keep every bit. Bricks that do not change stay shared with the old weights.
// Results do not depend on the number of threads.
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

// A region of tissue: one byte per tissue voxel in brick order, which is not 0 if the voxel is in the region.
using TissueRegion = std::vector<std::uint8_t>;

struct EditScope {
  BoneSet locked;
  Normalize normalize = Normalize::Unlocked;
  bool rigid_bone_tissue = true;  // true: bone tissue is not changed
  TissueRegion region;            // voxels that may change; empty: all voxels
  Progress* progress = nullptr;   // receives the progress of an edit, and can cancel it; may be null
};

struct WeightEdit {
  SkinWeights weights;
  std::int64_t changed = 0;  // number of changed voxels
  std::int64_t blocked = 0;  // number of voxels that could not change because of a locked bone
  int blocked_by = -1;       // the locked bone that prevented most changes; -1: none
};

// ---- regions

// Returns the region of all voxels for which `belongs` returns true. `belongs` is called from several threads.
TissueRegion region_where(const TissueVoxels& tissue,
                          const std::function<bool(std::int64_t place, const glm::ivec3& voxel)>& belongs);
// Returns the tissue that is connected to `voxel` through voxel faces: tissue of any label (Part::Tissue), or only of
// the voxel's own label (Part::Label). Returns an empty region if the voxel is air.
enum class Part { Tissue, Label };
TissueRegion connected_part(const LabelVolume& volume, const TissueVoxels& tissue, const glm::ivec3& voxel, Part part);
TissueRegion region_of_label(const LabelVolume& volume, const TissueVoxels& tissue, Label label);
// Returns the region of all voxels in which the bone's weight is at least `least`, (0, 1].
TissueRegion region_of_bone(const SkinWeights& weights, const TissueVoxels& tissue, int bone, double least = 0.5);

// ---- edits. In each edit, several `bones` are treated as one bone with the sum of their weights.

enum class Flood { Add, Subtract, Set, Multiply };
// Changes the sum of the weights of `bones` in every voxel of the scope: adds `value`, subtracts it, sets the sum to it
// or multiplies the sum by it.
//   value   for Add, Subtract and Set: [0, 1]; for Multiply: a factor of 0 or more
//   amount  how far weights move towards the new weight, [0, 1]
WeightEdit flooded(const WeightedBody& body, const SkinWeights& weights, std::span<const int> bones, Flood kind,
                   double value, double amount = 1, const EditScope& scope = {});

struct Gradient {
  glm::dvec3 from{0}, to{0};  // ends of the gradient, world, mm; must differ
  // If true, the gradient is a function of the distance from `from`, and it ends at the distance of `to`. If false, it
  // runs along the line from `from` to `to`.
  bool radial = false;
  double from_value = 1, to_value = 0;
  Falloff falloff = FalloffShape::Linear;
};
WeightEdit with_gradient(const WeightedBody& body, const SkinWeights& weights, std::span<const int> bones,
                         const Gradient& gradient, double amount = 1, const EditScope& scope = {});

// Moves the weights of each voxel towards the mean weights of its six neighbours, in `passes` passes.
//   amount  how far weights move towards the mean in one pass, [0, 1]
WeightEdit smoothed(const WeightedBody& body, const SkinWeights& weights, int passes, double amount = 1,
                    const EditScope& scope = {}, Progress& progress = no_progress());

enum class Copy {
  Replace,  // bone `to` gets the weight of bone `from` instead of its own
  Add,      // bone `to` gets the weight of bone `from` in addition to its own
  Move,     // bone `to` gets the weight of bone `from` in addition, and `from` loses it
  Swap,
};
WeightEdit copied(const WeightedBody& body, const SkinWeights& weights, int from, int to, Copy kind,
                  const EditScope& scope = {});

// These four edits apply WeightRules::limit, prune, quantize_to and levels (normalize.h) to every voxel.
WeightEdit limited(const WeightedBody& body, const SkinWeights& weights, int most, const EditScope& scope = {});
WeightEdit pruned(const WeightedBody& body, const SkinWeights& weights, double least, const EditScope& scope = {});
WeightEdit in_steps(const WeightedBody& body, const SkinWeights& weights, int steps, const EditScope& scope = {});
WeightEdit with_levels(const WeightedBody& body, const SkinWeights& weights, int bone,
                       const WeightRules::Levels& levels, const EditScope& scope = {});

// Settings for mirroring weights to the side that the plane's normal points to. Left and right bones are swapped
// (mirror_pairs). Each voxel on that side takes the weights of the tissue voxel nearest to its mirror image, if that
// voxel is at most `reach` away. Bone tissue takes weights only from bone tissue. Bodies need not be symmetric: voxels
// without a match keep their weights and are reported. Mirroring twice gives the same result as mirroring once.
struct MirrorSettings {
  MirrorPlane plane;
  double reach = 10;  // largest distance from the mirror image to the voxel whose weights are taken, mm
};
struct MirrorEdit : WeightEdit {
  std::vector<std::int64_t> unmatched;  // voxels without a match, as indices in the list of tissue voxels
};
MirrorEdit mirrored(const WeightedBody& body, const SkinWeights& weights, const MirrorSettings& settings,
                    const EditScope& scope = {});

// An edit that transfers the weights of another volume at the same position in the world. That volume may have any
// voxel spacing, since weights are interpolated between its voxels. Bones are matched by name.
struct TransferEdit : WeightEdit {
  // Bones of the other rig that have weight in the other volume but do not exist in this rig. The weight of each such
  // bone went to its nearest ancestor that exists in this rig.
  std::vector<std::string> missing;
};
struct TransferSource {
  const LabelVolume& volume;
  const TissueVoxels& tissue;
  const Armature& armature;
  const SkinWeights& weights;
};
// Replaces the weights in the voxels of the scope by those that `from` has at the same positions. Throws Error if the
// two rigs have no bone name in common.
TransferEdit transferred(const WeightedBody& body, const SkinWeights& weights, const TransferSource& from,
                         const EditScope& scope = {}, Progress& progress = no_progress());

// Applies any other edit to the voxels of the scope. Calls change(rules, influence, place, voxel) once for each voxel,
// from several threads. `place` is the voxel's index in the list of tissue voxels.
using VoxelChange = std::function<WeightChange(const WeightRules& rules, Influence& influence, std::int64_t place,
                                               const glm::ivec3& voxel)>;
WeightEdit edited(const WeightedBody& body, const SkinWeights& weights, const EditScope& scope,
                  const VoxelChange& change);

}  // namespace limber
