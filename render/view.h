// SPDX-License-Identifier: AGPL-3.0-or-later
// Draws a picture of a scene, a 3D view or a slice, into a texture of its own. The editor shows this texture, and the
// command line saves it. Everything here needs a current OpenGL 3.3 core context. Volumes are uploaded once and shared
// by all views.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <glm/glm.hpp>

#include "core/base/progress.h"
#include "core/volume/label_volume.h"
#include "render/image_io.h"
#include "render/scene/camera.h"
#include "render/scene/scene.h"
#include "render/scene/slice_camera.h"
#include "render/textures/texture_limits.h"

namespace limber::render {

struct PassResources;
struct PreparedBody;

// Computes all data of a label volume that must be uploaded before it can be drawn. It needs no OpenGL, so any thread
// may call it while others draw. Renderer::upload() then uploads the result over several frames. Throws Cancelled.
// Throws Error if the volume does not fit in textures.
//   looks, display  the settings with which the volume will be drawn; with other settings, parts are computed again
//   limits          the result of Renderer::limits()
//   grey            the grey image that will be shown with the volume; empty: none
std::shared_ptr<PreparedBody> prepared_body(const std::shared_ptr<const LabelVolume>& volume, const LabelLooks& looks,
                                            Display display, const TextureLimits& limits, Progress& progress,
                                            const std::optional<ShownGrey>& grey = {});

// How the light on a body is computed. Draft: from the body's blurred occupancy, immediately, also while something
// moves. Fine: by rays through the body to the light and to the sky, while nothing moves (render/passes/light_pass.h).
enum class Light { Draft, Fine };

// The resources of one OpenGL context: textures of the volumes in use, and shader programs.
class Renderer {
 public:
  // Makes the resources of the current context; volumes are uploaded later. Throws Error when the context is older than
  // OpenGL 3.3.
  //   largest_texture  largest number of texels per axis of a 3D texture; 0: as many as the driver allows. A larger
  //                    volume is divided into blocks.
  explicit Renderer(int largest_texture = 0);
  ~Renderer();
  Renderer(const Renderer&) = delete;
  Renderer& operator=(const Renderer&) = delete;

  // Returns a note for the user on the last upload ("Shown at 1/2 of its resolution: ..."), or an empty text.
  const std::string& note() const;

  // Begins a frame. Until the next call, all views and upload() together spend about `upload_seconds` on uploading
  // large changes of weights, grey images and prepared bodies. While changes that a view shows still wait, the view's
  // complete() returns false. If begin_frame() is never called, each draw uploads everything.
  void begin_frame(double upload_seconds);

  // Makes a prepared body ready to be drawn, in several calls: uploads as much as the frame's time limit allows, then
  // compiles the shaders, and at last draws a tiny picture. Returns true when the body can be drawn without delay.
  // Throws Error when the driver has no memory for it.
  bool upload(PreparedBody& prepared);
  // Limits the memory for the textures of each volume that is uploaded from now on, bytes. A volume that needs more is
  // drawn at a coarser resolution. By default, only the driver limits the memory.
  void limit_memory(std::int64_t bytes);
  const TextureLimits& limits() const;

  // Sets the number of pictures that are averaged while nothing moves; the default is six. Fewer pictures are finished
  // sooner, but are less smooth. With 0, the picture keeps the coarse scale of 3 (every third pixel), for tests that
  // need no good picture.
  void average_at_rest(int pictures);

  // Sets how the light is computed while nothing moves; the default is Draft. Fine light starts when the pictures of
  // average_at_rest() are complete. The same number of pictures with fine light is then added, and the fine light
  // fades in.
  void light_at_rest(Light light);

  // Waits until everything drawn so far is finished, for time measurements.
  void finish();

  PassResources& resources() { return *resources_; }

 private:
  std::unique_ptr<PassResources> resources_;
};

// The point of the body that a pixel shows.
struct Hit {
  Label label = 0;
  glm::ivec3 voxel{0};   // voxel of the volume; of a posed body, the voxel at the rest position
  glm::dvec3 point{0};   // position of the point in the world, mm
  glm::dvec3 normal{0};  // unit normal of the surface in the world; zero on a cut face or slice
};

// A 3D picture that is refined over several calls: coarse while something moves, in full resolution when nothing moves.
class View3D {
 public:
  // Coarsest scale of a moving picture. At scale 5 there is one ray for 5 x 5 pixels, so each pixel shows the ray of a
  // pixel that is at most two pixels away. Only pictures of a grey image are drawn at a coarser scale.
  static constexpr int kCoarsest = 5;

  explicit View3D(Renderer& renderer);
  ~View3D();

  // Draws as much as fits the time limit. The caller draws again until complete() returns true.
  //   scale  1: full resolution; n: every n-th pixel along each axis. 0: while something moves, the scale adapts to the
  //          time of the last pictures, up to kCoarsest, so that a frame takes about 33 ms; full resolution after 100
  //          ms at rest
  //   now    seconds, of any steady clock
  void draw(const Scene& scene, const Camera& camera, const glm::ivec2& size, double now, int scale = 0);
  bool complete() const;
  int scale() const;  // scale at which the last picture drew the body; 0: no body
  // Returns the number of rays in all pictures so far. A picture counts one ray for each pixel of the rectangle that
  // the body covers.
  std::int64_t rays_followed() const;
  unsigned texture() const;  // returns the picture as an RGBA8 texture of `size` pixels; its top row is at v = 1
  Image read() const;        // returns the finished picture

  // Returns the labels that the last picture shows on at least `pixels` of its pixels, in ascending order. Tissue
  // behind an opaque one is not shown, but tissue behind a transparent one is.
  std::vector<Label> shown_labels(int pixels) const;

  // Returns the label of the outermost visible tissue at each pixel of the last picture, 0 where the picture shows no
  // tissue. The first row is the bottom row. A picture in a coarser scale has fewer pixels.
  std::vector<Label> pixel_labels() const;

  // These functions return what the last picture shows at a pixel. Pixels are counted from the top left corner.
  std::optional<Hit> pick(const glm::ivec2& pixel) const;
  std::optional<int> pick_bone(const glm::ivec2& pixel) const;
  // Returns all bones whose drawn shapes are under the pixel.
  std::vector<BoneHit> pick_bones(const glm::ivec2& pixel) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

class SliceView {
 public:
  explicit SliceView(Renderer& renderer);
  ~SliceView();
  void draw(const Scene& scene, const SliceCamera& camera, SliceDisplay display, const glm::ivec2& size);
  bool complete() const;  // true if all weights and images that the last picture shows were uploaded
  unsigned texture() const;
  Image read() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace limber::render
