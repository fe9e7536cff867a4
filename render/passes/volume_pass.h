// SPDX-License-Identifier: AGPL-3.0-or-later
// Finds what each pixel shows. A ray marches through the volume until it reaches the surface of the visible labels. The
// position, normal and label of the hit, and its rest position where skin weights are shown, are stored in buffers,
// which later passes use for shading, outlines and picking.
//
// The hull of the visible labels is drawn first and gives each ray its start; pixels outside the hull cost nothing.
// A ray reads one texel per step and skips as far as the texel allows. Near the surface it reads filtered
// values, and finds the crossing by the secant method. If the clip box or plane makes a ray start inside the body, the
// ray ends at once, on a cap (the cut face).
//
// The rays of a posed body go from cube to cube of its inverse map (PreviewMap). The part of a ray within a cube is
// nearly straight at rest: its ends are converted to rest positions by the map, and between them the ray marches
// through the rest volume as it would without a pose.
#pragma once

#include <optional>
#include <string>

#include <glm/glm.hpp>

#include "render/gl/object.h"
#include "render/gl/program.h"
#include "render/passes/view_rays.h"
#include "render/scene/scene.h"
#include "render/textures/inverse_map_texture.h"
#include "render/textures/visible_field.h"
#include "render/textures/volume_texture.h"

namespace limber::render {

inline constexpr float kNothingDepth = 1e30f;  // depth of a pixel where the ray misses the body

// A rectangle of pixels [low, high); pixels are counted from the lower left corner.
struct PixelRect {
  glm::ivec2 low{0}, high{0};
  bool empty() const { return high.x <= low.x || high.y <= low.y; }
};
PixelRect intersection(const PixelRect& a, const PixelRect& b);

// The buffers that store what the rays of a picture hit.
class GBuffer {
 public:
  // Gives the buffers the size of the picture, pixels.
  //   places  true: adds the buffers for the rest position and the weight colour of each pixel
  void resize(const glm::ivec2& size, bool places = false);
  const glm::ivec2& size() const { return size_; }
  void forget_hits();  // marks every pixel as "no hit" until the next march

  gl::Texture depth;  // R32F: mm from the eye along the viewing direction; kNothingDepth: no hit
  // RGB10_A2: unit normal in view axes, mapped to [0, 1]. Alpha is 0 for no hit, 1/3 for a surface, 2/3 for a surface
  // in a fold (where two parts of a posed body touch), and 1 for a cap (cut face).
  gl::Texture normal;
  gl::Texture label;  // R16UI: label of the hit
  // RG32F: the depth where the ray first enters the hull, negated, and the depth where it leaves the hull for the last
  // time.
  gl::Texture range;
  gl::Texture hull_depth;
  // RGBA16UI: rest position of the hit in padded coordinates, in steps of place_step(). The last channel is 1 at a hit.
  gl::Texture place;
  gl::Texture weight;  // RGBA8: colour of the weights at the hit (weight_colour() in shaders/weights.glsl)
  gl::Framebuffer hull_target, march_target, weight_target;

 private:
  glm::ivec2 size_{0};
};

// Returns the step, in voxels of the drawn volume, between the positions that GBuffer::place can store. It is the
// finest step with which 16 bits cover the volume.
float place_step(const VolumeTexture& volume);

class VolumePass {
 public:
  enum class Space { Rest, Posed };
  VolumePass(int atlases, Space space);

  // These functions return the rectangle of the picture that a hull covers, or that a box in padded coordinates covers.
  static PixelRect covered(const Hull& hull, const ViewRays& rays, const glm::ivec2& size);
  static PixelRect covered(const glm::vec3& low, const glm::vec3& high, const ViewRays& rays, const glm::ivec2& size);

  // Draws the hull into the buffer, and so stores where every ray inside `rect` starts and ends.
  void draw_hull(const Hull& hull, const ViewRays& rays, const GBuffer& buffer, const PixelRect& rect);
  // Follows the rays inside `rect` until they hit a label of one layer, which is a set of labels with a common surface
  // (appearance_texture.h).
  //   field              the field of the layer
  //   posed, posed_hull  inverse map and hull of the posed body; null if the body is at rest
  void march(const VolumeTexture& volume, const VisibleField& field, const PosedTexture* posed,
             const PosedHull* posed_hull, const gl::Texture& looks, int layer, const Clip& clip, const ViewRays& rays,
             const GBuffer& buffer, const PixelRect& rect);

 private:
  gl::Program hull_, march_;
  gl::VertexArray nothing_;
};

// march_defines() returns the preprocessor definitions that shaders/trace.glsl needs. set_clip() sets the uniforms of
// the box and the clip that it needs.
std::string march_defines(int atlases, VolumePass::Space space);
void set_clip(gl::Program& program, const Hull& hull, const VolumeTexture& volume, const Clip& clip,
              const ViewRays& rays);

}  // namespace limber::render
