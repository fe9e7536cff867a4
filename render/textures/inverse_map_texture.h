// SPDX-License-Identifier: AGPL-3.0-or-later
// The inverse map of a posed body for its live preview (core/deform/preview_map.h) on the graphics card. A posed body
// is drawn in posed space: rays, slices and shading convert a posed position to a rest position by the map, and then
// read the volume's own textures there. A new pose therefore uploads only the map, and only those of its slices that
// have changed.
#pragma once

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "core/deform/preview_map.h"
#include "render/gl/object.h"
#include "render/gl/program.h"
#include "render/textures/brick_hull.h"
#include "render/textures/visible_field.h"
#include "render/textures/volume_texture.h"

namespace limber::render {

class PosedTexture {
 public:
  PosedTexture();

  // Uploads the slices (z layers) that changed. Throws Error when the driver has no memory for the map.
  void upload(const std::shared_ptr<const PreviewMap>& map, int largest_texture);
  const std::shared_ptr<const PreviewMap>& map() const { return map_; }

  // Sets the uniforms that shaders/posed.glsl declares, and binds the textures to the texture units from `first` on.
  // Returns the next free unit.
  int bind(const VolumeTexture& volume, gl::Program& program, int first) const;

 private:
  std::shared_ptr<const PreviewMap> map_;
  gl::Texture nodes_, apart_, cubes_;
  glm::ivec3 size_{0}, room_{0};  // texels per axis: those in use, and those allocated
};

// The region of posed space where rays can hit the labels of a field: the cubes of a map whose rest positions are near
// these labels, and the hull around these cubes.
class PosedHull {
 public:
  PosedHull() : cubes_(gl::Texture::create()) {}

  // Computes the cubes and the hull again if the map or the field has changed. Throws Error when the driver has no
  // memory for them.
  void update(const std::shared_ptr<const PreviewMap>& map, const VolumeTexture& volume, const VisibleField& field);
  const Hull& hull() const { return hull_; }
  // Returns the states of the map's cubes (PreviewMap::cubes) as a texture. Cubes far from the field's labels have the
  // state kNothing.
  const gl::Texture& cubes() const { return cubes_; }

 private:
  Hull hull_;
  Hull::Faces faces_;
  gl::Texture cubes_;
  std::array<std::vector<std::uint8_t>, 2> holds_;  // states of cubes_: those uploaded, and those of the next upload
  glm::ivec3 room_{0}, holds_size_{0};
  std::shared_ptr<const PreviewMap> map_;
  int revision_ = 0;  // revision of the field for which the hull was computed
};

}  // namespace limber::render
