// SPDX-License-Identifier: AGPL-3.0-or-later
// What is shown of skin weights, on the card: four bytes a voxel in atlases laid out like the volume's labels
// (brick_atlas.h), so that a place is found by the labels' own index, and filtered reads go smoothly from voxel to
// voxel.
//
// A texel holds what the display asks for, worked out here from the whole numbers: of the active bone its weight in 8
// bits, whether that is exactly 0, whether it is exactly 1; else a colour. The last channel says that there is tissue,
// so that what is filtered counts tissue alone: (weight, is 0, is 1, 1) or (colour, 1), and zeros in air; air beside
// tissue is coloured like it, for what is read on the surface. Within a region all four are half of that, so that
// outside of it colours can be dull while only the bricks of the region are uploaded. The arm of 646 912 tissue voxels
// takes twice as much as its labels.
//
// Weights share the bricks that are equal in both, and only bricks that differ from what is there are uploaded; another
// active bone uploads the bricks in which the old or the new one occurs.
//
// A change of little, as a brush makes it, is there when update() returns. Of more the slots wait in a line: their
// texels are worked out beside, some slots at a time, from the newest weights, and each update() takes over what is
// ready as long as it has time. The latest change comes first, and of it what a slice cuts. A slot that waits shows
// what was there before, or the tissue where its old texels would mean something else (another display, other
// swatches).
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <deque>
#include <future>
#include <optional>
#include <string>
#include <vector>

#include "render/gl/object.h"
#include "render/gl/program.h"
#include "render/scene/scene.h"
#include "render/textures/volume_texture.h"

namespace limber::render {

// How a display is read: as a ramp of filtered weights, filtered colours, or the colours of voxels. Programs are made
// for each, since a software driver follows every branch.
enum class WeightReading { Ramp, Filtered, Voxels };
WeightReading reading_of(WeightDisplay display);

// Padded coordinates, half open.
struct TexelBox {
  glm::ivec3 low{1 << 30}, high{-(1 << 30)};
  bool empty() const { return glm::any(glm::greaterThanEqual(low, high)); }
  void add(const TexelBox& other) { low = glm::min(low, other.low), high = glm::max(high, other.high); }
  glm::ivec3 size() const { return high - low; }
  std::int64_t texels() const { return empty() ? 0 : std::int64_t{size().x} * size().y * size().z; }
};

// What all uploads of a frame may take together. At least one lot of slots is taken over, however long that lasts.
struct UploadTime {
  std::chrono::steady_clock::time_point until;
  bool used = false;  // something was taken over
};

class WeightTexture {
 public:
  static constexpr std::int64_t kAtOnce =
      8 * kSlot * kSlot * kSlot;   // texels of a change of little: some 2 ms on two cores
  static constexpr int kLot = 16;  // slots worked out together: 3 MB

  // Throws Error when the driver has no room for it.
  explicit WeightTexture(const VolumeTexture& volume);

  // Without a time until all is there. Throws std::logic_error if weights or tissue are another volume's.
  void update(const VolumeTexture& volume, const ShownWeights& shown, UploadTime* time = nullptr);
  bool complete() const { return waiting_count_ == 0; }
  // A slice shows this plane across an axis of padded coordinates.
  void prefer(int axis, float at) { cuts_[static_cast<std::size_t>(axis)] = at; }

  // How many changes there were, and the box in which those after the first `count` lie; nothing: it may be everywhere.
  int changes() const { return changes_; }
  std::optional<TexelBox> changed_since(int count) const;
  std::int64_t texels_uploaded() const { return texels_uploaded_; }  // by the last update
  std::int64_t bytes() const { return bytes_; }

  WeightReading reading() const { return reading_of(shown_->display); }
  // The uniforms of shaders/weights.glsl; returns the next free unit.
  int bind(const VolumeTexture& volume, gl::Program& program, int first) const;

  // What is to be uploaded of a slot, and its texels.
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
  gl::Texture index_;                  // the volume's, of the slots that are there
  std::optional<ShownWeights> shown_;  // what is there, or will be once nothing waits
  int edits_ = 0;                      // how often it was another

  // By slot.
  std::vector<TexelBox> waiting_;      // what is not there yet
  std::vector<int> edited_;            // the last edit that changed it
  std::vector<std::uint8_t> present_;  // its texels mean what is shown
  int waiting_count_ = 0;
  std::array<std::optional<float>, 3> cuts_;
  std::future<std::vector<Part>> lot_;  // being worked out, as of edit lot_edit_
  int lot_edit_ = 0;

  int changes_ = 0;
  std::deque<TexelBox> last_changes_;
  std::int64_t texels_uploaded_ = 0, bytes_ = 0;
};

// The definitions that shaders/weights.glsl needs, those of atlas_defines() among them.
std::string weight_defines(int atlases, WeightReading reading);

}  // namespace limber::render
