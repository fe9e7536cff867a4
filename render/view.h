// SPDX-License-Identifier: AGPL-3.0-or-later
// One picture of a scene: 3D or a slice, drawn into a texture of its own that the editor shows and the command line
// saves. Everything here needs a current OpenGL 3.3 core context. Volumes are uploaded once and shared by all views.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <glm/glm.hpp>

#include "core/volume/label_volume.h"
#include "render/image_io.h"
#include "render/scene/camera.h"
#include "render/scene/scene.h"
#include "render/scene/slice_camera.h"

namespace limber::render {

struct PassResources;

// Textures of the volumes in use, programs, meshes: one for a context.
class Renderer {
 public:
  // Throws Error when the context is older than OpenGL 3.3.
  //   largest_texture  texels per axis of a 3D texture; 0: what the driver allows. Larger volumes are bricked
  explicit Renderer(int largest_texture = 0);
  ~Renderer();
  Renderer(const Renderer&) = delete;
  Renderer& operator=(const Renderer&) = delete;

  // What the user should know of the last upload ("shown at half resolution: ..."), or empty.
  const std::string& note() const;

  // Until it is called again, views that are drawn call by call bring large changes of weights to the card in about so
  // long altogether, and are not complete while some wait. Without frames each draw brings all.
  void begin_frame(double upload_seconds);

  // How many pictures are averaged at rest; six unless it is called. Fewer are sooner complete, and less smooth. With 0
  // a picture at rest stays one of every third pixel: for tests of all that is not a picture.
  void average_at_rest(int pictures);

  // Waits until everything drawn so far is done, for whoever measures.
  void finish();

  PassResources& resources() { return *resources_; }

 private:
  std::unique_ptr<PassResources> resources_;
};

// What lies under a pixel.
struct Hit {
  Label label = 0;
  glm::ivec3 voxel{0};   // of the volume, at rest where the body is posed
  glm::dvec3 point{0};   // world, mm
  glm::dvec3 normal{0};  // world, unit; zero on a cut face or slice
};

// A 3D picture, refined over calls: coarse while something moves, full at rest.
class View3D {
 public:
  // Each pixel of a moving picture shows the ray of a pixel at most two away.
  static constexpr int kCoarsest = 5;

  explicit View3D(Renderer& renderer);
  ~View3D();

  // Draws as much as fits the budget; call again while !complete().
  //   scale  1: full resolution; n: every n-th pixel each way. 0: while something moves, at most every kCoarsest-th, by
  //          what the last pictures took, so that a frame takes about 33 ms; full resolution after a rest of 100 ms
  //   now    seconds, of any steady clock
  void draw(const Scene& scene, const Camera& camera, const glm::ivec2& size, double now, int scale = 0);
  bool complete() const;
  int scale() const;  // of the body in the last picture; 0: there is none
  std::int64_t rays_followed()
      const;                 // pixels of all pictures so far whose rays were followed, the covered rectangles'
  unsigned texture() const;  // RGBA8, `size` pixels, top row first when drawn with uv (0, 1) to (1, 0)
  Image read() const;        // the finished picture

  // From the buffers of the last picture; pixel from the top left corner.
  std::optional<Hit> pick(const glm::ivec2& pixel) const;
  std::optional<int> pick_bone(const glm::ivec2& pixel) const;
  std::vector<BoneHit> pick_bones(const glm::ivec2& pixel) const;  // all that lie there

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

class SliceView {
 public:
  explicit SliceView(Renderer& renderer);
  ~SliceView();
  void draw(const Scene& scene, const SliceCamera& camera, SliceDisplay display, const glm::ivec2& size);
  bool complete() const;  // all weights of the last picture were there
  unsigned texture() const;
  Image read() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace limber::render
