// SPDX-License-Identifier: AGPL-3.0-or-later
// A label volume on the graphics card: the blocks that have tissue, in atlases of 16-bit labels (brick_atlas.h).
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/volume/label_volume.h"
#include "render/gl/object.h"
#include "render/gl/program.h"
#include "render/textures/brick_atlas.h"

namespace limber::render {

class VolumeTexture {
 public:
  // Uploads the volume. If the volume does not fit in textures with largest_texture texels per axis, or the driver has
  // no memory for it, its resolution is halved until it fits. Throws Error when even an eighth of the resolution does
  // not fit.
  VolumeTexture(const std::shared_ptr<const LabelVolume>& volume, int largest_texture);

  // The document owns the original volume; this object does not keep it alive.
  const std::weak_ptr<const LabelVolume>& original() const { return original_; }
  std::shared_ptr<const LabelVolume> drawn() const { return coarse_ ? coarse_ : original_.lock(); }
  const Grid& grid() const { return grid_; }  // grid of the drawn volume: the original, or a coarser one
  int halvings() const { return halvings_; }
  const BlockLayout& layout() const { return layout_; }
  int largest_texture() const { return largest_texture_; }
  // For each label: the share of its voxels that have air beside them along x.
  const std::vector<float>& exposure() const { return exposure_; }
  const std::string& note() const { return note_; }  // a note for the user, or empty

  // Returns the index texture: 3D, RGBA8UI, one texel per block. A texel has the position of the block's slot, then the
  // atlas, counted from 1 (0: no tissue).
  const gl::Texture& index() const { return index_; }
  // Sets the samplers u_labels0 .. of the program in use, on the texture units from `first` on. Returns the next free
  // unit.
  int bind(gl::Program& program, int first) const;

 private:
  bool upload(const LabelVolume& volume);

  std::weak_ptr<const LabelVolume> original_;
  std::shared_ptr<const LabelVolume> coarse_;
  Grid grid_;
  BlockLayout layout_;
  std::vector<gl::Texture> atlases_;
  gl::Texture index_;
  std::vector<float> exposure_;
  std::string note_;
  int halvings_ = 0, largest_texture_ = 0;
};

// The format of a 3D texture: a sized internal format of one or four channels, the matching pixel format and type, and
// whether reads are filtered.
struct Format3D {
  int internal;
  unsigned pixels, type;
  bool linear;
};
// Allocates a 3D texture without mipmaps, clamped at its edges. Returns false when the driver has no memory for it.
bool allocate(const gl::Texture& texture, const glm::ivec3& size, const Format3D& format, const void* texels = nullptr);

// Uploads an index texture in the format of VolumeTexture::index. It lists only the slots that `present` marks. Returns
// false when the driver has no memory for it.
bool upload_index(const gl::Texture& texture, const BlockLayout& layout, const std::vector<std::uint8_t>& present);

// Sets the samplers NAME0, NAME1 .. to the textures, on the texture units from `first` on. Returns the next free unit.
int bind_atlases(gl::Program& program, const std::string& name, const std::vector<gl::Texture>& atlases, int first);

// Returns the preprocessor definitions that shaders/atlases.glsl and shaders/weights.glsl need.
std::string atlas_defines(int atlases);

}  // namespace limber::render
