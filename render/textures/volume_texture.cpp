// SPDX-License-Identifier: AGPL-3.0-or-later
#include "render/textures/volume_texture.h"

#include <algorithm>
#include <mutex>
#include <utility>

#include <epoxy/gl.h>

#include "core/base/error.h"
#include "core/base/parallel.h"

namespace limber::render {

namespace {

constexpr int kBlockShift = 5;

constexpr Format3D kLabels = {GL_R16UI, GL_RED_INTEGER, GL_UNSIGNED_SHORT, false};
constexpr int kMostHalvings = 3;
// A changed label can affect the stored texels (the slot) of every block up to this far away, voxels. A block gets a
// slot if there is tissue within two bricks. A slot's apron and the blur of the surface reach less far.
constexpr int kNear = 2 * kBrick;

// Collects the labels of a block and of the kApron voxels around it, which are stored together. Voxels outside the grid
// are air.
void gather(const LabelVolume& volume, const glm::ivec3& block, std::vector<Label>& slot) {
  const glm::ivec3 low = block * kBlock - kApron - kPad, size = volume.grid.size;
  slot.assign(static_cast<size_t>(kSlot) * kSlot * kSlot, 0);
  const int from = std::max(low.x, 0), to = std::min(low.x + kSlot, size.x);
  if (from >= to) return;
  for (int z = std::max(low.z, 0); z < std::min(low.z + kSlot, size.z); ++z)
    for (int y = std::max(low.y, 0); y < std::min(low.y + kSlot, size.y); ++y) {
      const Label* row = volume.voxels.data() + volume.grid.index({0, y, z});
      std::copy(row + from, row + to, slot.data() + ((z - low.z) * kSlot + (y - low.y)) * kSlot + (from - low.x));
    }
}

// Returns whether a block, or the kNear voxels around it, has tissue.
bool has_tissue_near(const LabelVolume& volume, const glm::ivec3& block) {
  const glm::ivec3 low = glm::max(block * kBlock - kPad - kNear, glm::ivec3(0)),
                   high = glm::min((block + 1) * kBlock - kPad + kNear, volume.grid.size);
  for (int z = low.z; z < high.z; ++z)
    for (int y = low.y; y < high.y; ++y) {
      const Label* row = volume.voxels.data() + volume.grid.index({0, y, z});
      if (std::any_of(row + low.x, row + std::max(low.x, high.x), [](Label label) { return label != 0; })) return true;
    }
  return false;
}

// Estimates, for each tissue, the fraction of its voxels that have air beside them along x. Only every second voxel is
// examined.
class Exposure {
 public:
  void add(const Exposure& other) {
    for (size_t label = 0; label < voxels_.size(); ++label) {
      voxels_[label] += other.voxels_[label];
      touching_[label] += other.touching_[label];
    }
  }
  void count(const std::vector<Label>& slot) {
    for (size_t i = 0; i + 2 < slot.size(); i += 2) {
      ++voxels_[slot[i + 1]];
      touching_[slot[i + 1]] += slot[i] == 0 || slot[i + 2] == 0;
    }
  }
  std::vector<float> shares() const {
    std::vector<float> shares(voxels_.size());
    for (size_t label = 1; label < shares.size(); ++label)
      if (voxels_[label] > 0) shares[label] = float(touching_[label]) / float(voxels_[label]);
    return shares;
  }

