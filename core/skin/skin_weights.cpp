// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/skin/skin_weights.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace limber {

Influence rigid_influence(int bone) {
  Influence influence;
  influence.bone[0] = static_cast<std::uint16_t>(bone);
  influence.weight[0] = kFullWeight;
  return influence;
}

Influence quantize(const std::vector<std::pair<int, double>>& weights) {
  // The best four by weight; of equal weights the lower bone, so that the result does not depend on the order given.
  std::array<std::pair<int, double>, 4> best;
  int count = 0;
  for (const auto& candidate : weights) {
    if (!(candidate.second > 0)) continue;
    int place = count < 4 ? count : 3;
    auto before = [](const auto& a, const auto& b) { return a.second > b.second || (a.second == b.second && a.first < b.first); };
    if (count == 4 && !before(candidate, best[3])) continue;
    while (place > 0 && before(candidate, best[place - 1])) {
      best[place] = best[place - 1];
      --place;
    }
    best[place] = candidate;
    count = std::min(count + 1, 4);
  }
  double sum = 0;
  for (int i = 0; i < count; ++i) sum += best[i].second;
  if (count == 0 || !std::isfinite(sum)) throw std::logic_error("quantize: weights sum to zero");

  Influence influence;
  int left = kFullWeight;
  for (int i = count - 1; i > 0; --i) {
    const int whole = static_cast<int>(std::lround(best[i].second / sum * kFullWeight));
    if (whole == 0) continue;
    influence.bone[i] = static_cast<std::uint16_t>(best[i].first);
    influence.weight[i] = static_cast<std::uint16_t>(whole);
    left -= whole;
  }
  influence.bone[0] = static_cast<std::uint16_t>(best[0].first);
  influence.weight[0] = static_cast<std::uint16_t>(left);
  return influence;
}

SkinWeights::SkinWeights(std::vector<std::string> bones, const TissueVoxels& tissue)
    : bones_(std::move(bones)), size_(tissue.size()) {
  chunks_.reserve(tissue.bricks().size());
  for (const auto& brick : tissue.bricks())
    chunks_.push_back(std::make_shared<const Chunk>(brick.count(), rigid_influence(0)));
}

namespace {
void check_sums(const SkinWeights::Chunk& chunk) {
  for (const Influence& influence : chunk)
    if (influence.weight[0] + influence.weight[1] + influence.weight[2] + influence.weight[3] != kFullWeight)
      throw std::logic_error("SkinWeights: an influence does not sum to one");
}
}  // namespace

SkinWeights::SkinWeights(std::vector<std::string> bones, std::vector<std::shared_ptr<const Chunk>> chunks)
    : bones_(std::move(bones)), chunks_(std::move(chunks)) {
  for (const auto& chunk : chunks_) {
    if (!chunk) throw std::logic_error("SkinWeights: a chunk is missing");
    check_sums(*chunk);
    size_ += std::ssize(*chunk);
  }
}

void SkinWeights::set_chunk(std::int64_t brick, Chunk chunk) {
  if (chunk.size() != chunks_[brick]->size()) throw std::logic_error("SkinWeights: a chunk's length may not change");
  check_sums(chunk);
  chunks_[brick] = std::make_shared<const Chunk>(std::move(chunk));
}

void SkinWeights::share_chunk(std::int64_t brick, const SkinWeights& from) {
  if (from.chunk(brick).size() != chunks_[brick]->size()) throw std::logic_error("SkinWeights: a chunk's length may not change");
  chunks_[brick] = from.chunks_[brick];
}

bool SkinWeights::operator==(const SkinWeights& other) const {
  if (bones_ != other.bones_ || size_ != other.size_ || chunks_.size() != other.chunks_.size()) return false;
  for (size_t i = 0; i < chunks_.size(); ++i)
    if (chunks_[i] != other.chunks_[i] && *chunks_[i] != *other.chunks_[i]) return false;
  return true;
}

}  // namespace limber
