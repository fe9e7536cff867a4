// SPDX-License-Identifier: AGPL-3.0-or-later
// Layers of weights over base weights, like the layers of a picture. A layer has its own weights, an opacity, and a
// mask that says how much it covers each voxel. Layers are composed from the bottom up: where a layer covers less, more
// of the weights below it remains. The composed weights are normalized like any weights. Painting on a layer changes
// nothing below it.
//
// To paint on a layer, a stroke (or any edit) starts from canvas(): the layer's own weights where it covers, and the
// composed weights of the layers below elsewhere. Then painted_on() stores the changes in the layer, which covers fully
// where something changed.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/skin/weight_edits.h"

namespace limber {

struct WeightLayer {
  using Mask = std::vector<std::uint16_t>;  // how much the layer covers each tissue voxel of a brick, in 1/65535

  std::string name;
  bool visible = true;
  double opacity = 1;  // opacity of the layer, [0, 1]
  SkinWeights weights;
  std::vector<std::shared_ptr<const Mask>> mask;  // mask of each brick; null: the layer covers nothing there

  // Returns how much the layer covers a voxel, [0, 1]: the mask times the opacity, or 0 if the layer is hidden.
  //   i  the voxel's index in the brick's chunk
  double cover(std::int64_t brick, std::size_t i) const {
    return visible && mask[brick] ? opacity * (*mask[brick])[i] / kFullWeight : 0;
  }
};

struct WeightLayers {
  std::shared_ptr<const SkinWeights> base;
  std::vector<std::shared_ptr<const WeightLayer>> layers;  // the layers, lowest first
};

// Adds an empty layer on top of the others. It covers nothing yet.
WeightLayers with_new_layer(const WeightLayers& layers, const std::string& name);

// Returns the composed weights of one brick, using the base and only the lowest `count` layers.
SkinWeights::Influences composed_chunk(const WeightLayers& layers, std::int64_t brick, std::size_t count);
// Returns the composed weights of all layers. Bricks that no layer covers are shared with the base.
SkinWeights composed(const WeightLayers& layers);
// Returns the bricks whose composed weights may differ between `layers` and `before`, two states of the layers of one
// body. A brick whose chunks and masks are shared by the two states does not differ.
std::vector<std::int64_t> changed_bricks(const WeightLayers& layers, const WeightLayers& before);
// Returns composed(layers), but computes only the bricks that changed_bricks() returns. The other bricks are copied
// from `came_out`, which must be composed(before).
SkinWeights recomposed(const WeightLayers& layers, const WeightLayers& before, const SkinWeights& came_out);

// Returns the weights that a stroke on this layer starts from. Bricks that the layer covers completely share the
// layer's chunks. Bricks that neither this layer nor a lower one covers share the base's chunks.
SkinWeights canvas(const WeightLayers& layers, std::size_t layer);
// Returns the layer after a stroke has changed its canvas (the weights from canvas()) from `before` to `after`. Where
// the two differ, the layer has the weights of `after` and covers fully.
WeightLayer painted_on(const WeightLayer& layer, const SkinWeights& before, const SkinWeights& after);
// Both functions compose one brick for a preview. composed_over_base() uses another base. composed_while_painted()
// composes the layer as if a stroke had changed its canvas (the weights from canvas()) from `before` to `after`.
SkinWeights::Influences composed_over_base(const WeightLayers& layers, std::int64_t brick,
                                           SkinWeights::Influences base);
SkinWeights::Influences composed_while_painted(const WeightLayers& layers, std::size_t layer, std::int64_t brick,
                                               const SkinWeights::Influences& before,
                                               const SkinWeights::Influences& after);

// Represents a mask as weights of two bones, so that a stroke can paint the mask. The weight of kCovering is the mask's
// value, and kNotCovering has the remaining weight.
constexpr int kNotCovering = 0, kCovering = 1;
SkinWeights mask_as_weights(const WeightLayer& layer);
SkinWeights::Influences composed_while_masked(const WeightLayers& layers, std::size_t layer, std::int64_t brick,
                                              const SkinWeights::Influences& mask);
// Returns the layer after a stroke has painted its mask. Where the layer covered nothing before, it gets the weights of
// canvas().
WeightLayer mask_painted_on(const WeightLayers& layers, std::size_t layer, const SkinWeights& before,
                            const SkinWeights& after);

// Represents a layer as weights that a stroke can paint with Normalize::WhenComposed, so that the layer's other bones
// keep their weights. An extra bone, kBelow, comes before the layer's bones; its weight is the share of the weights
// below the layer. The other bones are locked, so the painted bone gains weight from kBelow alone.
constexpr int kBelow = 0;
SkinWeights shares_as_weights(const WeightLayer& layer);
Armature with_below(const Armature& armature);
SkinWeights::Influences composed_while_shared(const WeightLayers& layers, std::size_t layer, std::int64_t brick,
                                              const SkinWeights::Influences& before,
                                              const SkinWeights::Influences& after);
// Returns the layer after a stroke has painted the weights of shares_as_weights(). How much the layer covers a voxel is
// then the sum of its bones' weights there.
WeightLayer shares_painted_on(const WeightLayer& layer, const SkinWeights& before, const SkinWeights& after);

// Sets the mask to `cover` [0, 1] in the region (empty: everywhere). Where the layer covered nothing before, it gets
// the weights of canvas().
WeightLayer with_mask(const WeightLayers& layers, std::size_t layer, const TissueVoxels& tissue,
                      const TissueRegion& region, double cover);

// Returns the same layers over another base. In bricks in which a layer covers nothing, the layer shares the chunks of
// the new base.
WeightLayers over_base(const WeightLayers& layers, std::shared_ptr<const SkinWeights> base);

// Returns the layers for a rig to which bones were added, or in which bones were removed or reordered; nothing if some
// voxel would be left without a bone.
//   to     for each old bone: the new bone that takes over its weight; -1: none
//   names  names of the new bones
std::optional<WeightLayers> carried(const WeightLayers& layers, const std::vector<int>& to,
                                    const std::vector<std::string>& names);

// Merges the layer with the layer below it, or with the base. The composed weights stay the same, as far as the limit
// of four bones per voxel allows. Throws Error if one of the two layers is hidden.
WeightLayers merged_down(const WeightLayers& layers, std::size_t layer);

}  // namespace limber
