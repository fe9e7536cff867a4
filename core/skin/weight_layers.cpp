// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/skin/weight_layers.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>

#include "core/base/error.h"
#include "core/base/parallel.h"
#include "core/skin/neighbour_weights.h"
#include "core/skin/transfer_to_volume.h"

namespace limber {

namespace {

constexpr std::int64_t kBricksAtOnce = 16;

// Mixes two influences: `cover` is the share of `above`, [0, 1]. A cover of 0 returns exactly `below`, a cover of 1
// exactly `above`.
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

void cover_with(SkinWeights::Influences& chunk, const WeightLayer& layer, std::int64_t brick) {
  if (!layer.visible || !layer.mask[brick]) return;
  const SkinWeights::Chunk& above = layer.weights.chunk(brick);
  for (std::size_t i = 0; i < chunk.size(); ++i) chunk[i] = mixed(chunk[i], above[i], layer.cover(brick, i));
}

// Returns a copy of `from` in which some bricks are replaced: make(brick) returns the influences of each brick for
// which wanted(brick) is true.
template <class Wanted, class Make>
SkinWeights made_from(const SkinWeights& from, const Wanted& wanted, const Make& make) {
  std::vector<SkinWeights::Influences> made(from.chunk_count());
  parallel_for(from.chunk_count(), kBricksAtOnce, [&](std::int64_t begin, std::int64_t end) {
    for (auto b = begin; b < end; ++b)
      if (wanted(b)) made[b] = make(b);
  });
  SkinWeights all = from;
  for (std::int64_t b = 0; b < from.chunk_count(); ++b)
    if (!made[b].empty() && made[b] != from.chunk(b)) all.set_chunk(b, std::move(made[b]));
  return all;
}

bool covers_all(const WeightLayer::Mask& mask) {
  return std::all_of(mask.begin(), mask.end(), [](std::uint16_t value) { return value != 0; });
}

const WeightLayer& layer_at(const WeightLayers& layers, std::size_t layer) {
  if (layer >= layers.layers.size()) throw std::logic_error("there is no such layer");
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

SkinWeights::Influences composed_chunk(const WeightLayers& layers, std::int64_t brick, std::size_t count) {
  SkinWeights::Influences chunk = layers.base->chunk(brick);
  for (std::size_t l = 0; l < count; ++l) cover_with(chunk, *layers.layers[l], brick);
  return chunk;
}

SkinWeights::Influences composed_over_base(const WeightLayers& layers, std::int64_t brick,
                                           SkinWeights::Influences base) {
  for (const auto& layer : layers.layers) cover_with(base, *layer, brick);
  return base;
}

SkinWeights composed(const WeightLayers& layers) {
  const auto covered = [&](std::int64_t brick) {
    return std::any_of(layers.layers.begin(), layers.layers.end(),
                       [&](const auto& layer) { return layer->visible && layer->mask[brick]; });
  };
  return made_from(*layers.base, covered,
                   [&](std::int64_t brick) { return composed_chunk(layers, brick, layers.layers.size()); });
}

std::vector<std::int64_t> changed_bricks(const WeightLayers& layers, const WeightLayers& before) {
  const std::int64_t count = layers.base->chunk_count();
  if (before.base->chunk_count() != count) throw std::logic_error("the layers belong to another body");
  // Returns the index of the first layer, from `from` upwards, that covers any part of the brick. Returns the number of
  // layers if none does.
  const auto next = [](const WeightLayers& of, std::size_t from, std::int64_t brick) {
    while (from < of.layers.size() &&
           (!of.layers[from]->visible || of.layers[from]->opacity == 0 || !of.layers[from]->mask[brick]))
      ++from;
    return from;
  };
  const auto differs = [&](std::int64_t brick) {
    if (layers.base->shared_chunk(brick) != before.base->shared_chunk(brick)) return true;
    std::size_t now = 0, was = 0;
    for (;; ++now, ++was) {
      now = next(layers, now, brick);
      was = next(before, was, brick);
      if (now == layers.layers.size() || was == before.layers.size())
        return now != layers.layers.size() || was != before.layers.size();
      const WeightLayer &a = *layers.layers[now], &b = *before.layers[was];
      if (a.opacity != b.opacity || a.mask[brick] != b.mask[brick] ||
          a.weights.shared_chunk(brick) != b.weights.shared_chunk(brick))
        return true;
    }
  };
  std::vector<std::int64_t> changed;
  for (std::int64_t brick = 0; brick < count; ++brick)
    if (differs(brick)) changed.push_back(brick);
  return changed;
}

SkinWeights recomposed(const WeightLayers& layers, const WeightLayers& before, const SkinWeights& came_out) {
  const std::vector<std::int64_t> changed = changed_bricks(layers, before);
  std::vector<SkinWeights::Influences> made(changed.size());
  parallel_for(std::ssize(changed), kBricksAtOnce, [&](std::int64_t begin, std::int64_t end) {
    for (auto i = begin; i < end; ++i) made[i] = composed_chunk(layers, changed[i], layers.layers.size());
  });
  SkinWeights all = came_out;
  for (std::size_t i = 0; i < changed.size(); ++i) {
    const std::int64_t b = changed[i];
    if (made[i] == layers.base->chunk(b)) all.share_chunk(b, *layers.base);
    else if (made[i] != came_out.chunk(b)) all.set_chunk(b, std::move(made[i]));
  }
  return all;
}

SkinWeights canvas(const WeightLayers& layers, std::size_t index) {
  const WeightLayer& layer = layer_at(layers, index);
  const std::int64_t count = layers.base->chunk_count();
  std::vector<std::uint8_t> whole(count);
  parallel_for(count, kBricksAtOnce, [&](std::int64_t begin, std::int64_t end) {
    for (auto b = begin; b < end; ++b) whole[b] = layer.mask[b] && covers_all(*layer.mask[b]);
  });
  const auto mixed_here = [&](std::int64_t brick) {
    return !whole[brick] && std::any_of(layers.layers.begin(), layers.layers.begin() + index + 1,
                                        [&](const auto& l) { return l->mask[brick] != nullptr; });
  };
  SkinWeights shown = made_from(*layers.base, mixed_here, [&](std::int64_t brick) {
    SkinWeights::Influences chunk = composed_chunk(layers, brick, index);
    if (layer.mask[brick])
      for (std::size_t i = 0; i < chunk.size(); ++i)
        if ((*layer.mask[brick])[i]) chunk[i] = layer.weights.chunk(brick)[i];
    return chunk;
  });
  for (std::int64_t b = 0; b < count; ++b)
    if (whole[b]) shown.share_chunk(b, layer.weights);
  return shown;
}

namespace {

// The weights and the mask of a layer in one brick, after painting.
struct PaintedBrick {
  SkinWeights::Influences weights;
  WeightLayer::Mask mask;
};

PaintedBrick painted_brick(const WeightLayer& layer, std::int64_t brick, const SkinWeights::Influences& was,
                           const SkinWeights::Influences& is) {
  PaintedBrick painted{layer.weights.chunk(brick),
                       layer.mask[brick] ? *layer.mask[brick] : WeightLayer::Mask(was.size(), 0)};
  for (std::size_t i = 0; i < was.size(); ++i) {
    if (was[i] == is[i]) continue;
    painted.weights[i] = is[i];
    painted.mask[i] = kFullWeight;
  }
  return painted;
}

}  // namespace

WeightLayer painted_on(const WeightLayer& layer, const SkinWeights& before, const SkinWeights& after) {
  if (before.size() != after.size() || before.size() != layer.weights.size())
    throw std::logic_error("the layer belongs to another body");
  WeightLayer painted = layer;
  for (std::int64_t b = 0; b < before.chunk_count(); ++b) {
    if (before.shared_chunk(b) == after.shared_chunk(b) || before.chunk(b) == after.chunk(b)) continue;
    PaintedBrick brick = painted_brick(layer, b, before.chunk(b), after.chunk(b));
    painted.weights.set_chunk(b, std::move(brick.weights));
    painted.mask[b] = std::make_shared<const WeightLayer::Mask>(std::move(brick.mask));
  }
  return painted;
}

namespace {

// Composes all layers in one brick. The layer `index` is composed with the weights and mask of `painted` instead of
// its own.
SkinWeights::Influences composed_with(const WeightLayers& layers, std::size_t index, std::int64_t brick,
                                      const PaintedBrick& painted) {
  const WeightLayer& layer = layer_at(layers, index);
  SkinWeights::Influences chunk = composed_chunk(layers, brick, index);
  if (layer.visible)
    for (std::size_t i = 0; i < chunk.size(); ++i)
      chunk[i] = mixed(chunk[i], painted.weights[i], layer.opacity * painted.mask[i] / kFullWeight);
  for (std::size_t above = index + 1; above < layers.layers.size(); ++above)
    cover_with(chunk, *layers.layers[above], brick);
  return chunk;
}

PaintedBrick masked_brick(const WeightLayers& layers, std::size_t index, std::int64_t brick,
                          const SkinWeights::Influences& is) {
  const WeightLayer& layer = layer_at(layers, index);
  PaintedBrick masked{layer.weights.chunk(brick), WeightLayer::Mask(is.size(), 0)};
  const SkinWeights::Influences below = composed_chunk(layers, brick, index);
  for (std::size_t i = 0; i < is.size(); ++i) {
    for (int k = 0; k < 4; ++k)
      if (is[i].weight[k] && is[i].bone[k] == kCovering) masked.mask[i] = is[i].weight[k];
    if (!layer.mask[brick] || (*layer.mask[brick])[i] == 0) masked.weights[i] = below[i];
  }
  return masked;
}

}  // namespace

SkinWeights::Influences composed_while_painted(const WeightLayers& layers, std::size_t index, std::int64_t brick,
                                               const SkinWeights::Influences& before,
                                               const SkinWeights::Influences& after) {
  return composed_with(layers, index, brick, painted_brick(layer_at(layers, index), brick, before, after));
}

SkinWeights::Influences composed_while_masked(const WeightLayers& layers, std::size_t index, std::int64_t brick,
                                              const SkinWeights::Influences& mask) {
  return composed_with(layers, index, brick, masked_brick(layers, index, brick, mask));
}

namespace {

// Makes the weights that a stroke paints to change a layer. Each voxel gets made(influence, cover). In bricks that the
// layer does not cover, every voxel follows bone 0.
template <class Made>
SkinWeights as_painted(const WeightLayer& layer, std::vector<std::string> bones, const Made& made) {
  // Chunks of voxels that all follow bone 0, by number of voxels, so that bricks of equal size share one chunk.
  std::map<std::size_t, std::shared_ptr<const SkinWeights::Chunk>> empty;
  std::vector<std::shared_ptr<const SkinWeights::Chunk>> chunks;
  for (std::int64_t b = 0; b < layer.weights.chunk_count(); ++b) {
    const std::size_t count = layer.weights.chunk(b).size();
    if (!layer.mask[b]) {
      auto& shared = empty[count];
      if (!shared) shared = std::make_shared<const SkinWeights::Chunk>(count, rigid_influence(0));
      chunks.push_back(shared);
      continue;
    }
    SkinWeights::Influences chunk(count);
    for (std::size_t i = 0; i < count; ++i) chunk[i] = made(layer.weights.chunk(b)[i], int{(*layer.mask[b])[i]});
    chunks.push_back(std::make_shared<const SkinWeights::Chunk>(chunk));
  }
  return {std::move(bones), std::move(chunks)};
}

// Stores a brick in the layer after painting. If the layer no longer covers anything in the brick, the brick's mask
// becomes null.
void put(WeightLayer& layer, std::int64_t brick, PaintedBrick painted) {
  const bool any =
      std::any_of(painted.mask.begin(), painted.mask.end(), [](std::uint16_t cover) { return cover != 0; });
  layer.weights.set_chunk(brick, std::move(painted.weights));
  layer.mask[brick] = any ? std::make_shared<const WeightLayer::Mask>(std::move(painted.mask)) : nullptr;
}

}  // namespace

SkinWeights mask_as_weights(const WeightLayer& layer) {
  static_assert(kNotCovering == 0);
  return as_painted(layer, {"not covering", "covering"}, [](const Influence&, int cover) {
    Influence made{{kNotCovering, kCovering, 0, 0},
                   {static_cast<std::uint16_t>(kFullWeight - cover), static_cast<std::uint16_t>(cover), 0, 0}};
    sort_influence(made);
    return made;
  });
}

WeightLayer mask_painted_on(const WeightLayers& layers, std::size_t index, const SkinWeights& before,
                            const SkinWeights& after) {
  WeightLayer layer = layer_at(layers, index);
  for (std::int64_t b = 0; b < before.chunk_count(); ++b) {
    if (before.shared_chunk(b) != after.shared_chunk(b)) put(layer, b, masked_brick(layers, index, b, after.chunk(b)));
  }
  return layer;
}

// ---- A layer as weights that a stroke can paint: first the bone kBelow (the weights below the layer), then its bones.

Armature with_below(const Armature& armature) {
  Armature more;
  more.bones.push_back({.name = "layers below", .tail = {0, 0, 1}});
  for (Bone bone : armature.bones) {
    bone.parent += 1;  // the rig's root becomes a child of kBelow
    more.bones.push_back(std::move(bone));
  }
  return more;
}

SkinWeights shares_as_weights(const WeightLayer& layer) {
  static_assert(kBelow == 0);
  std::vector<std::string> names{"layers below"};
  names.insert(names.end(), layer.weights.bones().begin(), layer.weights.bones().end());
  return as_painted(layer, std::move(names), [](const Influence& own, int cover) {
    std::vector<std::pair<int, double>> shares{{kBelow, kFullWeight - cover}};
    for (int i = 0; i < 4; ++i)
      if (own.weight[i]) shares.emplace_back(own.bone[i] + 1, double(own.weight[i]) * cover / kFullWeight);
    Influence made = quantize(shares);
    sort_influence(made);
    return made;
  });
}

namespace {

PaintedBrick shared_brick(const WeightLayer& layer, std::int64_t brick, const SkinWeights::Influences& was,
                          const SkinWeights::Influences& is) {
  PaintedBrick painted{layer.weights.chunk(brick),
                       layer.mask[brick] ? *layer.mask[brick] : WeightLayer::Mask(was.size(), 0)};
  for (std::size_t i = 0; i < was.size(); ++i) {
    if (was[i] == is[i]) continue;
    std::vector<std::pair<int, double>> own;
    int cover = 0;
    for (int k = 0; k < 4; ++k)
      if (is[i].weight[k] && is[i].bone[k] != kBelow)
        own.emplace_back(is[i].bone[k] - 1, is[i].weight[k]), cover += is[i].weight[k];
    painted.mask[i] = static_cast<std::uint16_t>(cover);
    if (!own.empty()) painted.weights[i] = quantize(own), sort_influence(painted.weights[i]);
  }
  return painted;
}

}  // namespace

SkinWeights::Influences composed_while_shared(const WeightLayers& layers, std::size_t index, std::int64_t brick,
                                              const SkinWeights::Influences& before,
                                              const SkinWeights::Influences& after) {
  return composed_with(layers, index, brick, shared_brick(layer_at(layers, index), brick, before, after));
}

WeightLayer shares_painted_on(const WeightLayer& layer, const SkinWeights& before, const SkinWeights& after) {
  WeightLayer painted = layer;
  for (std::int64_t b = 0; b < before.chunk_count(); ++b)
    if (before.shared_chunk(b) != after.shared_chunk(b))
      put(painted, b, shared_brick(layer, b, before.chunk(b), after.chunk(b)));
  return painted;
}

WeightLayers over_base(const WeightLayers& layers, std::shared_ptr<const SkinWeights> base) {
  if (base->chunk_count() != layers.base->chunk_count() || base->bones() != layers.base->bones())
    throw std::logic_error("the layers belong to another body");
  WeightLayers over{std::move(base), {}};
  for (const auto& layer : layers.layers) {
    WeightLayer next = *layer;
    for (std::int64_t b = 0; b < next.weights.chunk_count(); ++b)
      if (!next.mask[b]) next.weights.share_chunk(b, *over.base);
    over.layers.push_back(std::make_shared<const WeightLayer>(std::move(next)));
  }
  return over;
}

std::optional<WeightLayers> carried(const WeightLayers& layers, const std::vector<int>& to,
                                    const std::vector<std::string>& names) {
  const auto base = carried(*layers.base, to, names);
  if (!base) return std::nullopt;
  WeightLayers next{std::make_shared<const SkinWeights>(*base), {}};
  for (const auto& layer : layers.layers) {
    const auto weights = carried(layer->weights, to, names);
    if (!weights) return std::nullopt;
    WeightLayer own = *layer;
    own.weights = *weights;
    next.layers.push_back(std::make_shared<const WeightLayer>(std::move(own)));
  }
  return next;
}

WeightLayer with_mask(const WeightLayers& layers, std::size_t index, const TissueVoxels& tissue,
                      const TissueRegion& region, double cover) {
  WeightLayer layer = layer_at(layers, index);
  const SkinWeights shown = canvas(layers, index);
  const auto value = static_cast<std::uint16_t>(std::lround(std::clamp(cover, 0.0, 1.0) * kFullWeight));
  for (std::int64_t b = 0; b < layer.weights.chunk_count(); ++b) {
    const std::int64_t first = tissue.bricks()[b].first;
    SkinWeights::Influences own = layer.weights.chunk(b);
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
    if (!layer.visible)
      throw Error("a hidden layer cannot be merged", layer.name, "show the layer first, or delete it");
  };
  must_be_seen(upper);
  WeightLayers fewer = layers;
  fewer.layers.erase(fewer.layers.begin() + static_cast<std::ptrdiff_t>(index));
  const auto covered = [&](std::int64_t brick) { return upper.mask[brick] != nullptr; };
  if (index == 0) {
    fewer.base = std::make_shared<const SkinWeights>(made_from(*layers.base, covered, [&](std::int64_t brick) {
      SkinWeights::Influences chunk = layers.base->chunk(brick);
      cover_with(chunk, upper, brick);
      return chunk;
    }));
    return fewer;
  }
  // Two layers with covers a (lower) and b (upper) together cover 1 - (1 - a)(1 - b). In the merged layer, the upper
  // layer's weights have the share b / (1 - (1 - a)(1 - b)).
  const WeightLayer& lower = *layers.layers[index - 1];
  must_be_seen(lower);
  WeightLayer both = lower;
  both.opacity = 1;
  for (std::int64_t b = 0; b < lower.weights.chunk_count(); ++b) {
    if (!upper.mask[b] && (!lower.mask[b] || lower.opacity == 1)) continue;
    SkinWeights::Influences chunk = lower.weights.chunk(b);
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
