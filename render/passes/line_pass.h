// SPDX-License-Identifier: AGPL-3.0-or-later
// Straight lines of one even width in pixels, with smooth rims, over a picture: the tets of a mesh where a cut shows
// them.
#pragma once

#include <vector>

#include "core/mesh/mesh_cut.h"
#include "render/gl/object.h"
#include "render/gl/program.h"
#include "render/scene/camera.h"
#include "render/scene/scene.h"
#include "render/scene/slice_camera.h"

namespace limber::render {

// The lines by which each of the clip's faces cuts the mesh, as far as the others leave them.
//   grid  of the volume that the clip's box is of
std::vector<Segment> lines_on_cuts(const CutMesh& mesh, const Clip& clip, const Grid& grid);

class LinePass {
 public:
  LinePass();

  struct Ink {
    glm::vec3 colour;    // sRGB
    float alpha, width;  // pixels
  };
  // Into the framebuffer that is bound, of `size` pixels: only where the body's surface is no further from a line than
  // `off`.
  //   body_depth  mm before the eye along the direction of view, of any resolution
  void draw(const std::vector<Segment>& lines, const Camera& camera, const glm::ivec2& size,
            const gl::Texture& body_depth, float off, const Ink& ink);
  // All of them, in the plane of a slice.
  void draw(const std::vector<Segment>& lines, const SliceCamera& camera, const glm::ivec2& size, const Ink& ink);

 private:
  struct View {
    glm::dmat4 clip_from_world;
    glm::dvec3 eye, ahead;
  };
  void draw(const std::vector<Segment>& lines, const View& view, const glm::ivec2& size, const gl::Texture* body_depth,
            float off, const Ink& ink);

  gl::Program program_;
  gl::VertexArray array_;
  gl::Buffer ends_;
};

}  // namespace limber::render
