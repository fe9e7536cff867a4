// SPDX-License-Identifier: AGPL-3.0-or-later
// Stores the label volumes of an undo history compactly. Each stroke of a label brush makes a whole new volume; at a
// spacing of 2 mm, a handful of whole-body volumes would fill the memory for undo. So a step's volume may be packed:
// the step's document then has no volume, and only the voxels that differ from the volume of a neighbouring step are
// stored (LabelChange). Unpacking gives the same labels bit for bit, and the same object if something else still holds
// it.
//
// Two neighbouring steps are linked if their volumes are equal or differ by a known change. In each group of linked
// steps at least one step keeps its volume, from which the others are computed.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "core/label_edit/label_change.h"
#include "core/project/history.h"

namespace limber {

class PackedVolumes {
 public:
  using Steps = std::vector<History::Step>;
  // Sets the volume of a step's document and updates the count of the document's memory.
  using SetVolume = std::function<void(Document& document, std::shared_ptr<const LabelVolume> volume)>;

  // Smallest volume that is packed, bytes; smaller ones save too little.
  static constexpr std::int64_t kLeastBytes = std::int64_t{1} << 20;

  // Changes the number of steps to `count`: removes steps at the end, or adds new ones there. First unpacks a volume if
  // the remaining steps need it.
  void resize(Steps& steps, std::int64_t count, const SetVolume& set);
  // Removes the first `count` steps. First unpacks a volume if the remaining steps need it.
  void erase_front(Steps& steps, std::int64_t count, const SetVolume& set);
  // Removes the links of a step to its neighbours. Call this before the step's volume is replaced.
  void unlink(Steps& steps, std::int64_t step, const SetVolume& set);

  // Packs the volume of the step farthest from the current one. Returns false if no further volume can be packed.
  bool pack(Steps& steps, std::int64_t current, const SetVolume& set);
  // Computes the volume of a packed step and puts it back into the step's document.
  void unpack(Steps& steps, std::int64_t step, const SetVolume& set);

  std::int64_t bytes() const;  // size of the stored changes

 private:
  // The difference between the label volume after a step of the undo history and the one after the previous step.
  struct Link {
    bool same = false;
    std::shared_ptr<const LabelChange> change;
    bool impossible = false;  // true: the volumes are too different, or have other grids
    bool linked() const { return same || change; }
  };
  struct Packed {
    std::weak_ptr<const LabelVolume> volume;
  };

  bool link(const Steps& steps, std::int64_t step);
  bool has_volume_left(std::int64_t step, std::int64_t first) const;
  bool has_volume_right(std::int64_t step, std::int64_t end) const;

  std::vector<Link> links_;                    // for each step, the link to the step before
  std::vector<std::optional<Packed>> packed_;  // for each step, its packed volume; empty: not packed
};

}  // namespace limber
