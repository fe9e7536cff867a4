// SPDX-License-Identifier: AGPL-3.0-or-later
// One stroke of a brush over the weights of a body, from press to release. Only bricks that change are cloned; the
// original weights are never touched, so that giving a stroke up costs nothing. Where dabs do not accumulate they only
// note what they cover; voxels are painted when somebody looks, once for all dabs since. The same for any number of
// threads.
//
//   Stroke stroke(body, weights, settings);
//   stroke.to(cursor);  ...                        as often as the cursor moves; dabs stand a spacing apart
//   for (int brick : stroke.take_dirty()) upload(brick, stroke.chunk(brick));
//   if (!stroke.empty()) document.weights = std::make_shared<const SkinWeights>(stroke.finish());
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "core/paint/brush_rule.h"
#include "core/rig/mirror.h"
#include "core/skin/normalize.h"
#include "core/skin/weighted_body.h"

namespace limber {

struct StrokeSettings {
  Brush brush;
  std::vector<int>
      bones;  // painted; several as one. JointCapsule: the child bone of the joint (its head and its parent's tail)
  BoneSet locked;
  Normalize normalize = Normalize::Unlocked;
  bool relative_to_locks =
      false;  // Add, Subtract, Set and Multiply take what locked bones leave of a voxel for the whole
  BrushFilter filter;
  bool rigid_bone_tissue = true;      // bone tissue is not painted
  std::optional<MirrorPlane> mirror;  // the same on the other side, on the bones of the other side (mirror_pairs)
};

class Stroke {
 public:
  // Throws std::logic_error for weights of another body, no bone or a bone that does not exist; Error where a
  // JointCapsule's bone has no parent.
  Stroke(const WeightedBody& body, std::shared_ptr<const SkinWeights> weights, StrokeSettings settings);
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
