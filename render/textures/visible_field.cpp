// SPDX-License-Identifier: AGPL-3.0-or-later
#include "render/textures/visible_field.h"

#include <algorithm>
#include <utility>

#include <epoxy/gl.h>

#include "core/base/error.h"

namespace limber::render {

namespace {
constexpr Format3D kField = {GL_R8, GL_RED, GL_UNSIGNED_BYTE, true};
}  // namespace

PreparedField prepared_field(const LabelVolume& drawn, const BlockLayout& layout, const LabelSet& set) {
  PreparedField prepared;
  prepared.texels = prepared.field.update(drawn, layout, set);
  prepared.faces = prepared.field.hull();
  prepared.occupancy = prepared.field.occupancy();
  return prepared;
}

VisibleField::VisibleField(const VolumeTexture& volume, PreparedField&& prepared)
    : field_(std::move(prepared.field)),
      texels_(std::move(prepared.texels)),
      faces_(std::move(prepared.faces)),
      occupancy_(std::move(prepared.occupancy)),
      index_(gl::Texture::create()),
      occupancy_texture_(gl::Texture::create()) {
  const BlockLayout& layout = volume.layout();
  for (int a = 0; a < layout.atlases; ++a) {
    atlases_.push_back(gl::Texture::create());
    if (!allocate(atlases_.back(), layout.slots * kSlot, kField))
      throw Error("the volume cannot be shown: the graphics driver has no room for it", "its smooth surface",
                  "re-grid it with a larger spacing");
  }
}

VisibleField::VisibleField(const VolumeTexture& volume, const LabelSet& set)
    : VisibleField(volume, prepared_field(*volume.drawn(), volume.layout(), set)) {
  upload(volume, nullptr);
}

void VisibleField::update(const VolumeTexture& volume, const LabelSet& set, const std::vector<std::uint8_t>& changed) {
  upload(volume, nullptr);
  texels_ = field_.update(*volume.drawn(), volume.layout(), set, changed);
  if (field_.hull_changed()) faces_ = field_.hull();
  if (field_.occupancy_changed()) occupancy_ = field_.occupancy();
  next_slot_ = 0;
  upload(volume, nullptr);
}

void VisibleField::upload(const VolumeTexture& volume, UploadTime* time) {
  if (complete()) return;
  const BlockLayout& layout = volume.layout();
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  if (next_slot_ == 0) blocks_computed_ = 0;
  for (; next_slot_ < std::ssize(texels_); ++next_slot_) {
    std::vector<std::uint8_t>& texels = texels_[static_cast<size_t>(next_slot_)];
    if (texels.empty()) continue;
    if (time && time->is_over()) return;
    const int slot = static_cast<int>(next_slot_);
    const glm::ivec3 at = layout.place_of(slot) * kSlot;
    glBindTexture(GL_TEXTURE_3D, atlases_[static_cast<size_t>(layout.atlas_of(slot))].name());
    glTexSubImage3D(GL_TEXTURE_3D, 0, at.x, at.y, at.z, kSlot, kSlot, kSlot, kField.pixels, kField.type, texels.data());
    texels = {};
    ++blocks_computed_;
    if (time) time->used = true;
  }
  next_slot_ = -1;
  texels_ = {};
  upload_index(index_, layout, field_.slot_present());
  if (field_.hull_changed()) hull_.upload(std::exchange(faces_, {}), kBrick, glm::dvec3(0));
  const glm::ivec3& size = field_.bricks();
  const std::uint8_t nothing = 0;
  if (glm::any(glm::greaterThan(size, glm::ivec3(volume.largest_texture()))))
    allocate(occupancy_texture_, glm::ivec3(1), kField, &nothing);
  else if (field_.occupancy_changed()) allocate(occupancy_texture_, size, kField, occupancy_.data());
  occupancy_ = {};
  ++revision_;
  gl::check_gl("the upload of a visible set");
}

int VisibleField::bind(const VolumeTexture& volume, gl::Program& program, int first) const {
  first = bind_atlases(program, "u_field", atlases_, first);
  program.set_texture("u_index", first++, GL_TEXTURE_3D, index_.name());
  program.set("u_texel", 1.0f / glm::vec3(volume.layout().slots * kSlot));
  return first;
}

}  // namespace limber::render
