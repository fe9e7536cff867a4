// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/project/packed_volumes.h"

#include <utility>

namespace limber {

namespace {

std::int64_t bytes_of(const LabelVolume& volume) {
  return static_cast<std::int64_t>(volume.voxels.size() * sizeof(Label));
}

}  // namespace

// Returns whether any step from `first` to `step` that is linked to `step` without a gap has its volume unpacked.
bool PackedVolumes::has_volume_left(std::int64_t step, std::int64_t first) const {
  for (;; --step) {
    if (!packed_[static_cast<std::size_t>(step)]) return true;
    if (step == first || !links_[static_cast<std::size_t>(step)].linked()) return false;
  }
}

// Returns whether any step from `step` to end - 1 that is linked to `step` without a gap has its volume unpacked.
bool PackedVolumes::has_volume_right(std::int64_t step, std::int64_t end) const {
  for (;; ++step) {
    if (!packed_[static_cast<std::size_t>(step)]) return true;
    if (step + 1 == end || !links_[static_cast<std::size_t>(step) + 1].linked()) return false;
  }
}

void PackedVolumes::resize(Steps& steps, std::int64_t count, const SetVolume& set) {
  if (count > 0 && count < std::ssize(packed_) && !has_volume_left(count - 1, 0)) unpack(steps, count - 1, set);
  links_.resize(static_cast<std::size_t>(count));
  packed_.resize(static_cast<std::size_t>(count));
}

void PackedVolumes::erase_front(Steps& steps, std::int64_t count, const SetVolume& set) {
  if (count == 0) return;
  if (count < std::ssize(packed_) && !has_volume_right(count, std::ssize(packed_))) unpack(steps, count, set);
  links_.erase(links_.begin(), links_.begin() + count);
  packed_.erase(packed_.begin(), packed_.begin() + count);
  if (!links_.empty()) links_.front() = {};
}

void PackedVolumes::unlink(Steps& steps, std::int64_t step, const SetVolume& set) {
  unpack(steps, step, set);
  if (step > 0 && links_[static_cast<std::size_t>(step)].linked() && !has_volume_left(step - 1, 0))
    unpack(steps, step - 1, set);
  const bool last = step + 1 == std::ssize(links_);
  if (!last && links_[static_cast<std::size_t>(step) + 1].linked() && !has_volume_right(step + 1, std::ssize(links_)))
    unpack(steps, step + 1, set);
  links_[static_cast<std::size_t>(step)] = {};
  if (!last) links_[static_cast<std::size_t>(step) + 1] = {};
}

// Stores how a step's volume differs from that of the step before. Returns false if the difference is not known.
bool PackedVolumes::link(const Steps& steps, std::int64_t step) {
  Link& link = links_[static_cast<std::size_t>(step)];
  if (link.linked()) return true;
  if (link.impossible || packed_[static_cast<std::size_t>(step)] || packed_[static_cast<std::size_t>(step) - 1])
    return false;
  const auto &before = steps[static_cast<std::size_t>(step) - 1].document.volume,
             &after = steps[static_cast<std::size_t>(step)].document.volume;
  if (before == after) return link.same = true;
  link.impossible = true;
  if (!before || !after || !(before->grid == after->grid)) return false;
  auto change = std::make_shared<const LabelChange>(label_difference(*before, *after));
  if (change->heap_bytes() > bytes_of(*before) / 4) return false;
  link.impossible = false;
  link.change = std::move(change);
  return true;
}

bool PackedVolumes::pack(Steps& steps, std::int64_t current, const SetVolume& set) {
  const std::int64_t count = std::ssize(steps), reach = std::max(current, count - 1 - current);
  for (std::int64_t away = reach; away > 0; --away)
    for (const std::int64_t step : {current - away, current + away}) {
      if (step < 0 || step >= count || packed_[static_cast<std::size_t>(step)]) continue;
      Document& document = steps[static_cast<std::size_t>(step)].document;
      if (!document.volume || bytes_of(*document.volume) < kLeastBytes) continue;
      if (!link(steps, step < current ? step + 1 : step)) continue;
      packed_[static_cast<std::size_t>(step)] = Packed{document.volume};
      // Keeps the volume unpacked if it is the last unpacked one of its group of linked steps.
      if (!has_volume_left(step, 0) && !has_volume_right(step, count)) {
        packed_[static_cast<std::size_t>(step)].reset();
        continue;
      }
      set(document, nullptr);
      return true;
    }
  return false;
}

void PackedVolumes::unpack(Steps& steps, std::int64_t step, const SetVolume& set) {
  if (!packed_[static_cast<std::size_t>(step)]) return;
  std::shared_ptr<const LabelVolume> volume = packed_[static_cast<std::size_t>(step)]->volume.lock();
  if (!volume) {
    const bool from_left = has_volume_left(step, 0);
    std::int64_t at = step;
    while (packed_[static_cast<std::size_t>(at)]) at += from_left ? -1 : 1;
    volume = steps[static_cast<std::size_t>(at)].document.volume;
    std::shared_ptr<LabelVolume> changed;
    while (at != step) {
      const Link& link = links_[static_cast<std::size_t>(from_left ? at + 1 : at)];
      if (link.change) {
        if (!changed) changed = std::make_shared<LabelVolume>(*volume);
        from_left ? apply_change(*link.change, *changed) : take_back_change(*link.change, *changed);
      }
      at += from_left ? 1 : -1;
    }
    if (changed) volume = std::move(changed);
  }
  packed_[static_cast<std::size_t>(step)].reset();
  set(steps[static_cast<std::size_t>(step)].document, std::move(volume));
}

std::int64_t PackedVolumes::bytes() const {
  std::int64_t bytes = 0;
  for (const Link& link : links_)
    if (link.change) bytes += static_cast<std::int64_t>(sizeof(LabelChange)) + link.change->heap_bytes();
  return bytes;
}

}  // namespace limber
