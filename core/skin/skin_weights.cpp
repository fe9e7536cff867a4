// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/skin/skin_weights.h"

#include <stdexcept>

namespace limber {

SkinWeights::SkinWeights(std::vector<std::string> bones, const TissueVoxels& tissue)
    : bones_(std::move(bones)),
      size_(tissue.size()) {
  chunks_.reserve(tissue.bricks().size());
  for (const auto& brick : tissue.bricks())
    chunks_.push_back(std::make_shared<const Chunk>(brick.count(), rigid_influence(0)));
}

SkinWeights::SkinWeights(std::vector<std::string> bones, std::vector<std::shared_ptr<const Chunk>> chunks)
    : bones_(std::move(bones)),
      chunks_(std::move(chunks)) {
  for (const auto& chunk : chunks_) {
    if (!chunk) throw std::logic_error("SkinWeights: a chunk is missing");
    size_ += std::ssize(*chunk);
  }
}

void SkinWeights::set_chunk(std::int64_t brick, std::span<const Influence> influences) {
  if (influences.size() != chunks_[brick]->size())
    throw std::logic_error("SkinWeights: a chunk's length may not change");
  chunks_[brick] = std::make_shared<const Chunk>(influences);
}

void SkinWeights::share_chunk(std::int64_t brick, const SkinWeights& from) {
  if (from.chunk(brick).size() != chunks_[brick]->size())
    throw std::logic_error("SkinWeights: a chunk's length may not change");
  chunks_[brick] = from.chunks_[brick];
}

bool SkinWeights::operator==(const SkinWeights& other) const {
  if (bones_ != other.bones_ || size_ != other.size_ || chunks_.size() != other.chunks_.size()) return false;
  for (size_t i = 0; i < chunks_.size(); ++i)
    if (chunks_[i] != other.chunks_[i] && *chunks_[i] != *other.chunks_[i]) return false;
  return true;
}

}  // namespace limber
