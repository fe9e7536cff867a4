// SPDX-License-Identifier: AGPL-3.0-or-later
// The volume that follows the pose. While the Pose workspace shows another pose than rest, the views read the volume
// through the inverse map of that pose (core/deform/preview_map.h): rays, slices and whatever the pointer is over.
//
// Maps are made by threads of their own, always of the newest pose; one that a newer pose overtook before its turn is
// left out. The editor never waits for a map. Bones are drawn in the pose of the map on show, so body and skeleton move
// together, as fast as the machine can. A pose that has rested for a while gets a map of half the step. A body of which
// only the weights are others, as after a stroke, is made ready on what frames leave of the machine.
#pragma once

#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "core/bones/bone_identity.h"
#include "core/deform/preview_map.h"
#include "editor/pose/live_metrics.h"

namespace limber::editor {

struct Editor;
struct Solve;

// A body that maps are made of. Equal pointers are equal contents.
struct PosedBody {
  std::shared_ptr<const LabelVolume> volume;
  std::shared_ptr<const TissueTable> tissues;
  std::shared_ptr<const SkinWeights> weights;
  std::shared_ptr<const Armature> armature;  // that says which limbs touch without being one; null: none
  std::shared_ptr<const Seams> seams;        // as the document keeps them; null: those that are found
  std::shared_ptr<const BoneMap> bone_map;   // of the document

  bool operator==(const PosedBody&) const = default;
};

// A body in a pose.
struct PoseWish {
  PosedBody body;
  std::vector<RigidTransform> motions;  // of the weights' bones
  Blend blend = Blend::DualQuaternion;
  MeshPose mesh = {};                            // what carries tissue in place of its bones; empty: nothing
  std::vector<RigidTransform> rig_motions = {};  // of the rig's bones, which are drawn
  Pose pose = {};                                // of the rig; empty while a mesh carries the tissue

  bool operator==(const PoseWish&) const;
};

class MapMaker {
 public:
  struct Made {
    PoseWish wish;
    std::shared_ptr<const PreviewMap> map;
    std::string trouble;  // an Error's line in place of the map
  };

  //   divisor  of the body's own step
  //   wake     called from another thread when there is something to take
  MapMaker(int divisor, std::function<void()> wake);
  ~MapMaker();

  void ask(const PoseWish& wish);  // in place of what waits; once is enough
  std::optional<Made> take();      // what was made last, once
  bool busy() const;

 private:
  void work();

  const int divisor_;
  const std::function<void()> wake_;
  mutable std::mutex mutex_;
  std::condition_variable asked_;
  std::optional<PoseWish> asked_last_, waiting_;
  std::optional<Made> made_;
  bool working_ = false, ended_ = false;
  std::thread thread_;
};

class LivePose {
 public:
  explicit LivePose(const std::function<void()>& wake);

  // Once a frame: asks for what is to be shown, and takes what was made.
  void follow(Editor& editor);
  // Of the pose that is shown, or the last one that is known; null at rest and where nothing can follow.
  const std::shared_ptr<const PreviewMap>& map() const { return shown_; }
  // Of the rig's bones, in the pose in which the map shows the body: an older one than the pose that is asked for while
  // its map is being made, rest before there is any (no motions). Where no body follows, the pose that is asked for.
  const std::vector<RigidTransform>& rig_motions() const { return seen_.rig_motions; }
  const Pose& pose() const { return seen_.pose; }
  // Why the volume stays behind: "No weights yet"; "" where it follows, and where there is nothing to pose.
  const std::string& trouble() const { return trouble_; }
  bool posed() const { return posed_; }  // the pose on show is another than rest
  LiveMetrics& metrics() { return metrics_; }
  bool busy() const { return swift_.busy() || thorough_.busy(); }

 private:
  std::optional<DenseWish> choose(Editor& editor);
  void follow(const Solve& solve, double now);
  void show(const MapMaker::Made& made);

  MapMaker swift_, thorough_;
  MapMaker::Made coarse_, fine_;  // of either
  PoseWish wish_;
  double since_ = 0;  // the editor's time when the wish came up
  std::shared_ptr<const PreviewMap> shown_;
  PoseWish seen_;  // what the views show
  std::string trouble_;
  bool posed_ = false, warmed_up_ = false;
  LiveMetrics metrics_;
};

}  // namespace limber::editor
