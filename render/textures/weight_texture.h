// SPDX-License-Identifier: AGPL-3.0-or-later
// The shown skin weights on the graphics card: four bytes per voxel in atlases with the same layout as the volume's
// labels (brick_atlas.h). One computation therefore finds a position in both, and filtered reads are smooth from voxel
// to voxel.
//
// A texel has the values that the display needs, computed here from the exact weights. For the active bone these are
// its weight in 8 bits, whether it is exactly 0, and whether it is exactly 1. For other displays they are a colour. The
// last channel is 1 in tissue. Filtered values can be divided by it, so that only tissue counts. In tissue the texel is
// (weight, is 0, is 1, 1) or (colour, 1); in air it is zero. Air beside tissue is coloured like the tissue, for reads
// at the surface. Within a region all four channels are halved. Colours outside the region can then be dimmed although
// only the bricks of the region are uploaded. For an arm of 646 912 tissue voxels, the weights take twice as much
// memory as the labels.
//
// Old and new weights share the bricks that are equal, and only bricks that differ are uploaded. If another bone
// becomes active, the bricks in which the old or the new active bone has weight are uploaded.
//
// A small change, such as one by a brush, is uploaded before update() returns. The slots of a larger change wait: their
// texels are computed on another thread, some slots at a time, from the newest weights. Each update() uploads finished
// slots as long as it has time. The latest change comes first, and within it the slots that a slice cuts. A waiting
// slot shows its old weights. If its old texels have another meaning (another display, other swatches), the tissue's
// own colours are shown there.
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <future>
#include <optional>
#include <string>
#include <vector>

#include "render/gl/object.h"
#include "render/gl/program.h"
#include "render/scene/scene.h"
#include "render/textures/upload_time.h"
#include "render/textures/volume_texture.h"

namespace limber::render {

// How the shaders read a display: as a ramp of filtered weights, as filtered colours, or as the colours of single
// voxels. Each reading has its own shader program, since a software driver executes every branch.
enum class WeightReading { Ramp, Filtered, Voxels };
WeightReading reading_of(WeightDisplay display);

// A box of texels [low, high) in padded coordinates, which are voxel coordinates plus kPad (brick_atlas.h).
struct TexelBox {
  glm::ivec3 low{1 << 30}, high{-(1 << 30)};
  bool empty() const { return glm::any(glm::greaterThanEqual(low, high)); }
  void add(const TexelBox& other) { low = glm::min(low, other.low), high = glm::max(high, other.high); }
  glm::ivec3 size() const { return high - low; }
  std::int64_t texels() const { return empty() ? 0 : std::int64_t{size().x} * size().y * size().z; }
};

class WeightTexture {
 public:
  // Largest change that update() uploads at once, texels. It takes some 2 ms on two cores. Larger changes wait.
  static constexpr std::int64_t kAtOnce = 8 * kSlot * kSlot * kSlot;
  // Number of slots (stored blocks of voxels) that are computed together; their texels take 3 MB.
  static constexpr int kLot = 16;

  // Allocates textures for the volume's weights, but uploads nothing. Throws Error when the driver has no memory for
  // them.
  explicit WeightTexture(const VolumeTexture& volume);

  // Uploads changed weights: as many as `time` allows, or all if `time` is null. Throws std::logic_error if the weights
  // or the tissue belong to another volume.
  void update(const VolumeTexture& volume, const ShownWeights& shown, UploadTime* time = nullptr);
  bool complete() const { return waiting_count_ == 0; }
  // Gives priority to uploads of the slots that a slice cuts. The slice is the plane at position `at` of an axis, in
  // padded coordinates.
  void prefer(int axis, float at) { cuts_[static_cast<std::size_t>(axis)] = at; }

  // changes() returns the number of uploads so far. changed_since() returns the box that contains all uploads after the
  // first `count`. An empty optional means that the box is unknown, and changes may be anywhere.
  int changes() const { return changes_; }
  std::optional<TexelBox> changed_since(int count) const;
  std::int64_t texels_uploaded() const { return texels_uploaded_; }  // number of texels that the last update uploaded
  std::int64_t bytes() const { return bytes_; }

  WeightReading reading() const { return reading_of(shown_->display); }
  // Sets the uniforms that shaders/weights.glsl declares, with textures on the units from `first` on. Returns the next
  // free unit.
  int bind(const VolumeTexture& volume, gl::Program& program, int first) const;

  // A box to upload, which lies within one slot (a stored block of voxels), and its texels.
  struct Part {
    int slot;
    TexelBox box;
    std::vector<glm::u8vec4> texels = {};
  };

 private:
  bool means_the_same(const ShownWeights& shown) const;
  std::vector<std::uint8_t> changed_bricks(const ShownWeights& shown) const;
  bool region_differs(const ShownWeights& shown, std::int64_t brick) const;
  void change_to(const VolumeTexture& volume, const ShownWeights& shown);
  void take_over(const VolumeTexture& volume, UploadTime* time);
  void begin_lot(const VolumeTexture& volume);
  void upload(const VolumeTexture& volume, const std::vector<Part>& parts);

  std::vector<gl::Texture> atlases_;
  // Index texture in the format of VolumeTexture::index(). It lists only the slots (stored blocks) that present_ marks.
  gl::Texture index_;
  std::optional<ShownWeights> shown_;  // weights that are uploaded, or will be when all waiting slots are
  int edits_ = 0;                      // number of times that shown_ has changed

  // These vectors have one entry for each slot.
  std::vector<TexelBox> waiting_;      // box of the slot's texels that wait for their upload; empty: no texel waits
  std::vector<int> edited_;            // value of edits_ at the last edit that changed the slot
  std::vector<std::uint8_t> present_;  // 1 if the slot's texels were computed for the current display
  int waiting_count_ = 0;
  std::array<std::optional<float>, 3> cuts_;
  std::future<std::vector<Part>> lot_;  // slots that another thread computes, with the weights of edit lot_edit_
  int lot_edit_ = 0;

  int changes_ = 0;
  std::deque<TexelBox> last_changes_;
  std::int64_t texels_uploaded_ = 0, bytes_ = 0;
};

// Returns the preprocessor definitions that shaders/weights.glsl needs, including those of atlas_defines().
std::string weight_defines(int atlases, WeightReading reading);

}  // namespace limber::render
