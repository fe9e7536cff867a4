// SPDX-License-Identifier: AGPL-3.0-or-later
// A label volume on the graphics card: its blocks of tissue in atlases of 16-bit labels (brick_atlas.h).
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
  // Where the volume does not fit textures of that size, or the driver has no memory for it, it is halved until it
  // does. Throws Error when even an eighth of the resolution does not fit.
  VolumeTexture(const std::shared_ptr<const LabelVolume>& volume, int largest_texture);

  const std::weak_ptr<const LabelVolume>& original() const {
    return original_;
  }  // not kept alive: the document owns it
  std::shared_ptr<const LabelVolume> drawn() const { return coarse_ ? coarse_ : original_.lock(); }
  const Grid& grid() const { return grid_; }  // of what is drawn: the original, or a coarser one
  int halvings() const { return halvings_; }
  const BlockLayout& layout() const { return layout_; }
  int largest_texture() const { return largest_texture_; }
  const std::vector<float>& exposure() const {
    return exposure_;
  }                                                  // by label: the share of its rows' voxels that touch air
  const std::string& note() const { return note_; }  // what the user should know, or empty

  const gl::Texture& index() const {
    return index_;
  }  // 3D, RGBA8UI, a texel a block: place of its slot, atlas from 1, 0: no tissue
  // Samplers u_labels0 .. of the program in use, on units from `first`; returns the next free unit.
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

// A 3D texture without mipmaps that is not repeated. False when the driver has no room for it.
//   format  a sized internal format with one or four channels, with the matching pixel format and type
struct Format3D {
  int internal;
  unsigned pixels, type;
  bool linear;
};
bool allocate(const gl::Texture& texture, const glm::ivec3& size, const Format3D& format, const void* texels = nullptr);

// An index as in VolumeTexture::index, of the slots marked as present.
bool upload_index(const gl::Texture& texture, const BlockLayout& layout, const std::vector<std::uint8_t>& present);

// u_NAME0 .. for each of the textures; returns the next free unit.
int bind_atlases(gl::Program& program, const std::string& name, const std::vector<gl::Texture>& atlases, int first);

// The definitions that shaders/atlases.glsl and shaders/weights.glsl need.
std::string atlas_defines(int atlases);

}  // namespace limber::render
