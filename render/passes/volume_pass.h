// SPDX-License-Identifier: AGPL-3.0-or-later
// Finds what each pixel shows: rays march through a visible set to its surface, and position, normal and label of what
// they meet go into buffers that later passes shade, outline and pick from; and where skin weights are shown its place
// at rest.
//
// The hull of the set is drawn first, giving each ray its start; rays of pixels beside it never run. From there a ray
// reads one texel a step, skipping as far as the texel allows; near the surface it reads filtered values, and the
// crossing is found by the secant. A ray that the clip box or plane lets into the middle of the body ends at once, on a
// cap.
//
// The rays of a posed body go from cube to cube of its map. A ray's way through a cube is nearly straight at rest: its
// ends are read through the map, and between them the ray marches at rest as it would without a pose.
#pragma once

#include <optional>

#include <glm/glm.hpp>

#include "render/gl/object.h"
#include "render/gl/program.h"
#include "render/passes/view_rays.h"
#include "render/scene/scene.h"
#include "render/textures/inverse_map_texture.h"
#include "render/textures/surface_field.h"
#include "render/textures/volume_texture.h"

namespace limber::render {

inline constexpr float kNothingDepth = 1e30f;  // of a pixel that shows nothing of the volume

// Rectangle of a picture's pixels, from the lower left corner.
struct PixelRect {
  glm::ivec2 low{0}, high{0};
  bool empty() const { return high.x <= low.x || high.y <= low.y; }
};
PixelRect intersection(const PixelRect& a, const PixelRect& b);

// What the rays of a picture met.
class GBuffer {
 public:
  //   places  also where at rest each pixel lies, and room for what is shown of weights there
  void resize(const glm::ivec2& size, bool places = false);
  const glm::ivec2& size() const { return size_; }

  gl::Texture depth;   // R32F: mm before the eye along the direction of view; kNothingDepth
  gl::Texture normal;  // RGB10_A2: unit, of the view, halved and shifted to [0, 1]; alpha 0 nothing, 1/3 surface, 2/3
                       // in a fold of a posed body, 1 cap
  gl::Texture label;   // R16UI
  gl::Texture range;   // RG32F: depth where the ray enters the hull, negated, and where it leaves it for good
  gl::Texture hull_depth;
  gl::Texture place;   // RGBA16UI: padded coordinates at rest, in the voxel that gave the label, in steps of
                       // place_step(); last 1 where there is one
  gl::Texture weight;  // RGBA8: as weight_texture.h has it
  gl::Framebuffer hull_target, march_target, weight_target;

 private:
  glm::ivec2 size_{0};
};

// Of a buffer's places: the finest that 16 bits can count through the volume by.
float place_step(const VolumeTexture& volume);

class VolumePass {
 public:
  enum class Space { Rest, Posed };
  VolumePass(int atlases, Space space);

  // The part of the picture that the hull covers.
  static PixelRect covered(const Hull& hull, const ViewRays& rays, const glm::ivec2& size);
  // That a box of padded coordinates covers.
  static PixelRect covered(const glm::vec3& low, const glm::vec3& high, const ViewRays& rays, const glm::ivec2& size);

  // The start of every ray inside `rect`.
  void draw_hull(const Hull& hull, const ViewRays& rays, const GBuffer& buffer, const PixelRect& rect);
  // What the rays of `rect` meet: labels of that layer (appearance_texture.h), which are the field's.
  //   posed, posed_hull  given exactly when this pass is for posed space
  void march(const VolumeTexture& volume, const VisibleField& field, const PosedTexture* posed,
             const PosedHull* posed_hull, const gl::Texture& looks, int layer, const Clip& clip, const ViewRays& rays,
             const GBuffer& buffer, const PixelRect& rect);

 private:
  gl::Program hull_, march_;
  gl::VertexArray nothing_;
};

}  // namespace limber::render
