// SPDX-License-Identifier: AGPL-3.0-or-later
#include "render/textures/weight_texture.h"

#include <algorithm>
#include <array>
#include <stdexcept>
#include <tuple>
#include <utility>

#include <epoxy/gl.h>

#include "core/base/error.h"
#include "core/base/parallel.h"
#include "core/skin/skin_weights.h"
#include "core/volume/tissue_voxels.h"
#include "render/scene/weight_colormap.h"

namespace limber::render {

namespace {

constexpr Format3D kTexels = {GL_RGBA8, GL_RGBA, GL_UNSIGNED_BYTE, true};
// Number of latest uploads whose boxes are remembered. A view that has missed more uploads is recoloured as a whole.
constexpr std::size_t kRemembered = 64;

// Computes the texel that shows the skin weights of one voxel (an Influence).
class Texels {
 public:
  explicit Texels(const ShownWeights& shown) : shown_(shown) {
    if (shown.swatches) swatches_ = *shown.swatches;
    if (shown.bone >= 0 && shown.bone < std::ssize(swatches_))
      swatches_[static_cast<std::size_t>(shown.bone)] = kActiveBone;
  }

  glm::u8vec4 of(const Influence& influence) const {
    switch (shown_.display) {
      case WeightDisplay::Active: return of_active(influence);
      case WeightDisplay::Dominant: return of_colour(swatches_[influence.bone[0]]);
      case WeightDisplay::Mixed: return of_colour(mixed_colour(influence, swatches_));
      case WeightDisplay::Count:
      case WeightDisplay::Field: break;
    }
    return of_colour(count_colour(static_cast<int>(
        std::count_if(influence.weight.begin(), influence.weight.end(), [](auto weight) { return weight > 0; }))));
  }

 private:
  glm::u8vec4 of_active(const Influence& influence) const {
    int weight = 0;
    for (int i = 0; i < 4; ++i)
      if (influence.bone[i] == shown_.bone) weight += influence.weight[i];  // unused entries have weight 0
    return {(weight * 255 + kFullWeight / 2) / kFullWeight, weight == 0 ? 255 : 0, weight == kFullWeight ? 255 : 0,
            255};
  }
  static glm::u8vec4 of_colour(const glm::vec3& colour) {
    return {glm::u8vec3(glm::clamp(colour, 0.0f, 1.0f) * 255.0f + 0.5f), 255};
  }

  const ShownWeights& shown_;
  std::vector<glm::vec3> swatches_;
};

using Box = TexelBox;
using Part = WeightTexture::Part;

Box intersection(const Box& a, const Box& b) { return {glm::max(a.low, b.low), glm::min(a.high, b.high)}; }

Box box_of(const TissueVoxels::Brick& brick, int halvings) {
  const glm::ivec3 last = brick.corner + (TissueVoxels::kBrick - 1);
  return {(brick.corner >> halvings) + kPad, (last >> halvings) + kPad + 1};
}
Box grown(const Box& box) { return {box.low - 1, box.high + 1}; }
// Returns the box of a block and of the kApron voxels around it, which are stored with the block.
Box box_of_block(const glm::ivec3& block) { return {block * kBlock - kApron, (block + 1) * kBlock + kApron}; }

std::vector<Part> parts_of(const BlockLayout& layout, const TissueVoxels& tissue,
                           const std::vector<std::uint8_t>& changed, int halvings) {
  std::vector<Box> boxes(layout.block_of_slot.size());
  for (std::size_t b = 0; b < changed.size(); ++b) {
    if (!changed[b]) continue;
    // The box is grown by one voxel, since air voxels beside tissue get the tissue's colour.
    const Box brick = grown(box_of(tissue.bricks()[b], halvings));
    const glm::ivec3 first = glm::max((brick.low - kApron) >> 5, glm::ivec3(0)),
                     last = glm::min((brick.high - 1 + kApron) >> 5, layout.blocks - 1);
    for (int z = first.z; z <= last.z; ++z)
      for (int y = first.y; y <= last.y; ++y)
        for (int x = first.x; x <= last.x; ++x) {
          const glm::ivec3 block(x, y, z);
          const int slot = layout.slot_of_block[static_cast<std::size_t>(layout.block_index(block))];
          if (slot >= 0) boxes[static_cast<std::size_t>(slot)].add(intersection(brick, box_of_block(block)));
        }
  }
  std::vector<Part> parts;
  for (std::size_t slot = 0; slot < boxes.size(); ++slot)
    if (!boxes[slot].empty()) parts.push_back({static_cast<int>(slot), boxes[slot]});
  return parts;
}
static_assert(kBlock == 1 << 5);

// Gives air voxels beside tissue the mean colour of the tissue beside them, axis by axis. The tissue's colour is then
// also found by texture reads a little outside the tissue, and by filtered reads.
class SpreadIntoAir {
 public:
  SpreadIntoAir(std::vector<glm::u8vec4>& texels, const glm::ivec3& size) : texels_(texels) {
    const std::array<std::ptrdiff_t, 3> stride = {1, size.x, std::ptrdiff_t{size.x} * size.y};
    for (int axis = 0; axis < 3; ++axis) {
      for (int z = 0; z < size.z; ++z)
        for (int y = 0; y < size.y; ++y) {
          const std::ptrdiff_t row = y * stride[1] + z * stride[2];
          if (axis > 0) {
            const int place = axis == 1 ? y : z;
            look_at(row, size.x, place > 0 ? -stride[axis] : 0, place + 1 < size[axis] ? stride[axis] : 0);
          } else if (size.x > 1) {
            look_at(row, 1, 0, 1);
            look_at(row + 1, size.x - 2, -1, 1);
            look_at(row + size.x - 1, 1, -1, 0);
          }
        }
      for (const auto& [at, texel] : found_) texels[static_cast<std::size_t>(at)] = texel;
      found_.clear();
    }
  }

