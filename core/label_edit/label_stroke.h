// SPDX-License-Identifier: AGPL-3.0-or-later
// A stroke of a brush that paints or erases a label. The brush is a ball. Along the stroke it sweeps capsules, so that
// a fast stroke has no gaps and its border does not depend on how often the pointer's position was read. A flat brush
// is the disc of the ball in one plane, for painting slice by slice. A voxel changes when its centre is inside the
// brush.
//
//   LabelStroke stroke(volume, settings);
//   stroke.to(cursor);  ...                        at each movement; show stroke.volume() in stroke.last_box()
//   const LabelChange change = stroke.change();    what the stroke changed, for the document's next volume
#pragma once

#include <memory>
#include <optional>

#include "core/label_edit/edit_mask.h"
#include "core/label_edit/surroundings.h"

namespace limber {

struct LabelStrokeSettings {
  Label label = 0;      // the label to paint; with `erases`, the label to erase
  bool erases = false;  // true: voxels of `label` lose it
  Erased erased = Erased::Surroundings;
  double radius = 5;  // radius of the brush, mm; positive
  // Unit normal of the plane in which a flat brush paints, world; empty: the brush is a ball. If the plane is parallel
  // to layers of voxels, the brush paints the layer that contains its centre. Otherwise it paints the voxels whose
  // centres are at most half a voxel from the plane.
  std::optional<glm::dvec3> flat;
  EditMask mask;
};

class LabelStroke {
 public:
  // Paints on a copy of the volume, which must not be null. Throws std::logic_error for a radius that is not positive.
  //   copy  a copy of the volume that was made earlier, which nobody else may change: copying takes longer than
  //         painting one ball. null: the volume is copied now
  LabelStroke(std::shared_ptr<const LabelVolume> before, LabelStrokeSettings settings,
              std::shared_ptr<LabelVolume> copy = nullptr);

  // Moves the brush to `point` (world, mm). The first call after the start or after lift() paints one ball; each later
  // call paints the capsule from the previous point.
  void to(const glm::dvec3& point);
  void lift() { last_.reset(); }

  // Returns the volume with everything painted so far. Every call of to() changes this volume.
  const std::shared_ptr<const LabelVolume>& volume() const { return shown_; }
  const std::shared_ptr<const LabelVolume>& before() const { return before_; }
  // Returns the box of voxels that the last call of to() may have changed; size 0: nothing changed.
  const VoxelBox& last_box() const { return last_box_; }
  const VoxelBox& touched_box() const { return touched_; }
  bool empty() const { return touched_.size.x == 0; }
  LabelChange change() const { return label_difference(*before_, *painted_, touched_); }

 private:
  std::vector<std::int64_t> reached(const glm::dvec3& from, const glm::dvec3& to, VoxelBox& box) const;

  std::shared_ptr<const LabelVolume> before_;
  std::shared_ptr<LabelVolume> painted_;
  std::shared_ptr<const LabelVolume> shown_;  // points to the same volume as painted_, for readers
  LabelStrokeSettings settings_;
  MaskedGrid mask_;
  std::optional<glm::dvec3> last_;
  VoxelBox last_box_, touched_;
};

// Returns the smallest box that contains both boxes. A box of size 0 is ignored.
VoxelBox box_around(const VoxelBox& a, const VoxelBox& b);

}  // namespace limber
