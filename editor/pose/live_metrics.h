// SPDX-License-Identifier: AGPL-3.0-or-later
// What the pose on show does to the tissue, measured while it rests: beside the editor the pose is resampled as a
// result would be, label by label the same, and counted. A pose that changes cancels that; nothing is measured unseen.
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

struct Editor;

// A body in a pose, for the dense map. Equal pointers are equal contents.
struct DenseWish {
  std::shared_ptr<const LabelVolume> volume;
  std::shared_ptr<const TissueTable> tissues;
  std::shared_ptr<const Armature> armature;
  std::shared_ptr<const SkinWeights> weights;
  Pose pose;
  Blend blend = Blend::DualQuaternion;
  std::shared_ptr<const Seams> seams = nullptr;       // as the document keeps them; null: those that are found
  std::shared_ptr<const BoneMap> bone_map = nullptr;  // of the document

  bool operator==(const DenseWish&) const = default;
};

struct PoseMetrics {
  struct Row {
    std::string name;
    glm::vec3 colour{0};
    double mm3_before = 0, mm3_after = 0;
    std::optional<double> change_percent() const;  // none where there was nothing before
  };
  std::vector<Row> tissues;  // bone as one; largest first
  Row total;
  std::int64_t overlap_voxels = 0;
};
PoseMetrics measure(const DenseWish& wish, Progress& progress = no_progress());

class LiveMetrics {
 public:
  // Once a frame: begins to measure a pose that has `settled`, and stops where it is no longer wished for.
  void follow(Editor& editor, const std::optional<DenseWish>& wish, bool settled);
  void want() { wanted_ = true; }  // someone is looking, in this frame
  // Of the pose on show; null while it is not known.
  const PoseMetrics* known() const { return is_known_ ? &metrics_ : nullptr; }
  // Of that, or of the pose of the same volume that was known last.
  const PoseMetrics* last() const { return metrics_of_ && metrics_of_ == of_.volume ? &metrics_ : nullptr; }
  const std::string& trouble() const { return trouble_; }  // why it cannot be; "" for nothing

 private:
  void stop(Editor& editor);

  DenseWish of_;  // what is known, being measured, or failed
  PoseMetrics metrics_;
  std::shared_ptr<const LabelVolume> metrics_of_;
  bool is_known_ = false, wanted_ = false;
  std::string trouble_;
  int job_ = 0;  // 0: none
};

}  // namespace limber::editor
