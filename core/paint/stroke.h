// SPDX-License-Identifier: AGPL-3.0-or-later
// One stroke of a brush over the weights of a body, from the press of the mouse button to its release. The weights
// given to the stroke are never changed, and only bricks that the stroke changes are copied. To cancel a stroke, delete
// it. When dabs do not accumulate, plain brushes only record the cover of each dab. The voxels are then painted when
// the result is read, once for all dabs since the last read. Results do not depend on the number of threads.
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
  // The painted bones. Several bones are painted as one bone with the sum of their weights. For JointCapsule, this is
  // the child bone of the joint between this bone's head and its parent's tail.
  std::vector<int> bones;
  BoneSet locked;
  Normalize normalize = Normalize::Unlocked;
  // If true, weight 1 in Add, Subtract, Set and Multiply means all the weight that a voxel's locked bones leave free.
  bool relative_to_locks = false;
  BrushFilter filter;
  bool rigid_bone_tissue = true;  // true: bone tissue is not painted
  // If set, each dab is repeated at its mirror image, with the bones of the other side (mirror_pairs).
  std::optional<MirrorPlane> mirror;
};

class Stroke {
 public:
  // Throws std::logic_error for weights of another body, for an empty list of bones and for a bone that does not exist.
  // Throws Error when the bone of a JointCapsule has no parent.
  Stroke(const WeightedBody& body, std::shared_ptr<const SkinWeights> weights, StrokeSettings settings);
  ~Stroke();
  Stroke(Stroke&&) noexcept;
  Stroke& operator=(Stroke&&) noexcept;

  // Moves the brush to `point`. The first call makes one dab. Each later call makes dabs along the straight line from
  // the previous point.
  //   point     world at rest, mm
  //   pressure  [0, 1], multiplies the strength; interpolated between calls
  void to(const glm::dvec3& point, double pressure = 1);

  // Ends the line of dabs; call this when the brush leaves the body. The next to() starts a new line.
  void lift();
  // Makes a single dab; the spacing of dabs does not apply to it.
  void dab(const glm::dvec3& centre, double pressure = 1);

  // Returns the weights of a brick after all dabs so far.
  SkinWeights::Influences chunk(std::int64_t brick) const;
  const SkinWeights& original() const;
  // Returns the indices of the bricks that have changed since the last call, sorted.
  std::vector<int> take_dirty();
  // Returns true if no weight differs from the weights before the stroke.
  bool empty() const;
  // blocked_count() returns the number of voxels that a locked bone kept from changing in some dab. blocked_by()
  // returns the locked bone that kept the most voxels from changing (-1: no bone).
  std::int64_t blocked_count() const;
  int blocked_by() const;
  int dab_count() const;

  // Both functions return the weights after all dabs. Bricks that have not changed are shared with the weights before
  // the stroke. finish() also ends the stroke: it moves the changed bricks out of this object.
  SkinWeights weights() const;
  SkinWeights finish();

  std::int64_t memory_bytes() const;

 private:
  class Work;
  std::unique_ptr<Work> work_;
};

}  // namespace limber
