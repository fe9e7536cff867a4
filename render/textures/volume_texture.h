// SPDX-License-Identifier: AGPL-3.0-or-later
// A label volume on the graphics card: the blocks that have tissue, in atlases of 16-bit labels (brick_atlas.h).
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/volume/distance_transform.h"
#include "core/volume/label_volume.h"
#include "render/gl/object.h"
#include "render/gl/program.h"
#include "render/textures/brick_atlas.h"
#include "render/textures/texture_limits.h"
#include "render/textures/upload_time.h"

namespace limber::render {

// A label volume at the resolution at which it is drawn, before it is uploaded. Computing it needs no OpenGL.
struct DrawnVolume {
  // The original volume. The document owns this volume, and DrawnVolume does not keep it alive.
  std::weak_ptr<const LabelVolume> original;
  std::shared_ptr<LabelVolume> coarse;  // the volume at the resolution at which it is drawn; null: the original
  Grid grid;                            // grid of the volume that is drawn
  BlockLayout layout;
  int halvings = 0;  // number of times that the resolution was halved
  int largest_texture = 0;
  std::vector<float> exposure;  // for each label, the fraction of its voxels that have air beside them along x

  std::shared_ptr<const LabelVolume> drawn() const { return coarse ? coarse : original.lock(); }
};

// Arranges the volume in textures. If the textures exceed the limits, halves the resolution until they fit. Throws
// Error if even at an eighth of the resolution the textures have too many texels per axis.
//   least_halvings  smallest number of times that the resolution is halved
DrawnVolume drawn_volume(const std::shared_ptr<const LabelVolume>& volume, const TextureLimits& limits,
                         int least_halvings = 0);

class VolumeTexture {
 public:
  // Uploads the volume. Halves its resolution until it fits (drawn_volume()) and the driver has memory for it. Throws
  // Error if even an eighth of the resolution does not fit.
  VolumeTexture(const std::shared_ptr<const LabelVolume>& volume, const TextureLimits& limits);
  // Only allocates the textures: the caller then calls upload() until complete(). Does not halve the resolution: throws
  // Error when the driver has no memory for the volume as it is.
  explicit VolumeTexture(DrawnVolume volume);

  // Uploads the volume: as much as `time` allows, or all if `time` is null.
  void upload(UploadTime* time);
  bool complete() const { return next_slot_ < 0; }

  // Replaces the volume by `now`, which has the same grid and differs only within a box (size 0: nowhere). Uploads the
  // slots in or near the box. If the volume is drawn at a coarser resolution, computes the coarse labels in the box
  // again. Returns false if this is impossible: the volume is not uploaded yet, or new tissue needs more slots than
  // the atlases have.
  //   changed  receives 1 for each slot in or near the box, else 0; one byte per slot
  bool relabel(const std::shared_ptr<const LabelVolume>& now, const VoxelBox& box, std::vector<std::uint8_t>& changed);

  const std::weak_ptr<const LabelVolume>& original() const { return volume_.original; }
  std::shared_ptr<const LabelVolume> drawn() const { return volume_.drawn(); }
  const Grid& grid() const { return volume_.grid; }  // grid of the drawn volume: the original, or a coarser one
  int halvings() const { return volume_.halvings; }
  const BlockLayout& layout() const { return volume_.layout; }
  int largest_texture() const { return volume_.largest_texture; }
  // Returns, for each label, the fraction of its voxels that have air beside them along x.
  const std::vector<float>& exposure() const { return volume_.exposure; }
  const std::string& note() const { return note_; }  // a note for the user, or empty

  // Returns the index texture: 3D, RGBA8UI, one texel per block. A texel has the position of the block's slot, then the
  // atlas, counted from 1 (0: no tissue).
  const gl::Texture& index() const { return index_; }
  // Sets the samplers u_labels0 .. of the program in use, on the texture units from `first` on. Returns the next free
  // unit.
  int bind(gl::Program& program, int first) const;

 private:
  bool allocate_atlases();
  void upload_slot(int slot, const LabelVolume& labels, std::vector<Label>& texels) const;

  DrawnVolume volume_;
  std::vector<gl::Texture> atlases_;
  gl::Texture index_;
  std::string note_;
  int next_slot_ = 0;  // index of the next slot (stored block) to upload; -1: everything was uploaded
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
