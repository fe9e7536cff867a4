// SPDX-License-Identifier: AGPL-3.0-or-later
// A set of labels as a smooth body for rays. The field is 1 for voxels of the set and 0 for others, in 8 bits. It is
// blurred twice by [1 2 1]/4 along each axis, and stored in atlases with the same layout as the volume's labels. The
// surface of the body is where the field has the value kSurface. Voxels that the blur would make vanish (sheets and
// threads of one voxel) get a higher value, so that they keep their size.
//
// A texel below kFirstFieldValue is far from the set and stores a distance instead of the field: v bricks, measured
// along the axis on which the distance is largest, with v = 0 in a brick that contains part of the blurred set. So a
// ray reads one texel for both purposes, and skips 4 (v - 1) + 1 voxels.
//
// The bricks in which a ray can hit the body form its hull.
#pragma once

#include <cstdint>
#include <vector>

#include "core/volume/label_volume.h"
#include "render/textures/brick_atlas.h"
#include "render/textures/brick_hull.h"

namespace limber::render {

inline constexpr int kFirstFieldValue = 8;
// Value of the field at the surface, in 1/255 (0.385). With 0.5 the blur would shrink the area of an arm in a picture
// by 1 to 2 %.
inline constexpr int kSurface = 98;

using LabelSet = std::vector<std::uint8_t>;  // for each of the 65536 labels: 1 if the label is in the set

// The field of a set in the main memory. It needs no OpenGL, so any thread may compute it.
class SurfaceField {
 public:
  // For each slot (stored block), the texels to upload; empty for a slot that does not need an upload.
  using Texels = std::vector<std::vector<std::uint8_t>>;

  // Changes the set of labels. Computes the field again only in blocks that contain, or are near, an added or removed
  // label. Returns the texels of the computed slots.
  //   drawn, layout  must be the same in every call, except for the slots in `changed` and for slots that were appended
  //                  to the layout
  //   changed        one byte per slot (missing bytes are 0); nonzero if the labels of the slot's voxels may have
  //   changed
  Texels update(const LabelVolume& drawn, const BlockLayout& layout, const LabelSet& set,
                const std::vector<std::uint8_t>& changed = {});
  const LabelSet& set() const { return set_; }

  // Return true if the last update changed the result of hull(), or of occupancy(). Painting labels inside a body
  // changes neither.
  bool hull_changed() const { return hull_changed_; }
  bool occupancy_changed() const { return occupancy_changed_; }

  // Returns the faces of the hull; their corners are counted in bricks.
  Hull::Faces hull() const;
  // Returns, for each brick, the fraction of its voxels that belong to the set, blurred over the neighbouring bricks.
  // It tells how enclosed a position is, which is used to darken creases.
  std::vector<std::uint8_t> occupancy() const;
  const glm::ivec3& bricks() const { return bricks_; }  // number of bricks per axis
  // Returns, for each slot, 1 if the set has voxels in the slot or near it.
  const std::vector<std::uint8_t>& slot_present() const { return slot_present_; }
  // Returns false if no ray can hit the body in this box of padded coordinates.
  bool may_be_met(const glm::vec3& low, const glm::vec3& high) const;

 private:
  void find_upward();

  LabelSet set_;
  bool hull_changed_ = true, occupancy_changed_ = true;
  // For each brick: the distance to the nearest brick that contains part of the blurred set, in bricks, at most 7.
  std::vector<std::uint8_t> distance_;
  std::vector<std::uint8_t> in_hull_, occupancy_;
  // For each octant of each brick (2^3 voxels): met_ is 1 if a ray can hit the body there. upward_ is the distance to
  // the nearest such octant towards higher x, y and z, in octants (the largest of the three axes). upward_ is empty if
  // no ray can hit the body anywhere.
  std::vector<std::uint8_t> met_, upward_;
  glm::ivec3 bricks_{0};
  // For each slot (stored block): the labels in the voxels on which the slot's field depends.
  std::vector<std::vector<Label>> labels_of_slot_;
  std::vector<std::uint8_t> slot_present_;
};

}  // namespace limber::render
