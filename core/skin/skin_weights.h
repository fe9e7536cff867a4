// SPDX-License-Identifier: AGPL-3.0-or-later
// The skin weights of a body: up to four bones and their weights for every tissue voxel, in the brick order of
// TissueVoxels. Weights are whole numbers in 1/65535. In each voxel they sum to exactly 65535.
//
// The influences are stored brick by brick (8^3 voxels) in shared, packed, immutable chunks. A copy of the weights
// therefore costs one pointer per brick, and an edit clones only the bricks that it touches.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/skin/influence_chunk.h"
#include "core/volume/tissue_voxels.h"

namespace limber {

class SkinWeights {
 public:
  using Chunk = InfluenceChunk;               // the influences of one brick, in brick order
  using Influences = std::vector<Influence>;  // the influences of one brick, unpacked for editing

  SkinWeights() = default;
  // Makes weights in which every tissue voxel follows bone 0.
  SkinWeights(std::vector<std::string> bones, const TissueVoxels& tissue);
  // Makes weights from chunks, one for each brick, and shares them. Throws std::logic_error if a chunk is null.
  SkinWeights(std::vector<std::string> bones, std::vector<std::shared_ptr<const Chunk>> chunks);

  const std::vector<std::string>& bones() const { return bones_; }
  std::int64_t size() const { return size_; }

  // Returns the influences of a brick.
  //   brick  index in TissueVoxels::bricks()
  const Chunk& chunk(std::int64_t brick) const { return *chunks_[brick]; }
  // Returns a brick's chunk. Copies of weights share a chunk until it is replaced in one of them, so equal pointers
  // mean equal weights.
  const std::shared_ptr<const Chunk>& shared_chunk(std::int64_t brick) const { return chunks_[brick]; }
  std::int64_t chunk_count() const { return std::ssize(chunks_); }
  // Replaces a brick's chunk. Copies of these weights keep the old chunk. Throws std::logic_error if the number of
  // influences differs or the weights of a voxel do not sum to exactly kFullWeight.
  void set_chunk(std::int64_t brick, std::span<const Influence> influences);
  // Replaces a brick's chunk by the chunk that `from` has for this brick, and shares it. `from` must have the same
  // bones. Throws std::logic_error if the number of influences differs.
  void share_chunk(std::int64_t brick, const SkinWeights& from);

  bool operator==(const SkinWeights&) const;

 private:
  std::vector<std::string> bones_;
  std::int64_t size_ = 0;
  std::vector<std::shared_ptr<const Chunk>> chunks_;
};

}  // namespace limber
