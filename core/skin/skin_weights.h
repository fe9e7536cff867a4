// SPDX-License-Identifier: AGPL-3.0-or-later
// How tissue follows the bones: up to four bones and weights for every tissue voxel, in the brick order of
// TissueVoxels. Weights are whole numbers of 1/65535 and sum to exactly 65535, always.
//
// The influences are stored brick by brick in shared, packed, immutable chunks, so that a copy costs one pointer a
// brick and an edit clones only the bricks it touches.
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
  using Chunk = InfluenceChunk;               // one brick's, in brick order
  using Influences = std::vector<Influence>;  // the same to be worked on

  SkinWeights() = default;
  // Every tissue voxel of `tissue` on bone 0.
  SkinWeights(std::vector<std::string> bones, const TissueVoxels& tissue);
  // Shares the chunks. Throws std::logic_error if one is null.
  SkinWeights(std::vector<std::string> bones, std::vector<std::shared_ptr<const Chunk>> chunks);

  const std::vector<std::string>& bones() const { return bones_; }
  std::int64_t size() const { return size_; }

  // `brick` as in TissueVoxels::bricks().
  const Chunk& chunk(std::int64_t brick) const { return *chunks_[brick]; }
  // Copies of weights share the chunks that are equal in both, unless they were set.
  const std::shared_ptr<const Chunk>& shared_chunk(std::int64_t brick) const { return chunks_[brick]; }
  std::int64_t chunk_count() const { return std::ssize(chunks_); }
  // Leaves the chunk of copies as it is. Throws std::logic_error if the length differs or a sum is not exact.
  void set_chunk(std::int64_t brick, std::span<const Influence> influences);
  // Shares the chunk that other weights of the same bones have there. Throws std::logic_error if its length differs.
  void share_chunk(std::int64_t brick, const SkinWeights& from);

  bool operator==(const SkinWeights&) const;

 private:
  std::vector<std::string> bones_;
  std::int64_t size_ = 0;
  std::vector<std::shared_ptr<const Chunk>> chunks_;
};

}  // namespace limber
