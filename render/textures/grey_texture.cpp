// SPDX-License-Identifier: AGPL-3.0-or-later
#include "render/textures/grey_texture.h"

#include <algorithm>
#include <string>

#include <epoxy/gl.h>

#include "core/base/error.h"

namespace limber::render {

namespace {

constexpr Format3D kLevels = {GL_R16, GL_RED, GL_UNSIGNED_SHORT, true};
constexpr Format3D kRanges = {GL_RG16, GL_RG, GL_UNSIGNED_SHORT, false};
constexpr int kMostHalvings = 3;
constexpr std::int64_t kAtOnce = 2 << 20;  // number of voxels that are uploaded between two checks of the time limit

}  // namespace

GreyTexture::GreyTexture(const std::shared_ptr<const GreyLevels>& image, int largest_texture)
    : original_(image),
      levels_(gl::Texture::create()),
      ranges_(gl::Texture::create()) {
  std::shared_ptr<const GreyLevels> drawn = image;
  const auto fits = [&] {
    const glm::ivec3& size = drawn->grid.size;
    return std::max({size.x, size.y, size.z}) <= largest_texture && allocate(levels_, size, kLevels);
  };
  while (!fits()) {
    if (halvings_ == kMostHalvings)
      throw Error("the image cannot be shown: the graphics driver has no room for it",
                  std::to_string(image->grid.size.x) + " x " + std::to_string(image->grid.size.y) + " x " +
                      std::to_string(image->grid.size.z) + " voxels",
                  "open it with a larger spacing");
    drawn = coarse_ = std::make_shared<const GreyLevels>(halved(*drawn));
    ++halvings_;
  }
  grid_ = drawn->grid;
  least_ = drawn->least;
  range_ = drawn->step * 65535;
  if (!allocate(ranges_, drawn->blocks(), kRanges, drawn->ranges.data()))
    throw Error("the image cannot be shown: the graphics driver has no room for it", "ranges of its values",
                "close other pictures, or open it with a larger spacing");
}

void GreyTexture::upload(UploadTime* time) {
  const std::shared_ptr<const GreyLevels> drawn = coarse_ ? coarse_ : original_.lock();
  if (!drawn || complete()) return;
  glBindTexture(GL_TEXTURE_3D, levels_.name());
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  const std::int64_t slice = std::int64_t{grid_.size.x} * grid_.size.y;
  const int lot = static_cast<int>(std::max<std::int64_t>(1, kAtOnce / std::max<std::int64_t>(1, slice)));
  while (!complete()) {
    if (time && time->is_over()) return;
    const int count = std::min(lot, grid_.size.z - next_slice_);
    glTexSubImage3D(GL_TEXTURE_3D, 0, 0, 0, next_slice_, grid_.size.x, grid_.size.y, count, kLevels.pixels,
                    kLevels.type, &drawn->levels[static_cast<std::size_t>(slice * next_slice_)]);
    next_slice_ += count;
    if (time) time->used = true;
  }
  coarse_.reset();
}

int GreyTexture::bind(const VolumeTexture& volume, gl::Program& program, int first) const {
  program.set_texture("u_grey", first++, GL_TEXTURE_3D, levels_.name());
  program.set_texture("u_grey_ranges", first++, GL_TEXTURE_3D, ranges_.name());
  // Computes two transforms: padded coordinates of the volume to voxel coordinates of the image, and these to
  // fractions [0, 1] of the image's texture.
  const AffineTransform to_padded = padded_from_world(volume.grid()), to_voxel = voxel_from_world(grid_);
  const glm::dmat3 linear = to_voxel.linear * glm::inverse(to_padded.linear);
  const glm::dvec3 size(grid_.size), offset = to_voxel.offset - linear * to_padded.offset + 0.5;
  glm::dmat3 scaled;
  for (int column = 0; column < 3; ++column) scaled[column] = linear[column] / size;
  program.set("u_grey_linear", glm::mat3(scaled));
  program.set("u_grey_offset", glm::vec3(offset / size));
  program.set("u_grey_size", glm::vec3(grid_.size));
  return first;
}

std::array<glm::dvec3, 2> GreyTexture::padded_box(const VolumeTexture& volume) const {
  const AffineTransform to_world = world_from_voxel(grid_), to_padded = padded_from_world(volume.grid());
  glm::dvec3 low(1e300), high(-1e300);
  for (int corner = 0; corner < 8; ++corner) {
    const glm::dvec3 voxel = glm::dvec3(corner & 1, corner >> 1 & 1, corner >> 2) * glm::dvec3(grid_.size) - 0.5;
    const glm::dvec3 at = to_padded * (to_world * voxel);
    low = glm::min(low, at);
    high = glm::max(high, at);
  }
  return {low, high};
}

}  // namespace limber::render
