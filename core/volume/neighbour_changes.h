// SPDX-License-Identifier: AGPL-3.0-or-later
// Tells a grey image from labels by its voxels: a label reaches over several voxels, but the grey values of two
// neighbours are mostly not the same.
#pragma once

#include <cstddef>
#include <cstdint>

#include "core/volume/label_volume.h"

namespace limber {

// Counts how often two neighbours along x, both tissue, differ. Voxels are added in storage order, in parts of any
// length.
class NeighbourChanges {
 public:
  explicit NeighbourChanges(int row_length) : row_length_(row_length) {}

  void add(const Label* labels, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) {
      if (in_row_ > 0 && labels[i] != 0 && before_ != 0) {
        ++pairs_;
        changes_ += labels[i] != before_;
      }
      before_ = labels[i];
      if (++in_row_ == row_length_) in_row_ = 0;
    }
  }
  // Of those pairs, [0, 1]. Label volumes have a few percent, grey images most.
  double share() const { return pairs_ ? double(changes_) / double(pairs_) : 0; }
  // Atlases of a body have up to some 500 labels and differ at a tenth of their faces; a CT has 250 values and more and
  // differs at nine tenths. Few labels that lie finely mixed are no image.
  //   labels  how many there are
  bool looks_grey(std::size_t labels) const { return may_be_grey(labels) && share() > kMostlyDiffers; }
  // Whether there are enough of them for a grey image.
  static bool may_be_grey(std::size_t labels) { return labels >= kManyLabels; }

 private:
  static constexpr std::size_t kManyLabels = 64;
  static constexpr double kMostlyDiffers = 0.5;
  int row_length_, in_row_ = 0;
  Label before_ = 0;
  std::int64_t pairs_ = 0, changes_ = 0;
};

}  // namespace limber