 private:
  std::vector<std::uint32_t> voxels_ = std::vector<std::uint32_t>(65536), touching_ = std::vector<std::uint32_t>(65536);
};

std::vector<float> exposure_of(const LabelVolume& volume, const BlockLayout& layout) {
  constexpr std::int64_t kSlots = 256;  // number of slots that are counted in one parallel work block
  Exposure all;
  std::mutex adding;
  parallel_for(std::ssize(layout.block_of_slot), kSlots, [&](std::int64_t begin, std::int64_t end) {
    Exposure some;
    std::vector<Label> slot;
    for (std::int64_t s = begin; s < end; ++s) {
      gather(volume, layout.block_of_slot[static_cast<size_t>(s)], slot);
      some.count(slot);
    }
    const std::lock_guard lock(adding);
    all.add(some);
  });
  return all.shares();
}

std::string describe(const glm::ivec3& size) {
  return std::to_string(size.x) + " x " + std::to_string(size.y) + " x " + std::to_string(size.z) + " voxels";
}

[[noreturn]] void refuse(const LabelVolume& volume) {
  throw Error("the volume cannot be shown: the graphics driver has no room for it", describe(volume.grid.size),
              "re-grid it with a larger spacing");
}

// Returns the memory that labels and one surface take, in bytes.
std::int64_t bytes_of(const BlockLayout& layout) {
  constexpr std::int64_t kTexel = sizeof(Label) + 1;
  return std::ssize(layout.block_of_slot) * kTexel * kSlot * kSlot * kSlot;
}

Grid halved_often(Grid grid, int halvings) {
  for (; halvings > 0; --halvings) grid = halved(grid);
  return grid;
}

// Updates a coarse volume after the original volume has changed within `box`. Returns the updated box in voxels of the
// coarse volume.
VoxelBox renew(LabelVolume& coarse, const LabelVolume& volume, const VoxelBox& box, int halvings) {
  const glm::ivec3 from = box.lowest >> halvings, to = (box.lowest + box.size - 1) >> halvings;
  LabelVolume part;
  const glm::ivec3 low = from << halvings;
  part.grid.size = glm::min((to + 1) << halvings, volume.grid.size) - low;
  part.voxels.resize(static_cast<size_t>(part.grid.voxel_count()));
  for (int z = 0; z < part.grid.size.z; ++z)
    for (int y = 0; y < part.grid.size.y; ++y) {
      const Label* row = volume.voxels.data() + volume.grid.index(low + glm::ivec3(0, y, z));
      std::copy(row, row + part.grid.size.x, part.voxels.data() + part.grid.index({0, y, z}));
    }
  for (int i = 0; i < halvings; ++i) part = halved(part);
  for (int z = 0; z < part.grid.size.z; ++z)
    for (int y = 0; y < part.grid.size.y; ++y) {
      const Label* row = part.voxels.data() + part.grid.index({0, y, z});
      std::copy(row, row + part.grid.size.x, coarse.voxels.data() + coarse.grid.index(from + glm::ivec3(0, y, z)));
    }
  return {from, to - from + 1};
}

}  // namespace

bool allocate(const gl::Texture& texture, const glm::ivec3& size, const Format3D& format, const void* texels) {
  glBindTexture(GL_TEXTURE_3D, texture.name());
  glTexImage3D(GL_PROXY_TEXTURE_3D, 0, format.internal, size.x, size.y, size.z, 0, format.pixels, format.type, nullptr);
  GLint width = 0;
  glGetTexLevelParameteriv(GL_PROXY_TEXTURE_3D, 0, GL_TEXTURE_WIDTH, &width);
  if (width == 0) return false;
  gl::check_gl("before a volume is uploaded");
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  glTexImage3D(GL_TEXTURE_3D, 0, format.internal, size.x, size.y, size.z, 0, format.pixels, format.type, texels);
  if (glGetError() != GL_NO_ERROR) return false;
  const GLint filter = format.linear ? GL_LINEAR : GL_NEAREST;
  glTexParameteri(GL_TEXTURE_3D, GL_TEXTURE_MIN_FILTER, filter);
  glTexParameteri(GL_TEXTURE_3D, GL_TEXTURE_MAG_FILTER, filter);
  for (const GLenum axis : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T, GL_TEXTURE_WRAP_R})
    glTexParameteri(GL_TEXTURE_3D, axis, GL_CLAMP_TO_EDGE);
  return true;
}

bool upload_index(const gl::Texture& texture, const BlockLayout& layout, const std::vector<std::uint8_t>& present) {
  std::vector<glm::u8vec4> texels(layout.slot_of_block.size(), glm::u8vec4(0));
  for (size_t s = 0; s < present.size(); ++s) {
    if (!present[s]) continue;
    const int slot = static_cast<int>(s);
    texels[static_cast<size_t>(layout.block_index(layout.block_of_slot[s]))] =
        glm::u8vec4(layout.place_of(slot), layout.atlas_of(slot) + 1);
  }
  return allocate(texture, layout.blocks, {GL_RGBA8UI, GL_RGBA_INTEGER, GL_UNSIGNED_BYTE, false}, texels.data());
}

int bind_atlases(gl::Program& program, const std::string& name, const std::vector<gl::Texture>& atlases, int first) {
  for (size_t a = 0; a < atlases.size(); ++a)
    program.set_texture((name + std::to_string(a)).c_str(), first++, GL_TEXTURE_3D, atlases[a].name());
  return first;
}

DrawnVolume drawn_volume(const std::shared_ptr<const LabelVolume>& volume, const TextureLimits& limits,
                         int least_halvings) {
  DrawnVolume result;
  result.original = volume;
  result.largest_texture = limits.side;
  for (;;) {
    const LabelVolume& drawn = result.coarse ? *result.coarse : *volume;
    result.layout = block_layout(drawn);
    const bool is_small = bytes_of(result.layout) <= limits.bytes || result.halvings == kMostHalvings;
    if (result.halvings >= least_halvings && is_small && place_slots(result.layout, limits.side)) break;
    if (result.halvings == kMostHalvings) refuse(*volume);
    result.coarse = std::make_shared<LabelVolume>(halved(drawn));
    ++result.halvings;
  }
  const LabelVolume& drawn = result.coarse ? *result.coarse : *volume;
  result.grid = drawn.grid;
  result.exposure = exposure_of(drawn, result.layout);
  return result;
}

