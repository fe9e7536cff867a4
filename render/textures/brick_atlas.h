// SPDX-License-Identifier: AGPL-3.0-or-later
// How a volume of any size lies in textures of bounded size: only what holds tissue is kept.
//
// The grid is padded by kPad voxels on each side and cut into blocks of 32^3 voxels; a block with tissue in or near it
// gets a slot of 36^3 texels (its voxels and an apron of 2 on each side, so that filtered reads and gradients never
// leave the slot) in an atlas, a 3D texture within the driver's limit. An index texture, one texel a block, tells the
// slot. Where one atlas is too small there are up to kMostAtlases; where these are too small, the volume is drawn
// coarser.
//
// The blocks are cut into bricks of 4^3 voxels: what a ray skips, and what its entry into the body is found by.
//
// Padded coordinates: voxel v covers [v + kPad, v + kPad + 1), its centre at v + kPad + 0.5.
#pragma once

#include <cstdint>
#include <vector>

#include <glm/glm.hpp>

#include "core/volume/label_volume.h"

namespace limber::render {

inline constexpr int kPad = 4;
inline constexpr int kBrick = 4;
inline constexpr int kBlock = 32;
inline constexpr int kApron = 2;
inline constexpr int kSlot = kBlock + 2 * kApron;
inline constexpr int kBricksPerBlock = kBlock / kBrick;  // an axis
inline constexpr int kMostAtlases = 4;

struct BlockLayout {
  glm::ivec3 blocks{0};            // #blocks an axis
  std::vector<int> slot_of_block;  // -1: nothing there
  std::vector<glm::ivec3> block_of_slot;
  glm::ivec3 slots{0};  // #slots an axis of one atlas
  int atlases = 0;

  glm::ivec3 bricks() const { return blocks * kBricksPerBlock; }
  std::int64_t block_index(const glm::ivec3& b) const {
    return b.x + std::int64_t{blocks.x} * (b.y + std::int64_t{blocks.y} * b.z);
  }
  std::int64_t brick_index(const glm::ivec3& b) const {
    return b.x + std::int64_t{bricks().x} * (b.y + std::int64_t{bricks().y} * b.z);
  }
  int slots_per_atlas() const { return slots.x * slots.y * slots.z; }
  int atlas_of(int slot) const { return slot / slots_per_atlas(); }
  glm::ivec3 place_of(int slot) const;  // in its atlas, in slots
};

// Blocks that hold tissue within kBrick voxels.
BlockLayout block_layout(const LabelVolume& volume);

// Gives the slots places; false when they do not fit textures of that many texels an axis.
bool place_slots(BlockLayout& layout, int largest_texture);

// Every second voxel an axis: the label most frequent among 2^3, tissue before air.
LabelVolume halved(const LabelVolume& volume);

}  // namespace limber::render
