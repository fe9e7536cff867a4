// SPDX-License-Identifier: AGPL-3.0-or-later
// The layout of a volume of any size in textures of limited size: only regions with tissue are stored.
//
// The grid is padded by kPad voxels on each side and divided into blocks of 32^3 voxels. A block with tissue in or near
// it gets a slot of 36^3 texels in an atlas. An atlas is a 3D texture within the size limit of the driver. A slot has
// the block's voxels and an apron of 2 voxels on each side, so that filtered reads and gradients never leave the slot.
// An index texture, with one texel per block, stores the position of the block's slot. A volume that does not fit in
// one atlas is spread over up to kMostAtlases. A volume that does not fit in these either is drawn at a coarser
// resolution.
//
// Blocks are divided into bricks of 4^3 voxels. Rays skip empty bricks, and the hull of a body is made of bricks.
//
// Padded coordinates: voxel v covers [v + kPad, v + kPad + 1), and its centre is at v + kPad + 0.5.
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
inline constexpr int kBricksPerBlock = kBlock / kBrick;  // number of bricks per axis of a block
inline constexpr int kMostAtlases = 4;

inline AffineTransform padded_from_world(const Grid& grid) {
  AffineTransform transform = voxel_from_world(grid);
  transform.offset += kPad + 0.5;
  return transform;
}

struct BlockLayout {
  glm::ivec3 blocks{0};            // number of blocks per axis
  std::vector<int> slot_of_block;  // slot of each block; -1: the block has no slot
  std::vector<glm::ivec3> block_of_slot;
  glm::ivec3 slots{0};  // number of slots per axis of one atlas
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
  glm::ivec3 place_of(int slot) const;  // returns the position of a slot in its atlas, counted in slots
};

// Returns the blocks and slots of a volume: each block that has tissue within kBrick voxels gets a slot.
BlockLayout block_layout(const LabelVolume& volume);

// Arranges the slots in atlases. Returns false when they do not fit in kMostAtlases textures with largest_texture
// texels per axis.
bool place_slots(BlockLayout& layout, int largest_texture);

// Returns the grid of a volume at half its resolution.
Grid halved(const Grid& grid);
// Returns the volume at half its resolution: each voxel gets the most frequent tissue of 2^3 voxels, or air if more
// than half of these voxels are air.
LabelVolume halved(const LabelVolume& volume);

}  // namespace limber::render
