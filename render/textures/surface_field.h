// SPDX-License-Identifier: AGPL-3.0-or-later
// A set of labels as a smooth body that rays can find: whether a voxel belongs to the set, blurred twice by [1 2 1]/4
// an axis into 8 bits (the body ends at kSurface), in atlases laid out like the volume's labels. What the blur would
// swallow (sheets and threads of one voxel) is raised so that it keeps its size.
//
// A texel under kFirstFieldValue is far from the set, and tells how far: v bricks away in the largest of the three
// axes, 0 for next to it. So a ray reads one texel for both, and skips 4 (v - 1) + 1 voxels.
//
// The bricks in which a ray can meet the body make its hull.
#pragma once

#include <cstdint>
#include <vector>

#include "render/gl/object.h"
#include "render/gl/program.h"
#include "render/textures/brick_hull.h"
#include "render/textures/volume_texture.h"

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
  const gl::Texture& occupancy() const {
    return occupancy_texture_;
  }  // 3D, a texel a brick: how much of it belongs to the set

  const Hull& hull() const { return hull_; }
  // False where no ray can meet the body in that box of padded coordinates.
  bool may_be_met(const glm::vec3& low, const glm::vec3& high) const;
  int revision() const { return revision_; }  // rises with every update

  // Samplers u_field0 .., u_index, and u_texel; returns the next free unit.
  int bind(const VolumeTexture& volume, gl::Program& program, int first) const;

  std::int64_t blocks_computed() const { return blocks_computed_; }  // by the last update

 private:
  void build_hull(const BlockLayout& layout);
  void build_upward();
  void build_occupancy(const VolumeTexture& volume);

  LabelSet set_;
  std::vector<std::uint8_t> distance_;  // by brick, bricks to the nearest one with a part of the blurred set, at most 7
  std::vector<std::uint8_t> in_hull_, occupancy_;
  std::vector<std::uint8_t> met_, upward_;  // by half a brick: whether a ray can meet the body there; how many further
                                            // up, along all axes, one first can
  glm::ivec3 bricks_{0};
  std::vector<gl::Texture> atlases_;
  gl::Texture index_, occupancy_texture_;
  Hull hull_;
  int revision_ = 0;
  std::int64_t blocks_computed_ = 0;
  std::vector<std::vector<Label>> labels_of_slot_;  // that its blurred voxels depend on
  std::vector<std::uint8_t> slot_present_;          // whether any texel of it is not empty
};

}  // namespace limber::render
