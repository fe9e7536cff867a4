// SPDX-License-Identifier: AGPL-3.0-or-later
// What the views of one context share: programs, and the textures of the volumes and looks that are in use. A volume
// that nobody holds any more loses its textures at the next picture.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "render/passes/armature_pass.h"
#include "render/passes/compose_pass.h"
#include "render/passes/line_pass.h"
#include "render/passes/shade_pass.h"
#include "render/passes/slice_pass.h"
#include "render/passes/volume_pass.h"
#include "render/passes/weight_pass.h"
#include "render/scene/scene.h"
#include "render/textures/appearance_texture.h"
#include "render/textures/inverse_map_texture.h"
#include "render/textures/surface_field.h"
#include "render/textures/volume_texture.h"
#include "render/textures/weight_texture.h"

namespace limber::render {

struct PassResources {
  //   largest  texels per axis of a 3D texture; 0: what the driver allows
  explicit PassResources(int largest);

  // A volume on the card, with the layers that rays look for.
  struct Body {
    std::weak_ptr<const LabelVolume> key;
    std::unique_ptr<VolumeTexture> volume;
    std::vector<std::unique_ptr<VisibleField>> layers;
    std::unique_ptr<PosedTexture> pose;  // the last one drawn, with the hull of each layer in it
    std::vector<std::unique_ptr<PosedHull>> posed_hulls;
    std::unique_ptr<WeightTexture> weights;  // what was shown of them last
  };
  Body& body(const std::shared_ptr<const LabelVolume>& volume);
  const LooksTexture& looks(const Body& body, const std::shared_ptr<const LabelLooks>& looks, Display display);
  // The field of that layer, computed where it is not yet or no longer right.
  const VisibleField& layer(Body& body, const LooksTexture& looks, size_t layer);
  // The map on the card; null without one.
  const PosedTexture* pose(Body& body, const std::shared_ptr<const PreviewMap>& map);
  // What is shown of weights on the card, all of it or what there was time for; null for nothing.
  enum class Extent { Whole, InTime };
  WeightTexture* weights(Body& body, const std::optional<ShownWeights>& shown, Extent extent);
  // Where rays that look for a layer start in posed space; null without a map.
  const PosedHull* posed_hull(Body& body, size_t layer, const std::shared_ptr<const PreviewMap>& map);
  VolumePass& volume_pass(const VolumeTexture& volume, VolumePass::Space space);

  int largest_texture;
  int pictures_at_rest = 6;  // that are averaged
  ShadePass shade;
  ComposePass compose;
  ArmaturePass armature;
  SlicePass slice;
  WeightPass weigh;
  LinePass lines;
  std::string note;
  std::optional<UploadTime> upload_time;  // of this frame; nothing: there are no frames

 private:
  struct Looks {
    std::weak_ptr<const LabelLooks> key;
    std::weak_ptr<const LabelVolume> volume;
    Display display;
    std::unique_ptr<LooksTexture> texture;
  };
  std::vector<std::unique_ptr<Body>> bodies_;
  std::vector<Looks> looks_;
  std::map<std::pair<int, VolumePass::Space>, std::unique_ptr<VolumePass>> volume_passes_;  // by number of atlases
};

}  // namespace limber::render
