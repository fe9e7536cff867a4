// SPDX-License-Identifier: AGPL-3.0-or-later
// A live preview's inverse map (core/deform/preview_map.h) on the card. A posed body is drawn in posed space: rays,
// slices and shading read the map at a posed place and then the volume's own textures at the rest point it tells, so a
// pose uploads the map alone, and of that the layers that have changed.
#pragma once

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "core/deform/preview_map.h"
#include "render/gl/object.h"
#include "render/gl/program.h"
#include "render/textures/brick_hull.h"
#include "render/textures/surface_field.h"
#include "render/textures/volume_texture.h"

namespace limber::render {

class PosedTexture {
 public:
  PosedTexture();

  // Throws Error when the driver has no room for it.
  void upload(const std::shared_ptr<const PreviewMap>& map, int largest_texture);
  const std::shared_ptr<const PreviewMap>& map() const { return map_; }

  // The uniforms of shaders/posed.glsl; returns the next free unit.
  int bind(const VolumeTexture& volume, gl::Program& program, int first) const;

 private:
  std::shared_ptr<const PreviewMap> map_;
  gl::Texture nodes_, apart_, cubes_;
  glm::ivec3 size_{0}, room_{0};  // texels in use, and there
};

// Where rays in posed space can meet a field's set: the cubes of a map that lead near it, and the hull around them.
class PosedHull {
 public:
  PosedHull() : cubes_(gl::Texture::create()) {}

  // As needed. Throws Error when the driver has no room for it.
  void update(const std::shared_ptr<const PreviewMap>& map, const VolumeTexture& volume, const VisibleField& field);
  const Hull& hull() const { return hull_; }
  const gl::Texture& cubes() const { return cubes_; }  // as PreviewMap::cubes, kNothing where the set is far

 private:
  Hull hull_;
  Hull::Faces faces_;
  gl::Texture cubes_;
  std::array<std::vector<std::uint8_t>, 2> holds_;  // what cubes_ shows; what it is to show
  glm::ivec3 room_{0}, holds_size_{0};
  std::shared_ptr<const PreviewMap> map_;
  int revision_ = 0;  // of the field
};

}  // namespace limber::render
