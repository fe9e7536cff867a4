// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/pose/live_preview.h"

#include <algorithm>
#include <new>
#include <utility>

#include "core/base/background.h"
#include "core/base/error.h"
#include "core/resample/pose_path.h"
#include "editor/context/context.h"
#include "editor/context/workspace.h"
#include "editor/pose/pose_edits.h"
#include "editor/shown/fem_live_view.h"
#include "editor/shown/preview_blend.h"
#include "editor/shown/test_pose.h"
#include "editor/ui/ui.h"
#include "editor/volume/body_seams.h"

namespace limber::editor {

namespace {

constexpr double kRest = 0.3;  // a finer preview map is computed when the pose has not changed for this time, s

bool same_motion(const RigidTransform& a, const RigidTransform& b) {
  return a.rotation == b.rotation && a.translation == b.translation;
}

bool same_motions(const std::vector<RigidTransform>& a, const std::vector<RigidTransform>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), same_motion);
}

// Returns whether two rigs have bones with equal parents, heads and tails, so that a pose moves them in the same way.
bool same_bones(const Armature& a, const Armature& b) {
  const auto same = [](const Bone& p, const Bone& q) {
    return p.parent == q.parent && p.head == q.head && p.tail == q.tail;
  };
  return std::equal(a.bones.begin(), a.bones.end(), b.bones.begin(), b.bones.end(), same);
}

// Appends to `motions` the rest-to-posed transform of each bone that the weights name. The weights' order of bones may
// differ from the rig's order. Returns false when the weights name a bone that the rig does not have.
//   posed  rest-to-posed transforms of the bones, in the rig's order
bool motions_of_weights(const SkinWeights& weights, const Armature& armature, const std::vector<RigidTransform>& posed,
                        std::vector<RigidTransform>& motions) {
  for (const std::string& name : weights.bones()) {
    const auto found =
        std::find_if(armature.bones.begin(), armature.bones.end(), [&](const Bone& bone) { return bone.name == name; });
    if (found == armature.bones.end()) return false;
    motions.push_back(posed[found - armature.bones.begin()]);
  }
  return true;
}

// A body, and the data that computing a preview map (PreviewMap) of this body reuses for every pose.
struct ReadyBody {
  PosedBody body;
  std::unique_ptr<LivePreview> preview;
};

ReadyBody make_ready(const PosedBody& body, int divisor) {
  TissueVoxels tissue(*body.volume);
  const SkinWeights& weights = *body.weights;
  bool fits = weights.chunk_count() == std::ssize(tissue.bricks());
  for (std::int64_t brick = 0; fits && brick < weights.chunk_count(); ++brick)
    fits = std::ssize(weights.chunk(brick)) == tissue.bricks()[brick].count();
  if (!fits) throw Error("the weights belong to another volume", "preview of the posed volume", "compute them again");
  tissue.set_seams(body_seams().of({body.volume, body.tissues, body.armature, body.seams, body.bone_map}));
  return {body,
          std::make_unique<LivePreview>(body.volume, *body.tissues, tissue, weights, preview_step(tissue) / divisor)};
}

// Returns the rest-to-posed transforms of the rig's bones in the pose that a running FEM solve has reached. The solve
// moves the bones step by step from rest to the target pose.
std::vector<RigidTransform> motions_of_rig(const Solve& solve, const SolveFeed::Seen& seen) {
  const Armature& armature = *solve.from.armature;
  std::vector<RigidTransform> motions = posed_from_rest(armature, part_of_pose(*solve.from.pose, seen.reached));
  const auto& bones = solve.from.weights->bones();
  for (std::size_t b = 0; b < bones.size() && b < seen.motions.size(); ++b)
    if (const auto bone = armature.find(bones[b])) motions[static_cast<std::size_t>(*bone)] = seen.motions[b];
  return motions;
}

}  // namespace

bool PoseWish::operator==(const PoseWish& other) const {
  return body == other.body && blend == other.blend && mesh == other.mesh && pose == other.pose &&
         same_motions(motions, other.motions) && same_motions(rig_motions, other.rig_motions);
}

PoseWish wish_for_pose(const Document& document, const Pose& pose, Blend blend) {
  PoseWish wish{
      {document.volume, document.tissues, document.weights, document.armature, document.seams, document.bone_map},
      {},
      blend};
  wish.pose = pose;
  wish.rig_motions = posed_from_rest(*document.armature, pose);
  if (!motions_of_weights(*document.weights, *document.armature, wish.rig_motions, wish.motions))
    throw Error("the weights belong to another rig", "posing the body", "compute them again");
  return wish;
}

MapMaker::MapMaker(int divisor, std::function<void()> wake)
    : divisor_(divisor),
      wake_(std::move(wake)),
      thread_([this] { work(); }) {}

MapMaker::~MapMaker() {
  {
    const std::lock_guard lock(mutex_);
    ended_ = true;
  }
  asked_.notify_one();
  thread_.join();
}

void MapMaker::ask(const PoseWish& wish) {
  {
    const std::lock_guard lock(mutex_);
    if (asked_last_ == wish) return;
    asked_last_ = waiting_ = wish;
  }
  asked_.notify_one();
}

std::optional<MapMaker::Made> MapMaker::take() {
  const std::lock_guard lock(mutex_);
  return std::exchange(made_, std::nullopt);
}

void MapMaker::forget() {
  const std::lock_guard lock(mutex_);
  asked_last_.reset();
  waiting_.reset();
  made_.reset();
}

bool MapMaker::busy() const {
  const std::lock_guard lock(mutex_);
  return waiting_ || working_ || made_;
}

