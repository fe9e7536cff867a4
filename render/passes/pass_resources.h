// SPDX-License-Identifier: AGPL-3.0-or-later
// The resources that the views of one OpenGL context share: shader programs, and the textures of the volumes and label
// appearances in use. When a volume is destroyed, its textures are freed as soon as another volume is uploaded.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "render/passes/armature_pass.h"
#include "render/passes/compose_pass.h"
#include "render/passes/image_pass.h"
#include "render/passes/light_pass.h"
#include "render/passes/line_pass.h"
#include "render/passes/shade_pass.h"
#include "render/passes/slice_pass.h"
#include "render/passes/volume_pass.h"
#include "render/passes/weight_pass.h"
#include "render/scene/scene.h"
#include "render/textures/appearance_texture.h"
#include "render/textures/grey_texture.h"
#include "render/textures/inverse_map_texture.h"
#include "render/textures/visible_field.h"
#include "render/textures/volume_texture.h"
#include "render/textures/weight_texture.h"

namespace limber::render {

// A label volume and the fields of its layers, ready for upload (prepared_body()), and what Renderer::upload() does
// with them next.
struct PreparedBody {
  std::shared_ptr<const LabelVolume> original;
  DrawnVolume volume;
  std::vector<PreparedField> layers;
  std::shared_ptr<const LabelLooks> looks;  // looks and display with which the body will be drawn
  Display display = Display::Solid;
  std::optional<ShownGrey> grey;  // the grey image that will be shown with the body; empty: none
  enum class Step { Body, Image, Programs, TrialPicture, Done } step = Step::Body;
};

struct PassResources {
  // Compiles the shader programs. Textures are made when a volume is drawn.
  //   largest  largest number of texels per axis of a 3D texture; 0: as many as the driver allows
  explicit PassResources(int largest);

  // A label volume on the graphics card. Each layer (set of visible labels) has a smooth field, whose surface the rays
  // search for.
  struct Body {
    std::weak_ptr<const LabelVolume> key;
    std::unique_ptr<VolumeTexture> volume;
    std::vector<std::unique_ptr<VisibleField>> layers;
    std::unique_ptr<PosedTexture> pose;  // inverse map of the posed body that was drawn last
    std::vector<std::unique_ptr<PosedHull>> posed_hulls;
    std::unique_ptr<WeightTexture> weights;  // the weights that were shown last
    // For each layer, one byte per slot (a stored block of 32^3 voxels): nonzero if labels in the slot have changed
    // since the layer's field was computed (SurfaceField::update()).
    std::vector<std::vector<std::uint8_t>> changed;
    bool surface_waits = false;  // true: labels have changed, but the fields are not updated yet
    int revision = 0;            // changes whenever labels change or are uploaded again
  };
  Body& body(const std::shared_ptr<const LabelVolume>& volume);
  bool has(const std::shared_ptr<const LabelVolume>& volume) const;  // true if body() need not upload anything
  // Makes the textures of `before` show the volume `now`, by uploading only what lies in or near the box in which the
  // volumes differ (size 0: nowhere). `before` and `now` may be the same volume, whose voxels were changed in place.
  // Does nothing if `before` has no textures. If the change does not fit into the textures, deletes them, and body()
  // uploads `now` as a whole.
  //   surface  AtOnce: labels and 3D surfaces change now. Waits: only the labels change now, and the surfaces change at
  //            the next call with AtOnce, because they take much longer to compute.
  enum class Surface { AtOnce, Waits };
  void relabel(const std::shared_ptr<const LabelVolume>& before, const std::shared_ptr<const LabelVolume>& now,
               const VoxelBox& box, Surface surface);
  // Returns a number that changes whenever the volume's labels change on the graphics card; 0 for a volume without
  // textures.
  int revision_of(const std::shared_ptr<const LabelVolume>& volume) const;
  int uploads() const { return uploads_; }                   // number of volumes uploaded so far
  std::size_t body_count() const { return bodies_.size(); }  // number of volumes on the graphics card
  // Uploads as much of a prepared body as the frame's time limit allows. Returns true once the whole body is uploaded.
  // Until then, later calls must pass the same body. Throws Error when the driver has no memory for it.
  bool upload(PreparedBody& prepared);
  const LooksTexture& looks(const Body& body, const std::shared_ptr<const LabelLooks>& looks, Display display);
  // Returns the field of a layer, and first computes it if it is missing or out of date.
  const VisibleField& layer(Body& body, const LooksTexture& looks, size_t layer);
  // Returns the texture of the inverse map `map` of the posed body, and uploads the map first if needed. Returns null
  // if `map` is null.
  const PosedTexture* pose(Body& body, const std::shared_ptr<const PreviewMap>& map);
  // Returns the texture of the shown weights, and uploads the weights first: all of them (Whole), or as many as the
  // frame's time limit allows (InTime). Returns null if no weights are shown.
  enum class Extent { Whole, InTime };
  WeightTexture* weights(Body& body, const std::optional<ShownWeights>& shown, Extent extent);
  // Returns the hull of a layer of the posed body, at which rays start. Returns null if `map` is null.
  const PosedHull* posed_hull(Body& body, size_t layer, const std::shared_ptr<const PreviewMap>& map);
  // Returns the texture of the shown grey image, and uploads the image first, whole or as much as the frame's time
  // limit allows. Returns null if no image is shown.
  GreyTexture* grey(const std::optional<ShownGrey>& shown, Extent extent);
  VolumePass& volume_pass(const VolumeTexture& volume, VolumePass::Space space);

  TextureLimits limits;
  int pictures_at_rest = 6;  // number of pictures that are averaged while nothing in the 3D view moves
  bool fine_light = false;  // true: after these pictures, the same number of pictures with ray-traced light is averaged
  ShadePass shade;
  LightPass light;
  ComposePass compose;
  ArmaturePass armature;
  SlicePass slice;
  ImagePass image;
  WeightPass weigh;
  LinePass lines;
  std::string note;                       // message for the user about the body that body() returned last
  std::optional<UploadTime> upload_time;  // time limit of all uploads in this frame; empty: no limit

 private:
  void forget_expired();  // frees the textures of volumes that are gone
  // Uploads a part of a body. Returns true when all of it was uploaded.
  bool upload_part(Body& body, PreparedBody& prepared);

  struct Looks {
    std::weak_ptr<const LabelLooks> key;
    std::weak_ptr<const LabelVolume> volume;
    Display display;
    std::unique_ptr<LooksTexture> texture;
  };
  std::vector<std::unique_ptr<Body>> bodies_;
  int revisions_ = 0;  // the last number given to Body::revision
  int uploads_ = 0;
  std::unique_ptr<Body> arriving_;  // the prepared body that is being uploaded
  std::vector<Looks> looks_;
  // The grey images that were shown last, at most two: those of two compared results.
  std::vector<std::unique_ptr<GreyTexture>> greys_;
  // One pass for each number of atlas textures and each space (at rest or posed) in which rays march.
  std::map<std::pair<int, VolumePass::Space>, std::unique_ptr<VolumePass>> volume_passes_;
};

}  // namespace limber::render
