// SPDX-License-Identifier: AGPL-3.0-or-later
// Keeps the label volumes of an undo history in memory that grows with what edits changed. Each stroke of a label brush
// makes a whole new volume; of a body at 2 mm, a handful would fill the memory for undo. So a step's volume may be
// packed: the step's document has no volume then, and only the voxels that differ from the neighbouring step's are kept
// (LabelChange). Unpacking gives the same labels bit for bit, and the same object as long as something else holds it.
//
// Steps whose volumes are the same or differ by a known change are linked. Of each group of linked steps, at least one
// has its volume.
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
  // Replaces the volume of a step's document, and counts the document's memory again.
  using SetVolume = std::function<void(Document& document, std::shared_ptr<const LabelVolume> volume)>;

  // Volumes smaller than this are not worth packing, bytes.
  static constexpr std::int64_t kLeastBytes = std::int64_t{1} << 20;

  // Forgets the last steps so that `count` are left, or knows of new steps at the end. What stays linked has a volume.
  void resize(Steps& steps, std::int64_t count, const SetVolume& set);
  // Forgets the first steps.
  void erase_front(Steps& steps, std::int64_t count, const SetVolume& set);
  // The volume of a step is about to be replaced by another one.
  void unlink(Steps& steps, std::int64_t step, const SetVolume& set);

  // Packs one more volume: that of the step farthest from the current one. Returns false if no other can be packed.
  bool pack(Steps& steps, std::int64_t current, const SetVolume& set);
  // Gives a step's document its volume back.
  void unpack(Steps& steps, std::int64_t step, const SetVolume& set);

  std::int64_t bytes() const;  // of the changes kept

 private:
  // How the volume of a step follows from that of the step before.
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

  std::vector<Link> links_;                    // one for each step
  std::vector<std::optional<Packed>> packed_;  // one for each step; empty: the step's document has its volume
};

}  // namespace limber
