// SPDX-License-Identifier: AGPL-3.0-or-later
#include <algorithm>
#include <chrono>

#include <epoxy/gl.h>

#include "core/volume/tissue_voxels.h"
#include "render/passes/pass_resources.h"
#include "render/view.h"

namespace limber::render {

Renderer::Renderer(int largest_texture) : resources_(std::make_unique<PassResources>(largest_texture)) {}
Renderer::~Renderer() = default;
void Renderer::begin_frame(double upload_seconds) {
  resources_->upload_time =
      UploadTime{std::chrono::steady_clock::now() + std::chrono::duration_cast<std::chrono::steady_clock::duration>(
                                                        std::chrono::duration<double>(upload_seconds))};
}
void Renderer::average_at_rest(int pictures) { resources_->pictures_at_rest = std::max(0, pictures); }
void Renderer::finish() { glFinish(); }
const std::string& Renderer::note() const { return resources_->note; }

}  // namespace limber::render
