// SPDX-License-Identifier: AGPL-3.0-or-later
#include <algorithm>
#include <chrono>

#include <epoxy/gl.h>

#include "core/volume/tissue_voxels.h"
#include "render/passes/pass_resources.h"
#include "render/view.h"

namespace limber::render {

std::shared_ptr<PreparedBody> prepared_body(const std::shared_ptr<const LabelVolume>& volume, const LabelLooks& looks,
                                            Display display, const TextureLimits& limits, Progress& progress) {
  auto prepared = std::make_shared<PreparedBody>(PreparedBody{volume, drawn_volume(volume, limits), {}});
  const std::shared_ptr<const LabelVolume> drawn = prepared->volume.drawn();
  const std::vector<LabelSet> layers = layers_of(looks, display, prepared->volume.exposure);
  for (const LabelSet& set : layers) {
    progress.update("picture", double(prepared->layers.size()) / double(layers.size()));
    prepared->layers.push_back(prepared_field(*drawn, prepared->volume.layout, set));
  }
  return prepared;
}

Renderer::Renderer(int largest_texture) : resources_(std::make_unique<PassResources>(largest_texture)) {}
Renderer::~Renderer() = default;
void Renderer::begin_frame(double upload_seconds) {
  resources_->upload_time =
      UploadTime{std::chrono::steady_clock::now() + std::chrono::duration_cast<std::chrono::steady_clock::duration>(
                                                        std::chrono::duration<double>(upload_seconds))};
}
bool Renderer::upload(PreparedBody& prepared) { return resources_->upload(prepared); }
void Renderer::limit_memory(std::int64_t bytes) { resources_->limits.bytes = bytes; }
const TextureLimits& Renderer::limits() const { return resources_->limits; }
void Renderer::average_at_rest(int pictures) { resources_->pictures_at_rest = std::max(0, pictures); }
void Renderer::light_at_rest(Light light) { resources_->fine_light = light == Light::Fine; }
void Renderer::finish() { glFinish(); }
const std::string& Renderer::note() const { return resources_->note; }

}  // namespace limber::render