 private:
  // Collects the new colours of the air texels in a row.
  //   back, on  offsets in the array to the texels before and behind along the axis; 0: there is no such texel
  void look_at(std::ptrdiff_t row, int count, std::ptrdiff_t back, std::ptrdiff_t on) {
    const glm::u8vec4* texel = texels_.data() + row;
    for (int x = 0; x < count; ++x, ++texel) {
      if (texel->a != 0) continue;
      // If the offset is 0, the texel itself is read. It is air, so it adds no colour.
      const glm::u8vec4 before = texel[back], after = texel[on];
      if ((before.a | after.a) == 0) continue;
      found_.push_back({row + x, before.a == 0  ? after
                                 : after.a == 0 ? before
                                                : glm::u8vec4((glm::ivec4(before) + glm::ivec4(after)) / 2)});
    }
  }

  std::vector<glm::u8vec4>& texels_;
  std::vector<std::pair<std::ptrdiff_t, glm::u8vec4>> found_;
};

// Computes the texels of a box. Texels of air are 0. If the volume is drawn at a coarser resolution, a texel shows one
// of the tissue voxels that it covers.
std::vector<glm::u8vec4> texels_of_tissue(const Box& box, const ShownWeights& shown, const Texels& texels,
                                          int halvings) {
  const glm::ivec3 size = box.size();
  std::vector<glm::u8vec4> result(static_cast<std::size_t>(size.x) * size.y * size.z, glm::u8vec4(0));
  const TissueVoxels& tissue = *shown.tissue;
  const glm::ivec3 low = glm::max((box.low - kPad) << halvings, glm::ivec3(0)),
                   high = glm::min((box.high - kPad) << halvings, tissue.grid_size());
  for (int z = low.z & ~7; z < high.z; z += TissueVoxels::kBrick)
    for (int y = low.y & ~7; y < high.y; y += TissueVoxels::kBrick)
      for (int x = low.x & ~7; x < high.x; x += TissueVoxels::kBrick) {
        const int brick = tissue.brick_at({x, y, z});
        if (brick < 0) continue;
        const SkinWeights::Chunk* chunk = shown.field ? nullptr : &shown.weights->chunk(brick);
        const std::int64_t first = tissue.bricks()[static_cast<std::size_t>(brick)].first;
        tissue.for_each(brick, brick + 1, [&](std::int64_t place, const glm::ivec3& voxel) {
          const glm::ivec3 at = (voxel >> halvings) + kPad - box.low;
          if (glm::any(glm::lessThan(at, glm::ivec3(0))) || glm::any(glm::greaterThanEqual(at, size))) return;
          glm::u8vec4& texel = result[(static_cast<std::size_t>(at.z) * size.y + at.y) * size.x + at.x];
          texel = chunk ? texels.of((*chunk)[static_cast<std::size_t>(place - first)])
                        : glm::u8vec4((*shown.field)[static_cast<std::size_t>(place)], 255);
          if (shown.region && (*shown.region)[static_cast<std::size_t>(place)])
            texel = glm::u8vec4((glm::ivec4(texel) + 1) / 2);
        });
      }
  return result;
}

std::vector<glm::u8vec4> texels_of(const Box& box, const ShownWeights& shown, const Texels& texels, int halvings) {
  const Box around = grown(box);
  std::vector<glm::u8vec4> large = texels_of_tissue(around, shown, texels, halvings);
  SpreadIntoAir(large, around.size());
  const glm::ivec3 size = box.size(), room = around.size();
  std::vector<glm::u8vec4> result;
  result.reserve(static_cast<std::size_t>(size.x) * size.y * size.z);
  for (int z = 1; z <= size.z; ++z)
    for (int y = 1; y <= size.y; ++y) {
      const auto row = large.begin() + (std::ptrdiff_t{z} * room.y + y) * room.x + 1;
      result.insert(result.end(), row, row + size.x);
    }
  return result;
}

// Computes the texels of each box in `parts` and stores them there. Returns `parts`.
std::vector<Part> worked_out(std::vector<Part> parts, const ShownWeights& shown, int halvings) {
  const Texels texels(shown);
  parallel_for(std::ssize(parts), 1, [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t i = begin; i < end; ++i) {
      Part& part = parts[static_cast<std::size_t>(i)];
      part.texels = texels_of(part.box, shown, texels, halvings);
    }
  });
  return parts;
}

bool holds(const SkinWeights::Chunk& chunk, int bone, int other) {
  return std::any_of(chunk.begin(), chunk.end(), [&](const Influence& influence) {
    bool any = false;
    for (int i = 0; i < 4; ++i)
      any |= influence.weight[i] > 0 && (influence.bone[i] == bone || influence.bone[i] == other);
    return any;
  });
}

std::string hex_vec3(const glm::vec3& colour) {
  return "vec3(" + std::to_string(colour.r) + ", " + std::to_string(colour.g) + ", " + std::to_string(colour.b) + ")";
}

}  // namespace

