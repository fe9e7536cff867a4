// SPDX-License-Identifier: AGPL-3.0-or-later
// A set of labels as a smooth body that rays can find: whether a voxel belongs to the set, blurred twice by [1 2 1]/4 an
// axis into 8 bits (the body ends at kSurface), in atlases laid out like the volume's labels. What the blur would
// swallow (sheets and threads of one voxel) is raised so that it keeps its size.
//
// A texel under kFirstFieldValue is far from the set, and tells how far: v bricks away in the largest of the three axes,
// 0 for next to it. So a ray reads one texel for both, and skips 4 (v - 1) + 1 voxels.
//
// The bricks in which a ray can meet the body make a hull. Its outer faces are drawn first: they give each pixel the
// place to start from, and pixels beside the body no work at all.
#pragma once

#include <cstdint>
#include <vector>

#include "render/gl/object.h"
#include "render/gl/program.h"
#include "render/volume_texture.h"

namespace limber::render {

inline constexpr int kFirstFieldValue = 8;
// 0.385: at one half the blur would take 1 to 2 % off the area that an arm's voxels cover in a picture.
inline constexpr int kSurface = 98;

using LabelSet = std::vector<std::uint8_t>;  // by label, 65536: 1 when in the set

class VisibleField {
 public:
  VisibleField(const VolumeTexture& volume, LabelSet set);

  // Changes the set; only blocks that hold a label that came or went, or are near one, are computed again.
  void update(const VolumeTexture& volume, const LabelSet& set);
  const LabelSet& set() const { return set_; }
  const gl::Texture& occupancy() const { return occupancy_texture_; }  // 3D, a texel a brick: how much of it belongs to the set

  bool empty() const { return faces_ == 0; }
  // Corners of the hull, padded coordinates.
  const glm::vec3& low() const { return low_; }
  const glm::vec3& high() const { return high_; }

  // Samplers u_field0 .., u_index, and u_texel; returns the next free unit.
  int bind(const VolumeTexture& volume, gl::Program& program, int first) const;
  void draw_hull() const;  // its faces, counter-clockwise from outside in padded coordinates

  std::int64_t face_count() const { return faces_; }
  std::int64_t blocks_computed() const { return blocks_computed_; }  // by the last update

 private:
  void build_hull(const BlockLayout& layout);
  void build_occupancy(const VolumeTexture& volume);

  LabelSet set_;
  std::vector<std::uint8_t> distance_;   // by brick, bricks to the nearest one with a part of the blurred set, at most 7
  std::vector<std::uint8_t> hull_, occupancy_;
  std::vector<gl::Texture> atlases_;
  gl::Texture index_, occupancy_texture_;
  gl::Buffer vertices_, indices_;
  gl::VertexArray array_;
  std::int64_t faces_ = 0, blocks_computed_ = 0;
  glm::vec3 low_{0}, high_{0};
  std::vector<std::vector<Label>> labels_of_slot_;  // that its blurred voxels depend on
  std::vector<std::uint8_t> slot_present_;          // whether any texel of it is not empty
};

}  // namespace limber::render
