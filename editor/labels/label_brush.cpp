// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/labels/label_brush.h"

#include <chrono>
#include <utility>

#include "editor/context/views.h"
#include "render/passes/pass_resources.h"

namespace limber::editor {

namespace {

using Surface = render::PassResources::Surface;

// Largest part of the grid, as a fraction of its voxels, that is uploaded as a change. Uploading a larger part takes
// as long as uploading the whole volume.
constexpr double kMostOfGrid = 0.25;
// A volume that is larger is not copied for the next stroke, because the copy would need too much memory, bytes.
constexpr std::size_t kMostSpare = std::size_t{512} << 20;

void keep_spare(LabelBrush& brush, const std::shared_ptr<const LabelVolume>& volume) {
  auto& spare = brush.spare;
  const bool copying = spare.copy.valid() && spare.copy.wait_for(std::chrono::seconds(0)) != std::future_status::ready;
  if (copying || brush.running) return;
  if (!brush.on || !volume || volume->voxels.size() * sizeof(Label) > kMostSpare) {
    spare = {};
    return;
  }
  if (spare.copy.valid() && spare.of.lock() == volume) return;
  spare.of = volume;
  spare.copy = std::async(std::launch::async, [volume] { return std::make_shared<LabelVolume>(*volume); });
}

}  // namespace

void show_label_stroke(Views& views, LabelBrush& brush) {
  if (!brush.running || views.scene.volume != brush.running->stroke->before()) return;
  const LabelStroke& stroke = *brush.running->stroke;
  render::PassResources& resources = views.renderer.resources();
  // The first call of relabel() in a stroke replaces the document's volume on the GPU by the stroke's volume. In later
  // frames it does nothing.
  resources.relabel(stroke.before(), stroke.volume(), {}, Surface::Waits);
  if (const limber::VoxelBox box = std::exchange(brush.running->unshown, {}); box.size.x > 0)
    resources.relabel(stroke.volume(), stroke.volume(), box, Surface::Waits);
  views.scene.volume = stroke.volume();
}

std::shared_ptr<LabelVolume> take_spare(LabelBrush& brush, const std::shared_ptr<const LabelVolume>& volume) {
  if (!brush.spare.copy.valid() || brush.spare.of.lock() != volume) return nullptr;
  return brush.spare.copy.get();
}

void show_painted(Views& views, const LabelStroke& stroke) {
  views.renderer.resources().relabel(stroke.volume(), stroke.volume(), stroke.touched_box(), Surface::AtOnce);
}

void show_unpainted(Views& views, const LabelStroke& stroke) {
  views.renderer.resources().relabel(stroke.volume(), stroke.before(), stroke.touched_box(), Surface::AtOnce);
}

void follow_label_edits(Views& views, LabelBrush& brush, const std::shared_ptr<const LabelVolume>& volume) {
  const auto before = brush.last.lock();
  brush.last = volume;
  keep_spare(brush, volume);
  render::PassResources& resources = views.renderer.resources();
  if (!before || !volume || before == volume || !(before->grid == volume->grid) || resources.has(volume) ||
      !resources.has(before))
    return;
  const limber::VoxelBox box = bounds_of(label_difference(*before, *volume), volume->grid);
  if (static_cast<double>(box.voxel_count()) < kMostOfGrid * static_cast<double>(volume->grid.voxel_count()))
    resources.relabel(before, volume, box, Surface::AtOnce);
}

}  // namespace limber::editor