WeightTexture::WeightTexture(const VolumeTexture& volume) : index_(gl::Texture::create()) {
  const std::size_t slots = volume.layout().block_of_slot.size();
  waiting_.resize(slots);
  edited_.resize(slots);
  present_.resize(slots);
  const glm::ivec3 size = volume.layout().slots * kSlot;
  for (int a = 0; a < volume.layout().atlases; ++a) {
    atlases_.push_back(gl::Texture::create());
    if (!allocate(atlases_.back(), size, kTexels))
      throw Error("the weights cannot be shown: the graphics driver has no room for them", "skin weights",
                  "show the tissues, or re-grid the volume with a larger spacing");
    bytes_ += std::int64_t{size.x} * size.y * size.z * 4;
  }
}

bool WeightTexture::region_differs(const ShownWeights& shown, std::int64_t brick) const {
  if (shown.region == shown_->region) return false;
  const std::int64_t first = shown.tissue->bricks()[static_cast<std::size_t>(brick)].first,
                     end = first + std::ssize(shown.weights->chunk(brick));
  for (std::int64_t place = first; place < end; ++place) {
    const std::size_t at = static_cast<std::size_t>(place);
    if ((shown.region && (*shown.region)[at]) != (shown_->region && (*shown_->region)[at])) return true;
  }
  return false;
}

bool WeightTexture::means_the_same(const ShownWeights& shown) const {
  return shown_ && !shown.field && !shown_->field && shown.tissue == shown_->tissue &&
         shown.display == shown_->display && shown.swatches == shown_->swatches &&
         shown.weights->chunk_count() == shown_->weights->chunk_count();
}

