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

#include "render/gl/object.h"
#include "render/gl/program.h"
#include "render/textures/brick_hull.h"
#include "render/textures/volume_texture.h"

namespace limber::render {

inline constexpr int kFirstFieldValue = 8;
// Value of the field at the surface, in 1/255 (0.385). With 0.5 the blur would shrink the area of an arm in a picture
// by 1 to 2 %.
inline constexpr int kSurface = 98;

using LabelSet = std::vector<std::uint8_t>;  // for each of the 65536 labels: 1 if the label is in the set

class VisibleField {
 public:
  VisibleField(const VolumeTexture& volume, LabelSet set);

  // Changes the set of labels. Computes the field again only in blocks that contain, or are near, an added or removed
  // label.
  void update(const VolumeTexture& volume, const LabelSet& set);
  const LabelSet& set() const { return set_; }
  // Returns a 3D texture with one texel per brick: the share of the brick that belongs to the set, blurred.
  const gl::Texture& occupancy() const { return occupancy_texture_; }

  const Hull& hull() const { return hull_; }
  // Returns false if no ray can hit the body in this box of padded coordinates.
  bool may_be_met(const glm::vec3& low, const glm::vec3& high) const;
  int revision() const { return revision_; }  // increases with every update

  // Sets the samplers u_field0 .. and u_index, on the texture units from `first` on, and the uniform u_texel. Returns
  // the next free unit.
  int bind(const VolumeTexture& volume, gl::Program& program, int first) const;

  std::int64_t blocks_computed() const { return blocks_computed_; }  // number of blocks that the last update computed

 private:
  void build_hull(const BlockLayout& layout);
  void build_upward();
  void build_occupancy(const VolumeTexture& volume);

  LabelSet set_;
  // For each brick: the distance in bricks to the nearest brick that has part of the blurred set, at most 7.
  std::vector<std::uint8_t> distance_;
  std::vector<std::uint8_t> in_hull_, occupancy_;
  // For each octant of each brick (2^3 voxels): whether a ray can hit the body there, and the distance to the nearest
  // octant towards higher x, y and z where a ray can hit it, in octants (the largest of the three axes).
  std::vector<std::uint8_t> met_, upward_;
  glm::ivec3 bricks_{0};
  std::vector<gl::Texture> atlases_;
  gl::Texture index_, occupancy_texture_;
  Hull hull_;
  int revision_ = 0;
  std::int64_t blocks_computed_ = 0;
  // For each slot: the labels in the voxels on which its field depends.
  std::vector<std::vector<Label>> labels_of_slot_;
  std::vector<std::uint8_t> slot_present_;  // for each slot: whether the set has voxels in or near it
};

}  // namespace limber::render
