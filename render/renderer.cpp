// SPDX-License-Identifier: AGPL-3.0-or-later
#include <algorithm>
#include <chrono>

#include <epoxy/gl.h>

#include "core/volume/tissue_voxels.h"
#include "render/passes/pass_resources.h"
#include "render/scene/camera.h"
#include "render/view.h"

namespace limber::render {

std::shared_ptr<PreparedBody> prepared_body(const std::shared_ptr<const LabelVolume>& volume, const LabelLooks& looks,
                                            Display display, const TextureLimits& limits, Progress& progress,
                                            const std::optional<ShownGrey>& grey) {
  auto prepared = std::make_shared<PreparedBody>(PreparedBody{.original = volume,
                                                              .volume = drawn_volume(volume, limits),
                                                              .looks = std::make_shared<const LabelLooks>(looks),
                                                              .display = display,
                                                              .grey = grey});
  const std::shared_ptr<const LabelVolume> drawn = prepared->volume.drawn();
  const std::vector<LabelSet> layers = layers_of(looks, display, prepared->volume.exposure);
  for (const LabelSet& set : layers) {
    progress.update("picture", double(prepared->layers.size()) / double(layers.size()));
    prepared->layers.push_back(prepared_field(*drawn, prepared->volume.layout, set));
  }
  return prepared;
}

namespace {

// Size of a trial picture, pixels. A software driver compiles other code for textures whose edges are powers of two.
constexpr glm::ivec2 kTrialSize{20, 12};

// Draws a picture of a few pixels, which nobody sees. A driver compiles its own code for a shader when a picture first
// uses the shader with textures of these formats; after this picture, the views' first picture of the body need not
// wait for that.
void draw_trial_picture(Renderer& renderer, const PreparedBody& prepared,
                        const std::shared_ptr<const LabelVolume>& volume) {
  Scene scene;
  scene.volume = volume;
  scene.looks = prepared.looks;
  scene.display = prepared.grey ? Display::Image : prepared.display;
  scene.grey = prepared.grey;
  const AffineTransform to_world = world_from_voxel(volume->grid);
  const glm::dvec3 a = to_world * glm::dvec3(0), b = to_world * glm::dvec3(volume->grid.size);
  View3D(renderer).draw(scene, framing(looking_from(StandardView::Front, Camera{}), glm::min(a, b), glm::max(a, b), 1),
                        kTrialSize, 0, 1);
}

}  // namespace

Renderer::Renderer(int largest_texture) : resources_(std::make_unique<PassResources>(largest_texture)) {}
Renderer::~Renderer() = default;
void Renderer::begin_frame(double upload_seconds) {
  resources_->upload_time =
      UploadTime{std::chrono::steady_clock::now() + std::chrono::duration_cast<std::chrono::steady_clock::duration>(
                                                        std::chrono::duration<double>(upload_seconds))};
}

bool Renderer::upload(PreparedBody& prepared) {
  using Step = PreparedBody::Step;
  const std::shared_ptr<const LabelVolume> volume = prepared.original;
  switch (prepared.step) {
    case Step::Body:
      if (!resources_->has(volume)) {
        if (!resources_->upload(prepared)) return false;
        prepared.step = Step::Image;
      } else {
        prepared.step = prepared.grey ? Step::Image : Step::Done;  // a view has drawn the body meanwhile
      }
      break;
    case Step::Image:
      if (!prepared.grey || resources_->grey(prepared.grey, PassResources::Extent::InTime)->complete())
        prepared.step = Step::Programs;
      break;
    case Step::Programs:
      resources_->volume_pass(*resources_->body(volume).volume, VolumePass::Space::Rest);
      prepared.step = Step::TrialPicture;
      break;
    case Step::TrialPicture:
      draw_trial_picture(*this, prepared, volume);
      resources_->note.clear();  // the note on the body is for the views that show it
      prepared.step = Step::Done;
      break;
    case Step::Done: break;
  }
  return prepared.step == Step::Done;
}
void Renderer::limit_memory(std::int64_t bytes) { resources_->limits.bytes = bytes; }
const TextureLimits& Renderer::limits() const { return resources_->limits; }
void Renderer::average_at_rest(int pictures) { resources_->pictures_at_rest = std::max(0, pictures); }
void Renderer::light_at_rest(Light light) { resources_->fine_light = light == Light::Fine; }
void Renderer::finish() { glFinish(); }
const std::string& Renderer::note() const { return resources_->note; }

}  // namespace limber::render