std::vector<std::uint8_t> WeightTexture::changed_bricks(const ShownWeights& shown) const {
  const std::int64_t bricks = std::ssize(shown.tissue->bricks());
  std::vector<std::uint8_t> changed(static_cast<std::size_t>(bricks));
  const bool other_bone = shown.bone != shown_->bone && shown.display != WeightDisplay::Count;
  parallel_for(bricks, 256, [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t b = begin; b < end; ++b)
      changed[static_cast<std::size_t>(b)] = shown.weights->shared_chunk(b) != shown_->weights->shared_chunk(b) ||
                                             region_differs(shown, b) ||
                                             (other_bone && holds(shown.weights->chunk(b), shown.bone, shown_->bone));
  });
  return changed;
}

void WeightTexture::change_to(const VolumeTexture& volume, const ShownWeights& shown) {
  if ((shown.display == WeightDisplay::Field) != (shown.field != nullptr))
    throw std::logic_error("a field has colours, weights have none");
  if (shown.field ? std::ssize(*shown.field) != shown.tissue->size()
                  : shown.weights->size() != shown.tissue->size() ||
                        shown.weights->chunk_count() != std::ssize(shown.tissue->bricks()))
    throw std::logic_error("the weights are another volume's");
  if (shown.region && std::ssize(*shown.region) != shown.tissue->size())
    throw std::logic_error("the region is another volume's");
  const BlockLayout& layout = volume.layout();
  std::vector<Part> parts;
  if (means_the_same(shown)) {
    parts = parts_of(layout, *shown.tissue, changed_bricks(shown), volume.halvings());
  } else {
    for (int slot = 0; slot < std::ssize(layout.block_of_slot); ++slot)
      parts.push_back({slot, box_of_block(layout.block_of_slot[static_cast<std::size_t>(slot)])});
    present_.assign(present_.size(), 0);
    if (!upload_index(index_, layout, present_))
      throw Error("the weights cannot be shown", "skin weights", "show the tissues");
  }
  shown_ = shown;
  ++edits_;
  std::int64_t texels = 0;
  for (const Part& part : parts) {
    edited_[static_cast<std::size_t>(part.slot)] = edits_;
    texels += part.box.texels();
  }
  if (texels <= kAtOnce) return upload(volume, worked_out(std::move(parts), shown, volume.halvings()));
  for (const Part& part : parts) {
    Box& waiting = waiting_[static_cast<std::size_t>(part.slot)];
    waiting_count_ += waiting.empty();
    waiting.add(part.box);
  }
}

void WeightTexture::begin_lot(const VolumeTexture& volume) {
  if (waiting_count_ == 0) return;
  std::vector<Part> parts;
  for (std::size_t slot = 0; slot < waiting_.size(); ++slot)
    if (!waiting_[slot].empty()) parts.push_back({static_cast<int>(slot), waiting_[slot]});
  const auto is_cut = [this](const Part& part) {
    for (int axis = 0; axis < 3; ++axis)
      if (const auto& at = cuts_[static_cast<std::size_t>(axis)];
          at && *at >= float(part.box.low[axis]) && *at <= float(part.box.high[axis]))
        return true;
    return false;
  };
  const auto rank = [&](const Part& part) {
    return std::tuple(-edited_[static_cast<std::size_t>(part.slot)], !is_cut(part), part.slot);
  };
  const std::size_t count = std::min<std::size_t>(kLot, parts.size());
  std::partial_sort(parts.begin(), parts.begin() + std::ptrdiff_t(count), parts.end(),
                    [&](const Part& a, const Part& b) { return rank(a) < rank(b); });
  parts.resize(count);
  lot_edit_ = edits_;
  lot_ = std::async(std::launch::async, [parts, shown = *shown_, halvings = volume.halvings()] {
    return worked_out(parts, shown, halvings);
  });
}

