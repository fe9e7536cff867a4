// SPDX-License-Identifier: AGPL-3.0-or-later
// Tells a grey image from a label volume by its voxels: a label covers several neighbouring voxels, but the grey values
// of two neighbours mostly differ.
#pragma once

#include <cstddef>
#include <cstdint>

#include "core/volume/label_volume.h"

namespace limber {

// Counts the pairs of neighbouring tissue voxels along x, and among them the pairs whose labels differ. Voxels are
// added in the order in which a volume stores them, in blocks of any length.
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
  // Returns the share of the pairs whose labels differ, [0, 1]: a few percent in label volumes, most in grey images.
  double share() const { return pairs_ ? double(changes_) / double(pairs_) : 0; }
  // Returns whether the volume looks like a grey image. Atlases of a body have up to some 500 labels, and a tenth of
  // their neighbour pairs differ. A CT has 250 values or more, and nine tenths of its pairs differ. A volume of few
  // labels is no grey image, however finely the labels are mixed.
  //   labels  number of distinct labels
  bool looks_grey(std::size_t labels) const { return may_be_grey(labels) && share() > kMostlyDiffers; }
  // Returns true if a volume with `labels` distinct labels has enough distinct values to be a grey image.
  static bool may_be_grey(std::size_t labels) { return labels >= kManyLabels; }

 private:
  static constexpr std::size_t kManyLabels = 64;
  static constexpr double kMostlyDiffers = 0.5;
  int row_length_, in_row_ = 0;
  Label before_ = 0;
  std::int64_t pairs_ = 0, changes_ = 0;
};

}  // namespace limber
