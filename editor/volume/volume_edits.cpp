// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/volume/volume_edits.h"

#include <cmath>

#include "core/base/error.h"
#include "core/prepare/prepare.h"
#include "core/project/seams_codec.h"
#include "editor/context/arriving_body.h"
#include "editor/context/background_task.h"
#include "editor/context/context.h"
#include "editor/context/views.h"
#include "editor/ui/messages.h"
#include "editor/ui/ui.h"

namespace limber::editor {

namespace {

bool same_tissue(const LabelVolume& a, const LabelVolume& b) {
  if (!(a.grid == b.grid)) return false;
  for (std::size_t i = 0; i < a.voxels.size(); ++i)
    if ((a.voxels[i] != 0) != (b.voxels[i] != 0)) return false;
  return true;
}

std::shared_ptr<const TissueTable> present(const TissueTable& tissues, const LabelVolume& volume) {
  std::vector<bool> there(65536, false);
  for (const Label label : volume.voxels) there[label] = true;
  auto left = std::make_shared<TissueTable>(tissues);
  std::erase_if(left->tissues, [&](const Tissue& tissue) { return !there[tissue.label]; });
  return left;
}

// Converts a clip box from voxel coordinates of one grid to voxel coordinates of another grid, so that the box keeps
// its position in the world. If the grids have different axes, returns a clip box that is switched off.
ClipBox moved(const ClipBox& box, const Grid& from, const Grid& to) {
  if (from.direction != to.direction) return {};
  const AffineTransform world = world_from_voxel(from), voxel = voxel_from_world(to);
  return {box.enabled, glm::max(voxel * (world * box.low), glm::dvec3(-0.5)),
          glm::min(voxel * (world * box.high), glm::dvec3(to.size) - 0.5)};
}

}  // namespace

std::string size_text(const glm::ivec3& size) {
  return std::to_string(size.x) + "\u00d7" + std::to_string(size.y) + "\u00d7" + std::to_string(size.z);
}

std::string grouped(std::int64_t number) {
  std::string digits = std::to_string(std::abs(number));
  for (std::ptrdiff_t at = std::ssize(digits) - 3; at > 0; at -= 3) digits.insert(static_cast<std::size_t>(at), " ");
  return number < 0 ? "-" + digits : digits;
}

Document with_volume(const Document& now, std::shared_ptr<const LabelVolume> volume, bool same_tissue, bool mirrored,
                     std::string& note) {
  Document next = now;
  note.clear();
  if (now.weights && !same_tissue) {
    next.weights.reset();
    next.layers.reset();
    note = "The weights did not fit the new voxels and were removed";
  }
  if (now.armature && mirrored) {
    next.armature.reset();
    next.weights.reset();
    next.layers.reset();
    next.pose.reset();
    note = "The rig did not fit the mirrored body and was removed";
  }
  if (now.measurements && mirrored) {
    next.measurements.reset();
    note += note.empty() ? "The measurements did not fit the mirrored body and were removed"
                         : "; the measurements were removed too";
  }
  if (now.visibility && !(now.volume->grid == volume->grid)) {
    Visibility shown = *now.visibility;
    shown.clip_box = moved(shown.clip_box, now.volume->grid, volume->grid);
    next.visibility = std::make_shared<const Visibility>(std::move(shown));
  }
  next.volume = std::move(volume);
  if (next.seams && !fit(*next.seams, *next.volume)) {
    next.seams.reset();
    note += note.empty() ? "The seams did not fit the new voxels and were removed" : "; the seams were removed too";
  }
  return next;
}

void start_preparation(Context& context, Preparation preparation) {
  const auto before = context.document().volume;
  const auto tissues = context.document().tissues;
  const std::string label = preparation.label;
  auto note = std::make_shared<std::string>();
  auto is_loss = std::make_shared<bool>(false);  // true: the message in `note` says that something was removed
  const int id = context.jobs->start(
      label,
      [before, tissues, note, is_loss, preparation, visibility = context.document().visibility,
       make_ready = body_maker(*context.views)](Progress& progress) -> Edit {
        progress.update("volume", 0);
        auto after = std::make_shared<const LabelVolume>(preparation.change(*before, progress));
        if (after->grid == before->grid && after->voxels == before->voxels) {
          *note = "Nothing had to be changed";
          return [](const Document& now) { return now; };
        }
        const bool same = !preparation.mirrors && same_tissue(*before, *after);
        const auto left = tissues ? present(*tissues, *after) : nullptr;
        make_ready({.volume = after, .tissues = tissues, .visibility = visibility}, progress, {});
        return [before, after, same, left, tissues, note, is_loss, mirrors = preparation.mirrors](const Document& now) {
          if (now.volume != before)
            throw Error("the volume was changed meanwhile", "preparing the volume", "run the command again");
          Document next = with_volume(now, after, same, mirrors, *note);
          if (left && left->tissues.size() != tissues->tissues.size() && now.tissues == tissues) next.tissues = left;
          *is_loss = !note->empty();
          if (note->empty()) *note = size_text(after->grid.size) + " voxels";
          return next;
        };
      });
  context.background->step_of_job[id] = StepOfWork::Prepare;
  context.background->after_job[id] = [label, note, is_loss](Context& c, const JobStatus& job) {
    if (job.state != JobState::Done) return;
    *is_loss ? c.messages->warn(label, *note) : c.messages->ok(label, *note);
  };
  context.ui->touch();
}

}  // namespace limber::editor
