// SPDX-License-Identifier: AGPL-3.0-or-later
// One stroke of a brush over the weights of a body, from press to release. Only bricks that change are cloned; the original
// weights are never touched, so that giving a stroke up costs nothing. Where dabs do not accumulate they only note what they
// cover; voxels are painted when somebody looks, once for all dabs since. The same for any number of threads.
//
//   Stroke stroke(body, weights, settings);
//   stroke.to(cursor);  ...                        as often as the cursor moves; dabs stand a spacing apart
//   for (int brick : stroke.take_dirty()) upload(brick, stroke.chunk(brick));
//   if (!stroke.empty()) document.weights = std::make_shared<const SkinWeights>(stroke.finish());
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "core/rig/mirror.h"
#include "core/skin/brush_reach.h"
#include "core/skin/falloff.h"
#include "core/skin/weight_rules.h"
#include "core/volume/tissue_table.h"

namespace limber {

enum class BrushKind {
  Add,           // w + cover
  Subtract,      // w - cover
  Set,           // w to `value` by cover
  Multiply,      // w to w * value by cover
  Smooth,        // to the mean around, by a Gauss curve as wide as 0.45 radii
  Sharpen,       // away from it
  Average,       // to the mean over the dab
  Smear,         // weights are dragged along the stroke; always accumulates
  JointCapsule,  // what two bones share at their joint blends over `blend_mm` along them
};

struct Brush {
  BrushKind kind = BrushKind::Add;
  double radius = 10;    // mm
  double strength = 1;   // [0, 1]: cover at the centre
  double value = 1;      // Set: [0, 1]; Multiply: 0 and more
  Falloff falloff;
  double spacing = 0.25;    // between dabs, as a share of the radius
  bool accumulate = false;  // else a stroke never goes beyond what one dab at its full cover does
  BrushDistance distance = BrushDistance::Geodesic;
  bool all_bones = true;    // Smooth, Sharpen, Average, Smear: all bones of a voxel, not only the painted
  double blend_mm = 20;     // JointCapsule: where the child's weight goes from 0 to 1 (smoothstep), centred on the joint
};

struct StrokeSettings {
  Brush brush;
  std::vector<int> bones;  // painted; several as one. JointCapsule: the child bone of the joint (its head and its parent's tail)
  BoneSet locked;
  Normalize normalize = Normalize::Unlocked;
  bool relative_to_locks = false;  // Add, Subtract, Set and Multiply take what locked bones leave of a voxel for the whole
  BrushFilter filter;
  bool rigid_bone_tissue = true;        // bone tissue is not painted
  std::optional<MirrorPlane> mirror;    // the same on the other side, on the bones of the other side (mirror_pairs)
};

// References are kept.
struct StrokeBody {
  const LabelVolume& volume;
  const TissueVoxels& tissue;
  const TissueTable& tissues;
  const Armature& armature;
};

class Stroke {
 public:
  // Throws std::logic_error for weights of another body, no bone or a bone that does not exist; Error where a JointCapsule's
  // bone has no parent.
  Stroke(const StrokeBody& body, std::shared_ptr<const SkinWeights> weights, StrokeSettings settings);
  ~Stroke();
  Stroke(Stroke&&) noexcept;
  Stroke& operator=(Stroke&&) noexcept;

  // The first call dabs once; the others dab along the straight way from the last place.
  //   point     world at rest, mm
  //   pressure  [0, 1] of the strength, between dabs as on the way
  void to(const glm::dvec3& point, double pressure = 1);

  // The brush has left the body: the next place is a beginning again.
  void lift();
  // A single dab, whatever the spacing.
  void dab(const glm::dvec3& centre, double pressure = 1);

  // As it is now.
  SkinWeights::Influences chunk(std::int64_t brick) const;
  const SkinWeights& original() const;
  // Bricks that changed since the last call, in order.
  std::vector<int> take_dirty();
  // Nothing differs from the original.
  bool empty() const;
  // Voxels that a lock kept from changing in some dab, and the locked bone that did so for most of them (-1: none).
  std::int64_t blocked_count() const;
  int blocked_by() const;
  int dab_count() const;

  // A copy that shares what has not changed. finish() takes the changed bricks out of the stroke, which is over then.
  SkinWeights weights() const;
  SkinWeights finish();

  std::int64_t memory_bytes() const;

 private:
  class Work;
  std::unique_ptr<Work> work_;
};

}  // namespace limber