void WeightTexture::take_over(const VolumeTexture& volume, UploadTime* time) {
  for (;;) {
    if (!lot_.valid()) begin_lot(volume);
    if (!lot_.valid()) return;
    if (time && time->used &&
        (std::chrono::steady_clock::now() >= time->until || lot_.wait_until(time->until) != std::future_status::ready))
      return;
    std::vector<Part> parts = lot_.get();
    if (time) time->used = true;
    // A slot (a stored block of voxels) whose weights were edited while its texels were computed keeps waiting, since
    // these texels are out of date.
    std::erase_if(parts, [this](const Part& part) { return edited_[static_cast<std::size_t>(part.slot)] > lot_edit_; });
    for (const Part& part : parts) waiting_[static_cast<std::size_t>(part.slot)] = {};
    waiting_count_ -= static_cast<int>(parts.size());
    begin_lot(volume);
    upload(volume, parts);
  }
}

void WeightTexture::upload(const VolumeTexture& volume, const std::vector<Part>& parts) {
  if (parts.empty()) return;
  const BlockLayout& layout = volume.layout();
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  Box whole;
  bool more_present = false;
  for (const auto& [slot, box, texels] : parts) {
    const glm::ivec3 at = layout.place_of(slot) * kSlot + box.low -
                          box_of_block(layout.block_of_slot[static_cast<std::size_t>(slot)]).low,
                     size = box.size();
    glBindTexture(GL_TEXTURE_3D, atlases_[static_cast<std::size_t>(layout.atlas_of(slot))].name());
    glTexSubImage3D(GL_TEXTURE_3D, 0, at.x, at.y, at.z, size.x, size.y, size.z, kTexels.pixels, kTexels.type,
                    texels.data());
    texels_uploaded_ += box.texels();
    whole.add(box);
    std::uint8_t& present = present_[static_cast<std::size_t>(slot)];
    if (present || !waiting_[static_cast<std::size_t>(slot)].empty()) continue;
    present = 1;
    more_present = true;
  }
  gl::check_gl("the upload of weights");
  if (more_present && !upload_index(index_, layout, present_))
    throw Error("the weights cannot be shown", "skin weights", "show the tissues");
  ++changes_;
  last_changes_.push_back(grown(whole));  // grown by one texel, since filtered reads reach one texel further
  if (last_changes_.size() > kRemembered) last_changes_.pop_front();
}

void WeightTexture::update(const VolumeTexture& volume, const ShownWeights& shown, UploadTime* time) {
  texels_uploaded_ = 0;
  ShownWeights now = shown;
  now.contours = true;  // contours do not affect the texels
  try {
    if (shown_ != now) change_to(volume, now);
    take_over(volume, time);
  } catch (...) {
    shown_.reset();  // the next update uploads everything again
    throw;
  }
}

std::optional<TexelBox> WeightTexture::changed_since(int count) const {
  if (changes_ - count > std::ssize(last_changes_)) return std::nullopt;
  Box box;
  for (auto change = last_changes_.end() - (changes_ - count); change != last_changes_.end(); ++change)
    box.add(*change);
  return box;
}

int WeightTexture::bind(const VolumeTexture& volume, gl::Program& program, int first) const {
  first = bind_atlases(program, "u_weights", atlases_, first);
  program.set_texture("u_weight_index", first++, GL_TEXTURE_3D, index_.name());
  program.set("u_weight_texel", 1.0f / glm::vec3(volume.layout().slots * kSlot));
  program.set("u_weight_blocks", volume.layout().blocks);
  program.set("u_weight_region", shown_->region ? 1 : 0);
  return first;
}

WeightReading reading_of(WeightDisplay display) {
  return display == WeightDisplay::Active                                     ? WeightReading::Ramp
         : display == WeightDisplay::Mixed || display == WeightDisplay::Field ? WeightReading::Filtered
                                                                              : WeightReading::Voxels;
}

std::string weight_defines(int atlases, WeightReading reading) {
  const char* const name = reading == WeightReading::Ramp       ? "RAMP"
                           : reading == WeightReading::Filtered ? "FILTERED"
                                                                : "VOXELS";
  std::string ramp;
  for (const glm::vec3& colour : kWeightRamp) ramp += (ramp.empty() ? "" : ", ") + hex_vec3(colour);
  return atlas_defines(atlases) + gl::define(name) + gl::define("RAMP_COLOURS", ramp) +
         gl::define("EXACT_ZERO", hex_vec3(kExactZero)) + gl::define("EXACT_ONE", hex_vec3(kExactOne));
}

}  // namespace limber::render