VolumeTexture::VolumeTexture(const std::shared_ptr<const LabelVolume>& volume, const TextureLimits& limits)
    : volume_(drawn_volume(volume, limits)) {
  while (!allocate_atlases()) {
    if (halvings() == kMostHalvings) refuse(*volume);
    volume_ = drawn_volume(volume, limits, halvings() + 1);
  }
  upload(nullptr);
}

VolumeTexture::VolumeTexture(DrawnVolume volume) : volume_(std::move(volume)) {
  if (!allocate_atlases()) refuse(*drawn());
}

bool VolumeTexture::allocate_atlases() {
  atlases_.clear();
  for (int a = 0; a < layout().atlases; ++a) {
    atlases_.push_back(gl::Texture::create());
    if (!allocate(atlases_.back(), layout().slots * kSlot, kLabels)) return false;
  }
  index_ = gl::Texture::create();
  if (!upload_index(index_, layout(), std::vector<std::uint8_t>(layout().block_of_slot.size(), 1))) return false;
  note_.clear();
  if (const auto whole = volume_.original.lock(); whole && halvings() > 0)
    note_ = "Shown at 1/" + std::to_string(1 << halvings()) + " of its resolution: no room for all of its " +
            describe(whole->grid.size);
  return true;
}

void VolumeTexture::upload_slot(int slot, const LabelVolume& labels, std::vector<Label>& texels) const {
  gather(labels, layout().block_of_slot[static_cast<size_t>(slot)], texels);
  const glm::ivec3 at = layout().place_of(slot) * kSlot;
  glBindTexture(GL_TEXTURE_3D, atlases_[static_cast<size_t>(layout().atlas_of(slot))].name());
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  glTexSubImage3D(GL_TEXTURE_3D, 0, at.x, at.y, at.z, kSlot, kSlot, kSlot, kLabels.pixels, kLabels.type, texels.data());
}

bool VolumeTexture::relabel(const std::shared_ptr<const LabelVolume>& now, const VoxelBox& box_of_original,
                            std::vector<std::uint8_t>& changed) {
  if (!complete() || !(halved_often(now->grid, halvings()) == volume_.grid)) return false;
  volume_.original = now;
  VoxelBox box = box_of_original;
  if (volume_.coarse && box.size.x > 0) box = renew(*volume_.coarse, *now, box, halvings());
  const LabelVolume& drawn = volume_.coarse ? *volume_.coarse : *now;
  BlockLayout& blocks = volume_.layout;
  changed.assign(blocks.block_of_slot.size(), 0);
  if (box.size.x == 0) return true;
  const glm::ivec3 from = glm::max(box.lowest + kPad - kNear, glm::ivec3(0)) / kBlock,
                   to = glm::min((box.lowest + box.size - 1 + kPad + kNear) / kBlock, blocks.blocks - 1);
  bool grown = false;
  std::vector<Label> texels;
  for (int z = from.z; z <= to.z; ++z)
    for (int y = from.y; y <= to.y; ++y)
      for (int x = from.x; x <= to.x; ++x) {
        int& slot = blocks.slot_of_block[static_cast<size_t>(blocks.block_index({x, y, z}))];
        if (slot < 0) {
          if (!has_tissue_near(drawn, {x, y, z})) continue;
          if (std::ssize(blocks.block_of_slot) == std::int64_t{blocks.slots_per_atlas()} * blocks.atlases) return false;
          slot = static_cast<int>(blocks.block_of_slot.size());
          blocks.block_of_slot.push_back({x, y, z});
          changed.push_back(1);
          grown = true;
        }
        changed[static_cast<size_t>(slot)] = 1;
        upload_slot(slot, drawn, texels);
      }
  if (grown && !upload_index(index_, blocks, std::vector<std::uint8_t>(blocks.block_of_slot.size(), 1))) return false;
  gl::check_gl("the upload of changed labels");
  return true;
}

void VolumeTexture::upload(UploadTime* time) {
  const std::shared_ptr<const LabelVolume> labels = drawn();
  if (complete() || !labels) return;
  std::vector<Label> slot;
  for (; next_slot_ < std::ssize(layout().block_of_slot); ++next_slot_) {
    if (time && time->is_over()) return;
    upload_slot(next_slot_, *labels, slot);
    if (time) time->used = true;
  }
  next_slot_ = -1;
  gl::check_gl("the upload of a volume");
}

int VolumeTexture::bind(gl::Program& program, int first) const {
  return bind_atlases(program, "u_labels", atlases_, first);
}

std::string atlas_defines(int atlases) {
  static_assert(kBlock == 1 << kBlockShift && kMostAtlases == 4);  // shaders/atlases.glsl relies on these values
  return gl::define("ATLASES", atlases) + gl::define("SLOT", kSlot) + gl::define("APRON", kApron) +
         gl::define("BLOCK", kBlock) + gl::define("BLOCK_SHIFT", kBlockShift);
}

}  // namespace limber::render
