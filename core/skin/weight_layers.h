// SPDX-License-Identifier: AGPL-3.0-or-later
// Weights in layers over a base: each has its own weights, a mask that says where and how much it covers, and an
// opacity. The layers are put together from the bottom up, what is below shining through where a layer covers less, and
// what comes out is normalized like any weights. Nothing below is changed by what is painted above it.
//
// Painting on a layer: a stroke (or any edit) starts from canvas(), which shows the layer where it covers and what is
// below it elsewhere; painted_on() takes what it changed into the layer and lets the layer cover there.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/skin/weight_edits.h"

namespace limber {

struct WeightLayer {
  using Mask = std::vector<std::uint16_t>;  // one brick's, in 1/65535

  std::string name;
  bool visible = true;
  double opacity = 1;  // [0, 1]
  SkinWeights weights;
  std::vector<std::shared_ptr<const Mask>> mask;  // #bricks; null: covers nothing there

  // What it covers, [0, 1], as seen.    i  in the brick's chunk
  double cover(std::int64_t brick, std::size_t i) const {
    return visible && mask[brick] ? opacity * (*mask[brick])[i] / kFullWeight : 0;
  }
};

struct WeightLayers {
  std::shared_ptr<const SkinWeights> base;
  std::vector<std::shared_ptr<const WeightLayer>> layers;  // the lowest first
};

// A layer that covers nothing, at the top.
WeightLayers with_new_layer(const WeightLayers& layers, const std::string& name);

// One brick of what comes out, of the base and the first `count` layers.
SkinWeights::Influences composed_chunk(const WeightLayers& layers, std::int64_t brick, std::size_t count);
// All of it. Bricks that no layer covers are shared with the base.
SkinWeights composed(const WeightLayers& layers);
// The bricks whose weights may come out otherwise than of `before`, layers of the same body. Those whose parts are
// shared do not.
std::vector<std::int64_t> changed_bricks(const WeightLayers& layers, const WeightLayers& before);
// composed(layers), made anew only in those bricks; the others are those of `came_out`, which is composed(before).
SkinWeights recomposed(const WeightLayers& layers, const WeightLayers& before, const SkinWeights& came_out);

// What is painted on when this layer is. Bricks that only one of them covers, and that wholly, are shared with it.
SkinWeights canvas(const WeightLayers& layers, std::size_t layer);
// The layer after its canvas was changed from `before` to `after`: where they differ it has what is new, and covers
// fully.
WeightLayer painted_on(const WeightLayer& layer, const SkinWeights& before, const SkinWeights& after);
// One brick of what would come out then, or with another base.
SkinWeights::Influences composed_over_base(const WeightLayers& layers, std::int64_t brick,
                                           SkinWeights::Influences base);
SkinWeights::Influences composed_while_painted(const WeightLayers& layers, std::size_t layer, std::int64_t brick,
                                               const SkinWeights::Influences& before,
                                               const SkinWeights::Influences& after);

// A mask as weights that a stroke can paint: what the layer covers follows kCovering, the rest kNotCovering.
constexpr int kNotCovering = 0, kCovering = 1;
SkinWeights mask_as_weights(const WeightLayer& layer);
SkinWeights::Influences composed_while_masked(const WeightLayers& layers, std::size_t layer, std::int64_t brick,
                                              const SkinWeights::Influences& mask);
// The layer after its mask was changed. Where it did not cover before it now has what its canvas shows.
WeightLayer mask_painted_on(const WeightLayers& layers, std::size_t layer, const SkinWeights& before,
                            const SkinWeights& after);

// A layer as weights that a stroke can paint while its bones keep what they have (Normalize::WhenComposed): what lies
// below it stands before its bones, as kBelow, and gives what the painted one gains. Where the others are locked
// nothing else can.
constexpr int kBelow = 0;
SkinWeights shares_as_weights(const WeightLayer& layer);
Armature with_below(const Armature& armature);
SkinWeights::Influences composed_while_shared(const WeightLayers& layers, std::size_t layer, std::int64_t brick,
                                              const SkinWeights::Influences& before,
                                              const SkinWeights::Influences& after);
// The layer after its shares were changed: it covers as much as its bones have together.
WeightLayer shares_painted_on(const WeightLayer& layer, const SkinWeights& before, const SkinWeights& after);

// The mask becomes `cover` [0, 1] in the region (empty: everywhere). Where the layer did not cover before it now has
// what its canvas shows.
WeightLayer with_mask(const WeightLayers& layers, std::size_t layer, const TissueVoxels& tissue,
                      const TissueRegion& region, double cover);

// The same layers over another base; what a layer does not cover it shares with it.
WeightLayers over_base(const WeightLayers& layers, std::shared_ptr<const SkinWeights> base);

// After bones were added to the rig, removed from it or put in another order: see transfer_to_volume.h.
std::optional<WeightLayers> carried(const WeightLayers& layers, const std::vector<int>& to,
                                    const std::vector<std::string>& names);

// The layer joined with the one below it, or with the base: what comes out stays the same (to the four bones a voxel
// can have). Throws Error where either layer is hidden.
WeightLayers merged_down(const WeightLayers& layers, std::size_t layer);

}  // namespace limber
