// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/skin/weight_layers.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "core/base/error.h"
#include "core/base/parallel.h"
#include "core/skin/weights_around.h"

namespace limber {

namespace {

constexpr std::int64_t kBricksAtOnce = 16;

// Exactly the one or the other at the ends.
Influence mixed(const Influence& below, const Influence& above, double cover) {
  if (cover <= 0 || below == above) return below;
  if (cover >= 1) return above;
  WeightSum sum;
  add_to(sum, below, 1 - cover);
  add_to(sum, above, cover);
  Influence made = quantize(sum);
  sort_influence(made);
  return made;
}

void cover_with(SkinWeights::Chunk& chunk, const WeightLayer& layer, std::int64_t brick) {
  if (!layer.visible || !layer.mask[brick]) return;
  const SkinWeights::Chunk& above = layer.weights.chunk(brick);
  for (std::size_t i = 0; i < chunk.size(); ++i) chunk[i] = mixed(chunk[i], above[i], layer.cover(brick, i));
}

// make(brick) for the bricks for which `wanted` says so; the others are those of `from`.
template <class Wanted, class Make>
SkinWeights made_from(const SkinWeights& from, const Wanted& wanted, const Make& make) {
  std::vector<SkinWeights::Chunk> made(from.chunk_count());
  parallel_for(from.chunk_count(), kBricksAtOnce, [&](std::int64_t begin, std::int64_t end) {
    for (auto b = begin; b < end; ++b)
      if (wanted(b)) made[b] = make(b);
  });
  SkinWeights all = from;
  for (std::int64_t b = 0; b < from.chunk_count(); ++b)
    if (!made[b].empty() && made[b] != from.chunk(b)) all.set_chunk(b, std::move(made[b]));
  return all;
}

const WeightLayer& layer_at(const WeightLayers& layers, std::size_t layer) {
  if (layer >= layers.layers.size()) throw std::logic_error("no such layer");
  return *layers.layers[layer];
}

}  // namespace

WeightLayers with_new_layer(const WeightLayers& layers, const std::string& name) {
  WeightLayers more = layers;
  auto layer = std::make_shared<WeightLayer>();
  layer->name = name;
  layer->weights = *layers.base;
  layer->mask.resize(layers.base->chunk_count());
  more.layers.push_back(std::move(layer));
  return more;
}

SkinWeights::Chunk composed_chunk(const WeightLayers& layers, std::int64_t brick, std::size_t count) {
  SkinWeights::Chunk chunk = layers.base->chunk(brick);
  for (std::size_t l = 0; l < count; ++l) cover_with(chunk, *layers.layers[l], brick);
  return chunk;
}

SkinWeights composed(const WeightLayers& layers) {
  const auto covered = [&](std::int64_t brick) {
    return std::any_of(layers.layers.begin(), layers.layers.end(), [&](const auto& layer) { return layer->visible && layer->mask[brick]; });
  };
  return made_from(*layers.base, covered, [&](std::int64_t brick) { return composed_chunk(layers, brick, layers.layers.size()); });
}

SkinWeights canvas(const WeightLayers& layers, std::size_t index) {
  const WeightLayer& layer = layer_at(layers, index);
  const auto covered = [&](std::int64_t brick) {
    return std::any_of(layers.layers.begin(), layers.layers.begin() + index + 1, [&](const auto& l) { return l->mask[brick] != nullptr; });
  };
  return made_from(*layers.base, covered, [&](std::int64_t brick) {
    SkinWeights::Chunk chunk = composed_chunk(layers, brick, index);
    if (layer.mask[brick])
      for (std::size_t i = 0; i < chunk.size(); ++i)
        if ((*layer.mask[brick])[i]) chunk[i] = layer.weights.chunk(brick)[i];
    return chunk;
  });
}

WeightLayer painted_on(const WeightLayer& layer, const SkinWeights& before, const SkinWeights& after) {
  if (before.size() != after.size() || before.size() != layer.weights.size()) throw std::logic_error("a layer of another body");
  WeightLayer painted = layer;
  for (std::int64_t b = 0; b < before.chunk_count(); ++b) {
    const SkinWeights::Chunk &was = before.chunk(b), &is = after.chunk(b);
    if (before.shared_chunk(b) == after.shared_chunk(b) || was == is) continue;
    SkinWeights::Chunk own = layer.weights.chunk(b);
    WeightLayer::Mask mask = layer.mask[b] ? *layer.mask[b] : WeightLayer::Mask(was.size(), 0);
    for (std::size_t i = 0; i < was.size(); ++i) {
      if (was[i] == is[i]) continue;
      own[i] = is[i];
      mask[i] = kFullWeight;
    }
    painted.weights.set_chunk(b, std::move(own));
    painted.mask[b] = std::make_shared<const WeightLayer::Mask>(std::move(mask));
  }
  return painted;
}

WeightLayer with_mask(const WeightLayers& layers, std::size_t index, const TissueVoxels& tissue, const TissueRegion& region, double cover) {
  WeightLayer layer = layer_at(layers, index);
  const SkinWeights shown = canvas(layers, index);
  const auto value = static_cast<std::uint16_t>(std::lround(std::clamp(cover, 0.0, 1.0) * kFullWeight));
  for (std::int64_t b = 0; b < layer.weights.chunk_count(); ++b) {
    const std::int64_t first = tissue.bricks()[b].first;
    SkinWeights::Chunk own = layer.weights.chunk(b);
    WeightLayer::Mask mask = layer.mask[b] ? *layer.mask[b] : WeightLayer::Mask(own.size(), 0);
    bool changed = false, any = false;
    for (std::size_t i = 0; i < own.size(); ++i) {
      if ((region.empty() || region[first + i]) && mask[i] != value) {
        if (mask[i] == 0) own[i] = shown.chunk(b)[i];
        mask[i] = value;
        changed = true;
      }
      any = any || mask[i];
    }
    if (!changed) continue;
    layer.weights.set_chunk(b, std::move(own));
    layer.mask[b] = any ? std::make_shared<const WeightLayer::Mask>(std::move(mask)) : nullptr;
  }
  return layer;
}

WeightLayers merged_down(const WeightLayers& layers, std::size_t index) {
  const WeightLayer& upper = layer_at(layers, index);
  const auto must_be_seen = [](const WeightLayer& layer) {
    if (!layer.visible) throw Error("a hidden layer cannot be merged", layer.name, "show it first, or delete it");
  };
  must_be_seen(upper);
  WeightLayers fewer = layers;
  fewer.layers.erase(fewer.layers.begin() + static_cast<std::ptrdiff_t>(index));
  const auto covered = [&](std::int64_t brick) { return upper.mask[brick] != nullptr; };
  if (index == 0) {
    fewer.base = std::make_shared<const SkinWeights>(made_from(*layers.base, covered, [&](std::int64_t brick) {
      SkinWeights::Chunk chunk = layers.base->chunk(brick);
      cover_with(chunk, upper, brick);
      return chunk;
    }));
    return fewer;
  }
  // Two covers a and b one above the other cover 1 - (1 - a)(1 - b); of that the upper has b.
  const WeightLayer& lower = *layers.layers[index - 1];
  must_be_seen(lower);
  WeightLayer both = lower;
  both.opacity = 1;
  for (std::int64_t b = 0; b < lower.weights.chunk_count(); ++b) {
    if (!upper.mask[b] && (!lower.mask[b] || lower.opacity == 1)) continue;
    SkinWeights::Chunk chunk = lower.weights.chunk(b);
    WeightLayer::Mask mask(chunk.size());
    for (std::size_t i = 0; i < chunk.size(); ++i) {
      const double below = lower.cover(b, i), above = upper.cover(b, i), all = 1 - (1 - below) * (1 - above);
      mask[i] = static_cast<std::uint16_t>(std::lround(all * kFullWeight));
      if (above > 0) chunk[i] = mixed(chunk[i], upper.weights.chunk(b)[i], above / all);
    }
    both.weights.set_chunk(b, std::move(chunk));
    both.mask[b] = std::make_shared<const WeightLayer::Mask>(std::move(mask));
  }
  fewer.layers[index - 1] = std::make_shared<const WeightLayer>(std::move(both));
  return fewer;
}

}  // namespace limber
