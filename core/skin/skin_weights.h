// SPDX-License-Identifier: AGPL-3.0-or-later
// How tissue follows the bones: up to four bones and weights for every tissue voxel, in the brick order of
// TissueVoxels. Weights are whole numbers of 1/65535 and sum to exactly 65535, always.
//
// The influences are stored brick by brick in shared immutable chunks, so that a copy costs one pointer a brick and
// an edit clones only the bricks it touches.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "core/volume/tissue_voxels.h"

namespace limber {

constexpr int kFullWeight = 65535;

struct Influence {
  std::array<std::uint16_t, 4> bone{};    // by falling weight; 0 where the weight is 0
  std::array<std::uint16_t, 4> weight{};  // in 1/65535, sum exactly kFullWeight

  bool operator==(const Influence&) const = default;
  double of(int b) const {
    for (int i = 0; i < 4; ++i)
      if (bone[i] == b && weight[i]) return weight[i] / double(kFullWeight);
    return 0;
  }
};

Influence rigid_influence(int bone);

// The four largest of `weights` (any length, not negative, need not sum to one), rounded so that the sum is exact.
// A sum of zero is a mistake of the caller.
Influence quantize(const std::vector<std::pair<int, double>>& weights);

class SkinWeights {
 public:
  using Chunk = std::vector<Influence>;  // one brick's, in brick order

  SkinWeights() = default;
  // Every tissue voxel of `tissue` on bone 0.
  SkinWeights(std::vector<std::string> bones, const TissueVoxels& tissue);
  // Shares the chunks. Throws std::logic_error if one is null or a sum is not exact.
  SkinWeights(std::vector<std::string> bones, std::vector<std::shared_ptr<const Chunk>> chunks);

  const std::vector<std::string>& bones() const { return bones_; }
  std::int64_t size() const { return size_; }

  // `brick` as in TissueVoxels::bricks().
  const Chunk& chunk(std::int64_t brick) const { return *chunks_[brick]; }
  // Copies of weights share the chunks that are equal in both, unless they were set.
  const std::shared_ptr<const Chunk>& shared_chunk(std::int64_t brick) const { return chunks_[brick]; }
  std::int64_t chunk_count() const { return std::ssize(chunks_); }
  // Clones the chunk if it is shared. Throws std::logic_error if `chunk`'s length differs or a sum is not exact.
  void set_chunk(std::int64_t brick, Chunk chunk);
  // Shares the chunk that other weights of the same bones have there. Throws std::logic_error if its length differs.
  void share_chunk(std::int64_t brick, const SkinWeights& from);

  bool operator==(const SkinWeights&) const;

 private:
  std::vector<std::string> bones_;
  std::int64_t size_ = 0;
  std::vector<std::shared_ptr<const Chunk>> chunks_;
};

}  // namespace limber
