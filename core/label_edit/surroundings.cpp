// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/label_edit/surroundings.h"

#include <algorithm>
#include <array>

namespace limber {

namespace {

enum State : std::uint8_t {
  kSettled,  // the voxel has another label, or was filled; its label counts for its neighbours
  kKept,     // the voxel has the erased label and keeps it
  kPending,  // the voxel is still to be filled
  kQueued,   // the voxel is still to be filled, and is in the list of the current layer
};

// The labels in the bounding box of the pending voxels, enlarged by one voxel on each side within the grid.
struct Window {
  VoxelBox box;
  std::vector<Label> labels;
  std::vector<std::uint8_t> state;

  Window(const LabelVolume& volume, const std::vector<std::int64_t>& voxels, Label label) {
    const glm::ivec3 size = volume.grid.size;
    glm::ivec3 low = size, high(-1);
    for (const std::int64_t voxel : voxels) {
      const glm::ivec3 at = place_of(voxel, size);
      low = glm::min(low, at), high = glm::max(high, at);
    }
    low = glm::max(low - 1, glm::ivec3(0)), high = glm::min(high + 1, size - 1);
    box = {low, high - low + 1};
    labels.resize(static_cast<std::size_t>(box.voxel_count()));
    state.resize(labels.size());
    for (int z = low.z; z <= high.z; ++z)
      for (int y = low.y; y <= high.y; ++y) {
        const Label* row = &volume.voxels[volume.grid.index({low.x, y, z})];
        const auto to = static_cast<std::size_t>(box.index({low.x, y, z}));
        std::copy(row, row + box.size.x, labels.begin() + static_cast<std::ptrdiff_t>(to));
        for (std::size_t x = 0; x < static_cast<std::size_t>(box.size.x); ++x)
          state[to + x] = row[x] == label ? kKept : kSettled;
      }
    for (const std::int64_t voxel : voxels)
      state[static_cast<std::size_t>(box.index(place_of(voxel, size)))] = kPending;
  }

  static glm::ivec3 place_of(std::int64_t voxel, const glm::ivec3& size) {
    return {voxel % size.x, voxel / size.x % size.y, voxel / (std::int64_t{size.x} * size.y)};
  }
  glm::ivec3 place_of(std::int64_t at) const { return box.lowest + place_of(at, box.size); }

  // Calls act(index, shares_a_face) for each of the 26 neighbours inside the window.
  template <class Act>
  void for_neighbours(std::int64_t at, const Act& act) const {
    const glm::ivec3 here = place_of(at);
    for (int z = -1; z <= 1; ++z)
      for (int y = -1; y <= 1; ++y)
        for (int x = -1; x <= 1; ++x) {
          const glm::ivec3 there = here + glm::ivec3(x, y, z);
          if ((x || y || z) && box.contains(there)) act(box.index(there), std::abs(x) + std::abs(y) + std::abs(z) == 1);
        }
  }
};

// Counts how often each label occurs among up to 26 neighbours.
class Votes {
 public:
  void add(Label label, bool face) {
    for (int i = 0; i < count_; ++i)
      if (labels_[i] == label) {
        rank_[i] += face ? kWhole + 1 : kWhole;
        return;
      }
    labels_[count_] = label;
    rank_[count_++] = face ? kWhole + 1 : kWhole;
  }
  bool any() const { return count_ > 0; }
  Label most() const {
    int best = 0;
    for (int i = 1; i < count_; ++i)
      if (rank_[i] > rank_[best] || (rank_[i] == rank_[best] && labels_[i] < labels_[best])) best = i;
    return labels_[best];
  }

 private:
  // Each neighbour adds this number to its label, and 1 more if it shares a face with the voxel. The number exceeds 6,
  // so shared faces decide only between labels with equally many neighbours.
  static constexpr int kWhole = 32;
  std::array<Label, 26> labels_{};
  std::array<int, 26> rank_{};
  int count_ = 0;
};

}  // namespace

LabelChange filled_from_around(const LabelVolume& volume, const std::vector<std::int64_t>& voxels, Label label) {
  LabelChange change;
  if (voxels.empty()) return change;
  Window window(volume, voxels, label);
  const auto touches_settled = [&](std::int64_t at) {
    bool any = false;
    window.for_neighbours(at,
                          [&](std::int64_t n, bool) { any |= window.state[static_cast<std::size_t>(n)] == kSettled; });
    return any;
  };
  std::vector<std::int64_t> layer, next;
  for (const std::int64_t voxel : voxels) {
    const std::int64_t at = window.box.index(Window::place_of(voxel, volume.grid.size));
    if (!touches_settled(at)) continue;
    layer.push_back(at);
    window.state[static_cast<std::size_t>(at)] = kQueued;
  }
  std::vector<Label> filled;
  while (!layer.empty()) {
    filled.clear();
    for (const std::int64_t at : layer) {
      Votes votes;
      window.for_neighbours(at, [&](std::int64_t n, bool face) {
        if (window.state[static_cast<std::size_t>(n)] == kSettled)
          votes.add(window.labels[static_cast<std::size_t>(n)], face);
      });
      filled.push_back(votes.most());
    }
    for (std::size_t i = 0; i < layer.size(); ++i) {
      window.labels[static_cast<std::size_t>(layer[i])] = filled[i];
      window.state[static_cast<std::size_t>(layer[i])] = kSettled;
    }
    next.clear();
    for (const std::int64_t at : layer)
      window.for_neighbours(at, [&](std::int64_t n, bool) {
        std::uint8_t& state = window.state[static_cast<std::size_t>(n)];
        if (state != kPending) return;
        state = kQueued;
        next.push_back(n);
      });
    std::swap(layer, next);
  }
  for (const std::int64_t voxel : voxels) {
    const auto at = static_cast<std::size_t>(window.box.index(Window::place_of(voxel, volume.grid.size)));
    change.add(voxel, label, window.state[at] == kSettled ? window.labels[at] : Label{0});
  }
  return change;
}

LabelChange erased_voxels(const LabelVolume& volume, const std::vector<std::int64_t>& voxels, Label label,
                          Erased erased) {
  if (erased == Erased::Surroundings) return filled_from_around(volume, voxels, label);
  LabelChange change;
  for (const std::int64_t voxel : voxels) change.add(voxel, label, 0);
  return change;
}

}  // namespace limber
