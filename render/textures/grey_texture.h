// SPDX-License-Identifier: AGPL-3.0-or-later
// A grey image on the graphics card: its 16-bit levels, and the range of levels in each block of 8^3 voxels. By these
// ranges, rays skip blocks that are not visible. Large images are uploaded over several frames.
#pragma once

#include <memory>

#include "core/volume/grey_levels.h"
#include "render/gl/object.h"
#include "render/gl/program.h"
#include "render/textures/upload_time.h"
#include "render/textures/volume_texture.h"

namespace limber::render {

class GreyTexture {
 public:
  // Allocates the textures. If the image does not fit in a texture with largest_texture texels per axis, or the driver
  // has no memory for it, its resolution is halved until it fits. Throws Error when even an eighth does not fit.
  GreyTexture(const std::shared_ptr<const GreyLevels>& image, int largest_texture);

  // Returns the original image. The document owns this image, and GreyTexture does not keep it alive.
  const std::weak_ptr<const GreyLevels>& original() const { return original_; }
  const Grid& grid() const { return grid_; }  // grid of the drawn image: the original, or a coarser one
  int halvings() const { return halvings_; }

  // Uploads slices until the time limit is reached. If `time` is null, uploads all missing slices.
  void upload(UploadTime* time);
  bool complete() const { return next_slice_ == grid_.size.z; }
  int uploaded() const { return next_slice_; }  // number of slices (z layers) uploaded so far

  // Sets the uniforms that shaders/grey.glsl declares, and binds the textures to the texture units from `first` on.
  // Returns the next free unit.
  int bind(const VolumeTexture& volume, gl::Program& program, int first) const;
  // Converts a value of the image to a level as the shaders read it. The levels of the image's own values lie in [0,
  // 1].
  double level_of(double value) const { return (value - least_) / range_; }
  // Returns the corners of the box around all voxels of the image, in the padded coordinates of a volume.
  std::array<glm::dvec3, 2> padded_box(const VolumeTexture& volume) const;

 private:
  std::weak_ptr<const GreyLevels> original_;
  std::shared_ptr<const GreyLevels> coarse_;
  Grid grid_;
  gl::Texture levels_, ranges_;
  double least_ = 0, range_ = 1;
  int halvings_ = 0, next_slice_ = 0;
};

}  // namespace limber::render
