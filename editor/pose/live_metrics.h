// SPDX-License-Identifier: AGPL-3.0-or-later
// Measures how the shown pose changes the volume of each tissue. While the pose does not change, a background task
// resamples the label volume in this pose, by the same method as a final result, and counts the voxels of each tissue.
// If the views refine the pose (resample/refined_pose.h), it counts the voxels of the refined volume instead.
// A change of the pose cancels the task. Nothing is measured while no panel shows the numbers.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/base/progress.h"
#include "core/bones/bone_identity.h"
#include "core/deform/skinning.h"
#include "core/resample/resample.h"
#include "core/rig/pose.h"

namespace limber::editor {

struct Context;

// A body, and the pose in which its tissue volumes are measured. Equal pointers mean equal contents.
struct DenseWish {
  std::shared_ptr<const LabelVolume> volume;
  std::shared_ptr<const TissueTable> tissues;
  std::shared_ptr<const Armature> armature;
  std::shared_ptr<const SkinWeights> weights;
  Pose pose;
  Blend blend = Blend::DualQuaternion;
  // Surfaces where limbs touch at rest, edited by the user; null: they are found automatically.
  std::shared_ptr<const Seams> seams = nullptr;
  // The user's choice of the rig bone that each bone label follows; null: no choice.
  std::shared_ptr<const BoneMap> bone_map = nullptr;

  bool operator==(const DenseWish&) const = default;
};

struct PoseMetrics {
  struct Row {
    std::string name;
    glm::vec3 colour{0};
    double mm3_before = 0, mm3_after = 0;
    std::optional<double> change_percent() const;  // volume change, percent; no value if mm3_before is 0
  };
  std::vector<Row> tissues;  // the tissues by volume, the largest first; all bone tissues share one row
  Row total;
  std::int64_t overlap_voxels = 0;
};
PoseMetrics measure(const DenseWish& wish, Progress& progress = no_progress());

// The refined volume of the shown pose, which the views compute for themselves.
struct RefinedVolume {
  bool awaited = false;                       // true: it is being computed, or soon will be
  std::shared_ptr<const LabelVolume> volume;  // null until it is computed
  std::int64_t overlap_voxels = 0;

  bool operator==(const RefinedVolume&) const = default;
};

class LiveMetrics {
 public:
  // Called once per drawn frame. Starts measuring when the pose has stopped changing. Stops measuring when the pose
  // changes or no panel shows the numbers.
  //   wish     the body and the pose to measure; nothing: nothing is measured
  //   settled  whether the pose has stopped changing
  void follow(Context& context, const std::optional<DenseWish>& wish, bool settled);
  void use(const RefinedVolume& refined) { refined_ = refined; }  // called once per frame after follow()
  void want() { wanted_ = true; }  // called by a panel in each drawn frame that shows the numbers
  // Returns the metrics of the shown pose; null until measuring has ended.
  const PoseMetrics* known() const { return is_known_ ? &metrics_ : nullptr; }
  // Returns the metrics that were measured last, which may belong to an earlier pose; null when they belong to another
  // volume.
  const PoseMetrics* last() const { return metrics_of_ && metrics_of_ == of_.volume ? &metrics_ : nullptr; }
  const std::string& trouble() const { return trouble_; }  // why measuring failed; "": it has not failed

 private:
  void stop(Context& context);

  DenseWish of_;  // the body and pose of the current or last measurement, also of a failed one
  PoseMetrics metrics_;
  std::shared_ptr<const LabelVolume> metrics_of_;
  RefinedVolume refined_;
  bool is_known_ = false, wanted_ = false;
  std::string trouble_;
  int job_ = 0;  // id of the background task that measures; 0: no task runs
};

}  // namespace limber::editor
