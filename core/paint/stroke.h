// SPDX-License-Identifier: AGPL-3.0-or-later
// One stroke of a brush over the weights of a body, from the press of the mouse button to its release. The original
// weights are never changed, and only bricks that the stroke changes are copied; to cancel a stroke, it is deleted.
// When dabs do not accumulate, plain brushes only record the cover of each dab. The voxels are painted when the result
// is read, once for all dabs since the last time. Results do not depend on the number of threads.
//
//   Stroke stroke(body, weights, settings);
//   stroke.to(cursor);  ...                        at each cursor movement; dabs are one spacing apart
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
  // The painted bones. Several bones are painted as one, by the sum of their weights. For JointCapsule: the child bone
  // of the joint, which lies between that bone's head and its parent's tail.
  std::vector<int> bones;
  BoneSet locked;
  Normalize normalize = Normalize::Unlocked;
  // true: for Add, Subtract, Set and Multiply, the weight 1 means all that the locked bones leave in a voxel.
  bool relative_to_locks = false;
  BrushFilter filter;
  bool rigid_bone_tissue = true;  // true: bone tissue is not painted
  // When it is set, each dab is repeated mirrored, with the bones of the other side (mirror_pairs).
  std::optional<MirrorPlane> mirror;
};

class Stroke {
 public:
  // Throws std::logic_error for weights of another body, for a list of no bones and for a bone that does not exist.
  // Throws Error when a JointCapsule's bone has no parent.
  Stroke(const WeightedBody& body, std::shared_ptr<const SkinWeights> weights, StrokeSettings settings);
  ~Stroke();
  Stroke(Stroke&&) noexcept;
  Stroke& operator=(Stroke&&) noexcept;

  // Moves the brush to `point`. Makes one dab at the first call, then dabs along the straight line from the last point.
  //   point     world at rest, mm
  //   pressure  [0, 1], multiplies the strength; interpolated between calls
  void to(const glm::dvec3& point, double pressure = 1);

  // Ends the line of dabs when the brush leaves the body. The next to() starts a new line.
  void lift();
  // Makes a single dab, without regard to the spacing.
  void dab(const glm::dvec3& centre, double pressure = 1);

  // Returns the weights of a brick after all dabs so far.
  SkinWeights::Influences chunk(std::int64_t brick) const;
  const SkinWeights& original() const;
  // Returns the indices of the bricks that changed since the last call, sorted.
  std::vector<int> take_dirty();
  // Returns whether all weights equal the original ones.
  bool empty() const;
  // blocked_count() returns the number of voxels that a locked bone kept from changing in some dab. blocked_by()
  // returns the locked bone that did so for most of them (-1: none).
  std::int64_t blocked_count() const;
  int blocked_by() const;
  int dab_count() const;

  // Both functions return the weights after all dabs; bricks that have not changed are shared with the original
  // weights. finish() also moves the changed bricks out of the stroke, which ends it.
  SkinWeights weights() const;
  SkinWeights finish();

  std::int64_t memory_bytes() const;

 private:
  class Work;
  std::unique_ptr<Work> work_;
};

}  // namespace limber
