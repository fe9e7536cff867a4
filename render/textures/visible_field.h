// SPDX-License-Identifier: AGPL-3.0-or-later
// Stores a set of labels as a smooth body (surface_field.h) in textures on the graphics card.
#pragma once

#include <cstdint>
#include <vector>

#include "render/gl/object.h"
#include "render/gl/program.h"
#include "render/textures/brick_hull.h"
#include "render/textures/surface_field.h"
#include "render/textures/upload_time.h"
#include "render/textures/volume_texture.h"

namespace limber::render {

// A field with all data that will be uploaded for it. Computing it needs no OpenGL.
struct PreparedField {
  SurfaceField field;
  SurfaceField::Texels texels;
  Hull::Faces faces;
  std::vector<std::uint8_t> occupancy;
};
PreparedField prepared_field(const LabelVolume& drawn, const BlockLayout& layout, const LabelSet& set);

class VisibleField {
 public:
  // Computes the field and uploads it. Throws Error when the driver has no memory for it.
  VisibleField(const VolumeTexture& volume, const LabelSet& set);
  // Allocates the textures of a field that was prepared for the volume, but uploads nothing: the caller calls upload()
  // until complete(). Throws Error when the driver has no memory for the textures.
  VisibleField(const VolumeTexture& volume, PreparedField&& prepared);

  // Uploads the field: as much as `time` allows, or all if `time` is null.
  void upload(const VolumeTexture& volume, UploadTime* time);
  bool complete() const { return next_slot_ < 0; }

  // Changes the set of labels. Computes and uploads only blocks that contain, or are near, an added or removed label,
  // or whose voxels have changed (`changed`, see SurfaceField::update()).
  void update(const VolumeTexture& volume, const LabelSet& set, const std::vector<std::uint8_t>& changed = {});
  const LabelSet& set() const { return field_.set(); }
  // Returns a 3D texture with one texel per brick: the fraction of the brick that belongs to the set, blurred.
  const gl::Texture& occupancy() const { return occupancy_texture_; }

  const Hull& hull() const { return hull_; }
  // Returns false if no ray can hit the body in this box of padded coordinates.
  bool may_be_met(const glm::vec3& low, const glm::vec3& high) const { return field_.may_be_met(low, high); }
  int revision() const { return revision_; }  // increases with every update

  // Sets the samplers u_field0 .. and u_index, on the texture units from `first` on, and the uniform u_texel. Returns
  // the next free unit.
  int bind(const VolumeTexture& volume, gl::Program& program, int first) const;

  std::int64_t blocks_computed() const { return blocks_computed_; }  // number of blocks that the last update computed

 private:
  SurfaceField field_;
  SurfaceField::Texels texels_;  // texels that upload() has not uploaded yet
  Hull::Faces faces_;
  std::vector<std::uint8_t> occupancy_;
  std::int64_t next_slot_ = 0;  // index of the next slot (stored block) to upload; -1: everything was uploaded
  std::vector<gl::Texture> atlases_;
  gl::Texture index_, occupancy_texture_;
  Hull hull_;
  int revision_ = 0;
  std::int64_t blocks_computed_ = 0;
};

}  // namespace limber::render