void MapMaker::work() {
  ReadyBody ready;
  for (std::unique_lock lock(mutex_);;) {
    asked_.wait(lock, [this] { return waiting_ || ended_; });
    if (ended_) return;
    Made made{*std::exchange(waiting_, std::nullopt), nullptr, ""};
    working_ = true;
    lock.unlock();
    try {
      const auto make = [&] {
        if (!(ready.body == made.wish.body)) {
          ready = {};  // frees the old body first, because two bodies need too much memory
          ready = make_ready(made.wish.body, divisor_);
        }
        made.map = ready.preview->update(made.wish.motions, made.wish.blend, made.wish.mesh);
      };
      // After a brush stroke the preview map is computed at low priority, so that it does not slow down the next
      // stroke.
      const bool is_painted =
          ready.body.volume == made.wish.body.volume && ready.body.weights != made.wish.body.weights;
      if (is_painted || made.wish.mesh.rest) in_background(make);
      else make();
    } catch (const Error& error) {
      made.trouble = error.what();
    } catch (const std::bad_alloc&) {
      made.trouble = "There is not enough memory to show the volume in this pose";
    }
    lock.lock();
    working_ = false;
    made_ = std::move(made);
    lock.unlock();
    wake_();
    lock.lock();
  }
}

LivePose::LivePose(const std::function<void()>& wake)
    : swift_(1, wake),
      thorough_(std::make_shared<MapMaker>(2, wake)) {}

std::shared_ptr<MapMaker> LivePose::lend() {
  was_lent_ = true;
  thorough_->forget();
  return thorough_;
}

void LivePose::follow(Context& context) {
  if (auto made = swift_.take()) coarse_ = std::move(*made), context.ui->touch();
  if (was_lent_ && !is_lent()) {
    was_lent_ = false;
    thorough_->forget();
    context.ui->touch();
  }
  if (!was_lent_)
    if (auto made = thorough_->take()) fine_ = std::move(*made), context.ui->touch();
  const std::optional<DenseWish> dense = choose(context);
  metrics_.follow(context, dense, shown_ && shown_ == fine_.map);
}

void LivePose::show(const MapMaker::Made& made) {
  shown_ = made.map;
  seen_ = made.wish;
}

// Shows the body as it is deformed by the tet mesh of a running finite element solve.
void LivePose::follow(const Solve& solve, double now) {
  const SolveFeed::Seen seen = solve.feed->seen();
  const PosedBody body{solve.from.volume, solve.from.tissues, solve.from.weights, nullptr, nullptr, nullptr};
  PoseWish wish{body, seen.motions, Blend::Linear, seen.mesh, motions_of_rig(solve, seen)};
  if (!(wish == wish_)) {
    wish_ = std::move(wish);
    since_ = now;
  }
  swift_.ask(wish_);
  if (coarse_.wish.mesh.rest == seen.mesh.rest) {
    trouble_ = coarse_.trouble;
    if (coarse_.map) show(coarse_);
  }
}

// Selects the preview map that the views show. Returns the body and the pose in which LiveMetrics measures the tissue
// volumes; nothing at rest, in the Skin workspace, during a finite element solve, and when the volume cannot follow the
// pose.
std::optional<DenseWish> LivePose::choose(Context& context) {
  shown_ = nullptr;
  seen_ = {};
  posed_ = false;
  trouble_.clear();
  if (const Solve* solve = watched_solve(context)) {
    follow(*solve, context.ui->now);
    return {};
  }
  const Document& document = context.document();
  const bool painting = context.workspace() == Workspace::Skin;
  if (!shows_pose(context)) return {};
  const PosedBody body{document.volume,   document.tissues, document.weights,
                       document.armature, document.seams,   document.bone_map};
  PoseWish wish{body, {}, preview_blend(context.resampling)};
  const Pose pose = wish.pose = shown_pose(context);
  wish.rig_motions = posed_from_rest(*document.armature, pose);
  seen_ = wish;
  if (!document.volume || !document.tissues) return {};
  if (!document.weights) {
    trouble_ = "No weights yet";
    return {};
  }
  if (!motions_of_weights(*document.weights, *document.armature, wish.rig_motions, wish.motions)) {
    trouble_ = "The weights belong to another rig";
    return {};
  }
  if (!(wish == wish_)) {
    wish_ = std::move(wish);
    since_ = context.ui->now;
  }
  swift_.ask(wish_);
  if (pose == rest_pose(*document.armature)) {
    // The preview map of the rest pose is shown once, so that the graphics driver compiles the shaders before the user
    // turns the first bone.
    if (!warmed_up_ && coarse_.wish == wish_ && coarse_.map) shown_ = coarse_.map, warmed_up_ = true;
    return {};
  }
  posed_ = true;
  const PosedBody& made = coarse_.wish.body;
  if (made == wish_.body) trouble_ = coarse_.trouble;
  const bool is_of_rig = made.armature && same_bones(*made.armature, *document.armature);
  if (coarse_.map && made.volume == document.volume && is_of_rig) {
    show(coarse_);
  } else if (trouble_.empty()) {
    // Bones are shown at rest until the first preview map is computed, so that they match the body.
    seen_.pose = rest_pose(*document.armature);
    seen_.rig_motions.clear();
  }
  if (fine_.wish == wish_ && fine_.map) show(fine_);
  else if (context.ui->now < since_ + kRest) context.ui->wake_at(since_ + kRest);
  else if (shown_ && !was_lent_) thorough_->ask(wish_);
  if (painting) return {};
  return DenseWish{document.volume, document.tissues, document.armature, document.weights, pose,
                   wish_.blend,     document.seams,   document.bone_map};
}

}  // namespace limber::editor
