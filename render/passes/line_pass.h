// SPDX-License-Identifier: AGPL-3.0-or-later
// Draws antialiased straight lines of constant width in pixels over a picture. They show a tet mesh where a clip plane,
// the clip box or a slice cuts it: each line is the intersection of a face of a tet with the plane.
#pragma once

#include <vector>

#include "core/mesh/mesh_cut.h"
#include "render/gl/object.h"
#include "render/gl/program.h"
#include "render/scene/camera.h"
#include "render/scene/scene.h"
#include "render/scene/slice_camera.h"

namespace limber::render {

// Returns the lines along which the clip plane and the faces of the clip box cut the mesh. Where one of these planes
// cuts away the lines of another plane, the lines are left out.
//   grid  grid of the volume; the clip box is given in its voxel coordinates
std::vector<Segment> lines_on_cuts(const CutMesh& mesh, const Clip& clip, const Grid& grid);

class LinePass {
 public:
  LinePass();

  struct Ink {
    glm::vec3 colour;    // colour of the lines, sRGB
    float alpha, width;  // opacity [0, 1], and line width in pixels
  };
  // Draws the lines into the bound framebuffer of `size` pixels. A pixel of a line is drawn only where its depth
  // differs from the depth of the body's surface by at most `off` mm.
  //   body_depth  depth of the body in mm from the eye along the viewing direction, at any resolution
  void draw(const std::vector<Segment>& lines, const Camera& camera, const glm::ivec2& size,
            const gl::Texture& body_depth, float off, const Ink& ink);
  // Draws all lines; they must lie in the plane of the slice.
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
