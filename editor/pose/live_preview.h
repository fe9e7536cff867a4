// SPDX-License-Identifier: AGPL-3.0-or-later
// The live preview: the volume in the views follows the pose. While a pose other than rest is shown, rays, slices and
// picking read the volume through the preview map of that pose, which returns the rest position of each posed position
// (PreviewMap, core/deform/preview_map.h).
//
// Separate threads compute the maps, always for the newest pose; older poses that still wait are skipped. The editor
// never waits for a map. Bones are drawn in the pose of the shown map, so that body and skeleton move together. When
// the pose has not changed for a while, a finer map with half the node spacing is computed. When only the weights have
// changed, as after a brush stroke, the map is computed at low priority, so that drawing the next stroke stays fast.
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
#include "core/project/document.h"
#include "editor/pose/live_metrics.h"

namespace limber::editor {

struct Context;
struct Solve;

// A body for which preview maps (PreviewMap) are computed. Equal pointers mean equal contents.
struct PosedBody {
  std::shared_ptr<const LabelVolume> volume;
  std::shared_ptr<const TissueTable> tissues;
  std::shared_ptr<const SkinWeights> weights;
  std::shared_ptr<const Armature> armature;  // rig from whose bone names the limbs are found; null: there is no rig
  // Surfaces where limbs touch at rest, edited by the user; null: they are found automatically.
  std::shared_ptr<const Seams> seams;
  // User's choice of the rig bone that each bone label follows; null: no choice.
  std::shared_ptr<const BoneMap> bone_map;

  bool operator==(const PosedBody&) const = default;
};

// A request for a preview map (PreviewMap): a body and the pose to show it in.
struct PoseWish {
  PosedBody body;
  std::vector<RigidTransform> motions;  // rest-to-posed transform of each bone that the weights name
  Blend blend = Blend::DualQuaternion;
  MeshPose mesh = {};  // a FEM solve's tet mesh, from which tissue is deformed; empty: deformed by skinning
  std::vector<RigidTransform> rig_motions = {};  // rest-to-posed transform of each drawn bone of the rig
  Pose pose = {};                                // the rig's pose; empty while a FEM solve is shown

  bool operator==(const PoseWish&) const;
};

// Returns the request for the document's body in a pose. Throws Error if the weights belong to another rig.
PoseWish wish_for_pose(const Document& document, const Pose& pose, Blend blend);

class MapMaker {
 public:
  struct Made {
    PoseWish wish;
    std::shared_ptr<const PreviewMap> map;
    std::string trouble;  // why no map could be computed; "": a map was computed
  };

  // Starts a thread that computes preview maps.
  //   divisor  the body's default node spacing is divided by this number to get the spacing of the maps
  //   wake     called from the new thread when a result is ready for take()
  MapMaker(int divisor, std::function<void()> wake);
  ~MapMaker();

  void ask(const PoseWish& wish);  // replaces a request that still waits; ignores a repeated request
  std::optional<Made> take();      // returns a new result; nothing if there is none since the last call
  // Drops the waiting request and the new result; the next ask() may then repeat the dropped request.
  void forget();
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

  // Called once per drawn frame: takes over finished preview maps, selects the map to show and requests new ones.
  void follow(Context& context);
  // Returns the preview map to show: the map of the shown pose, or of an earlier pose until that map is computed; null
  // at rest and when the volume cannot follow the pose.
  const std::shared_ptr<const PreviewMap>& map() const { return shown_; }
  // Returns the rest-to-posed transforms with which the rig's bones are drawn. Their pose is the pose of the shown
  // preview map, so that bones and body match. Before the first map is computed, the result is empty: bones are drawn
  // at rest. If no volume follows the pose, their pose is the newest pose.
  const std::vector<RigidTransform>& rig_motions() const { return seen_.rig_motions; }
  const Pose& pose() const { return seen_.pose; }
  // Returns why the volume does not follow the pose, such as "No weights yet"; "" when it follows or the rig is at
  // rest.
  const std::string& trouble() const { return trouble_; }
  bool posed() const { return posed_; }  // true if the views show the volume in a pose other than rest
  LiveMetrics& metrics() { return metrics_; }
  bool busy() const { return swift_.busy() || thorough_->busy(); }

  // Lends the thread that computes fine preview maps, for example to an export of pictures. It stays lent as long as
  // the returned pointer exists; meanwhile the views show only coarse maps. A second MapMaker would need memory for
  // another body, and its destructor would wait until its current map is computed.
  std::shared_ptr<MapMaker> lend();
  bool is_lent() const { return thorough_.use_count() > 1; }

 private:
  std::optional<DenseWish> choose(Context& context);
  void follow(const Solve& solve, double now);
  void show(const MapMaker::Made& made);

  MapMaker swift_;
  std::shared_ptr<MapMaker> thorough_;
  bool was_lent_ = false;
  MapMaker::Made coarse_, fine_;  // newest coarse map, from swift_, and newest fine map, from thorough_
  PoseWish wish_;
  double since_ = 0;  // time (Ui::now) at which wish_ changed last, s
  std::shared_ptr<const PreviewMap> shown_;
  PoseWish seen_;  // the body and pose that the views show
  std::string trouble_;
  bool posed_ = false, warmed_up_ = false;
  LiveMetrics metrics_;
};

}  // namespace limber::editor
