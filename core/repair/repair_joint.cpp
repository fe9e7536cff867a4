// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/repair/repair_joint.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numeric>

#include "core/base/error.h"
#include "core/deform/blend_rule.h"
#include "core/repair/bounded_minimum.h"
#include "core/report/metrics.h"
#include "core/resample/posed_voxels.h"
#include "core/resample/resample.h"
#include "core/resample/rigid_weights.h"
#include "core/skin/weight_edits.h"

namespace limber {

namespace {

// Number of smoothing passes. Each moves a weight three quarters of the way to the mean of its six neighbours, so that
// all passes together smooth over about 1.6 voxels.
constexpr int kSmoothing = 10;
constexpr double kSmoothingAmount = 0.75;
constexpr int kMostRounds = 4;  // upper limit on the rounds of correction; each of them resamples the body
// Factor by which the costs of folds and overlap grow after a round in which more tissue overlaps than before.
constexpr double kMoreCare = 5;
// A turn's weight is 1 / (its own volume change + this share of the mean volume change of all turns).
constexpr double kEvenness = 0.5;
constexpr int kMostIterations = 60;
constexpr double kLeastProgress = 2e-3;  // %; the minimizer stops once an iteration lowers its total by less

// Returns S, the sum of the absolute volume changes of skin, fat and muscle, %.
double size_of(const FleshChange& change) {
  return std::accumulate(change.begin(), change.end(), 0.0,
                         [](double sum, double each) { return sum + std::abs(each); });
}

std::vector<FleshChange> changes_of(const std::vector<TurnFigures>& figures) {
  std::vector<FleshChange> changes;
  for (const TurnFigures& each : figures) changes.push_back(each.change);
  return changes;
}

FleshChange flesh_change(const WeightedBody& body, const LabelVolume& posed) {
  const std::vector<FleshClass> classes = flesh_classes(body.tissues);
  FleshChange before{}, after{}, change{};
  for (const TissueChange& tissue : compare(body.volume, posed, body.tissues).tissues)
    if (const FleshClass c = classes[tissue.label]; c != FleshClass::Other) {
      before[static_cast<int>(c)] += tissue.mm3_before;
      after[static_cast<int>(c)] += tissue.mm3_after;
    }
  for (int c = 0; c < kFleshClasses; ++c) change[c] = before[c] > 0 ? 100 * (after[c] / before[c] - 1) : 0;
  return change;
}

std::vector<TurnFigures> measured(const WeightedBody& body, const SkinWeights& weights, const JointMotion& motion,
                                  Blend blend, Progress& progress) {
  std::vector<Pose> poses;
  for (const JointTurn& turn : motion.turns) poses.push_back(turned(body.armature, motion, turn));
  std::vector<TurnFigures> figures;
  ResampleSettings settings;
  settings.seams = body.tissue.shared_seams();
  resample_sequence(
      body.volume, body.tissues, body.armature, weights, poses, blend, settings,
      [&](std::size_t place, const Posed& posed) {
        figures.push_back({motion.turns[place], flesh_change(body, posed.volume), posed.report.overlap_voxels});
      },
      progress);
  return figures;
}

// Returns the weights in which the field's tissue follows the moving bones by the shares of the nodes. The shares have
// kinks between cells, which would appear as ripples on posed skin, so the weights are smoothed over less than a cell.
WeightEdit with_shares(const WeightedBody& body, const SkinWeights& weights, const JointField& field,
                       std::span<const double> nodes, const JointMotion& motion, const BoneSet& locked) {
  EditScope scope{.locked = locked};
  std::vector<std::uint8_t> is_moving(body.armature.bones.size(), 0);
  for (const int bone : motion.moving) is_moving[bone] = 1;
  WeightEdit edit =
      edited(body, weights, scope,
             [&](const WeightRules& rules, Influence& influence, std::int64_t index, const glm::ivec3& voxel) {
               const FieldPoint point = field.point(index, voxel);
               if (point.piece < 0 || point.mask == 0) return WeightChange{};
               // Moving bones that are locked keep their weights; the other moving bones get the rest of the share.
               int held = 0;
               for (int i = 0; i < 4; ++i)
                 if (is_moving[influence.bone[i]] && rules.is_locked(influence.bone[i])) held += influence.weight[i];
               const int share = static_cast<int>(std::lround(field.value(point, nodes) * kFullWeight));
               return rules.set(influence, motion.moving, std::max(0, share - held));
             });
  scope.region =
      region_where(body.tissue, [&](std::int64_t index, const glm::ivec3&) { return field.mask(index) > 0; });
  edit.weights = smoothed(body, edit.weights, kSmoothing, kSmoothingAmount, scope).weights;
  edit.changed = 0;
  for (std::int64_t b = 0; b < weights.chunk_count(); ++b)
    if (weights.shared_chunk(b) != edit.weights.shared_chunk(b))
      for (std::size_t i = 0; i < weights.chunk(b).size(); ++i)
        edit.changed += weights.chunk(b)[i] != edit.weights.chunk(b)[i];
  return edit;
}

// Returns the capsule widths to try, mm: each is 1.5 times the one before.
std::vector<double> widths_to_try() {
  std::vector<double> widths;
  for (double width = 20; width < 500; width *= 1.5) widths.push_back(width);
  return widths;
}

struct CapsuleStart {
  CapsuleWidths widths;
  std::vector<double> nodes;
  double value = 0;
};

// Searches the extensor width and the flexor width in turn, each among all widths to try, twice.
CapsuleStart best_capsule(const CapsuleShape& shape, const VolumeModel& model, Progress& progress) {
  CapsuleStart best{.widths = {60, 120}, .nodes = {}, .value = INFINITY};
  for (int round = 0; round < 2; ++round)
    for (double CapsuleWidths::*side : {&CapsuleWidths::extensor, &CapsuleWidths::flexor}) {
      const CapsuleWidths from = best.widths;
      for (const double width : widths_to_try()) {
        progress.update("capsule", 0.5 * round);
        CapsuleWidths widths = from;
        widths.*side = width;
        std::vector<double> nodes = shape.shares(widths);
        const double value = model.evaluate(nodes, {}).total;
        if (value < best.value) best = {widths, std::move(nodes), value};
      }
    }
  return best;
}

}  // namespace

double TurnFigures::sum() const { return size_of(change); }

double mean_sum(const std::vector<TurnFigures>& figures) {
  double sum = 0;
  for (const TurnFigures& each : figures) sum += each.sum();
  return sum / static_cast<double>(figures.size());
}

double mean_overlap(const std::vector<TurnFigures>& figures) {
  double sum = 0;
  for (const TurnFigures& each : figures) sum += static_cast<double>(each.overlap_voxels);
  return sum / static_cast<double>(figures.size());
}

namespace {

// One run of the repair, with the model of the joint, the figures of the unchanged body, and the best weights so far.
class Repairer {
 public:
  Repairer(const WeightedBody& body, const SkinWeights& weights, int bone, const JointRepairSettings& settings,
           Progress& progress)
      : body_(body),
        weights_(weights),
        settings_(settings),
        progress_(progress),
        motion_(joint_motion(body.armature, bone, settings.range)),
        field_(body,
               with_rigid_bones(weights, body.volume, body.tissue, body.tissues, LabelSets(body.tissues).bone,
                                body.armature, progress),
               motion_, progress),
        model_(body, field_, motion_, settings.blend, progress),
        capsule_(body, field_, motion_) {
    repair_.weights = weights;
  }

  JointRepair run() {
    repair_.before = repair_.after = measured(body_, weights_, motion_, settings_.blend, progress_);
    // Some blends let flesh settle afterwards, which restores its volume. For them, only the blend itself is optimized;
    // the resampled volumes are not used to correct the prediction, since they include the settling.
    const bool settles = rule_of(settings_.blend).settles_flesh;
    const VolumeModel::Value unchanged = model_.evaluate(field_.initial(), {});
    if (!settles) learn(repair_.before, unchanged.change);
    weigh_turns(settles ? unchanged.change : changes_of(repair_.before));
    start();
    for (int round = 0; round < kMostRounds; ++round) {
      const VolumeModel::Value predicted = correct(round);
      const bool had_found = repair_.is_better;
      const auto figures = take_if_better();
      const bool overlaps = mean_overlap(figures) > mean_overlap(repair_.before);
      if (had_found || (repair_.is_better && settles)) break;
      if (!settles) learn(figures, predicted.change);
      if (!overlaps) continue;
      take_more_care();
      start();
    }
    return std::move(repair_);
  }

 private:
  // Starts the correction from the weights of the joint capsule that changes the tissues' volumes least, or from the
  // present weights if these change them less.
  void start() {
    CapsuleStart capsule = best_capsule(capsule_, model_, progress_);
    widths_ = capsule.widths;
    from_capsule_ = capsule.value < model_.evaluate(field_.initial(), {}).total;
    nodes_ = from_capsule_ ? std::move(capsule.nodes) : field_.initial();
  }

  VolumeModel::Value correct(int round) {
    nodes_ =
        bounded_minimum(
            [&](std::span<const double> x, std::span<double> gradient) { return model_.evaluate(x, gradient).total; },
            std::move(nodes_), kMostIterations, kLeastProgress,
            [&](int iteration) {
              progress_.update("correction", (round + double(iteration) / kMostIterations) / kMostRounds);
            })
            .x;
    return model_.evaluate(nodes_, {});
  }

  // Resamples the body with the corrected weights, and stores them if the result is better than the best so far.
  std::vector<TurnFigures> take_if_better() {
    WeightEdit edit = with_shares(body_, weights_, field_, nodes_, motion_, settings_.locked);
    auto figures = measured(body_, edit.weights, motion_, settings_.blend, progress_);
    if (mean_sum(figures) < mean_sum(repair_.after) && mean_overlap(figures) <= mean_overlap(repair_.before))
      repair_ = {.is_better = true,
                 .weights = std::move(edit.weights),
                 .changed = edit.changed,
                 .widths = widths_,
                 .starts_from_capsule = from_capsule_,
                 .before = std::move(repair_.before),
                 .after = figures};
    return figures;
  }

  void learn(const std::vector<TurnFigures>& resampled, const std::vector<FleshChange>& predicted) {
    VolumeModel::Tuning tuning = model_.tuning();
    for (std::size_t t = 0; t < predicted.size(); ++t)
      for (int c = 0; c < kFleshClasses; ++c) tuning.bias[t][c] += resampled[t].change[c] - predicted[t][c];
    model_.set_tuning(std::move(tuning));
  }

  void take_more_care() {
    VolumeModel::Tuning tuning = model_.tuning();
    tuning.care *= kMoreCare;
    model_.set_tuning(std::move(tuning));
  }

  // Gives turns with small volume changes more weight, so that the widest turns do not dominate the total.
  void weigh_turns(const std::vector<FleshChange>& unchanged) {
    VolumeModel::Tuning tuning = model_.tuning();
    double mean = 0, total = 0;
    for (const FleshChange& change : unchanged) mean += size_of(change) / static_cast<double>(unchanged.size());
    if (mean == 0) return;
    for (std::size_t t = 0; t < unchanged.size(); ++t)
      total += tuning.turn_weights[t] = 1 / (size_of(unchanged[t]) + kEvenness * mean);
    for (double& weight : tuning.turn_weights) weight *= static_cast<double>(unchanged.size()) / total;
    model_.set_tuning(std::move(tuning));
  }

  const WeightedBody& body_;
  const SkinWeights& weights_;
  const JointRepairSettings& settings_;
  Progress& progress_;
  const JointMotion motion_;
  const JointField field_;
  VolumeModel model_;
  const CapsuleShape capsule_;
  CapsuleWidths widths_;
  bool from_capsule_ = false;
  std::vector<double> nodes_;
  JointRepair repair_;
};

}  // namespace

JointRepair repair_joint(const WeightedBody& body, const SkinWeights& weights, int bone,
                         const JointRepairSettings& settings, Progress& progress) {
  const std::vector<FleshClass> classes = flesh_classes(body.tissues);
  if (std::all_of(classes.begin(), classes.end(), [](FleshClass c) { return c == FleshClass::Other; }))
    throw Error("no tissue of this body is known to be skin, fat or muscle", body.armature.bones[bone].name,
                "give their labels these kinds in a tissue table");
  if (!settings.locked.empty() && settings.locked[bone])
    throw Error("the bone below the joint is locked", body.armature.bones[bone].name, "unlock the bone");
  return Repairer(body, weights, bone, settings, progress).run();
}

std::string describe(const JointRepair& repair, const Armature& armature, int bone) {
  const std::string joint = "The joint of " + armature.bones[bone].name;
  if (!repair.is_better)
    return joint + " is not changed: no weights were found that keep skin, fat and muscle closer to their volumes " +
           "without more overlap";
  char text[256];
  std::snprintf(text, sizeof text,
                ": the volumes of skin, fat and muscle change by %.2f %% in total instead of %.2f %%, %.0f voxels "
                "overlap instead of %.0f (means of %d turns)",
                mean_sum(repair.after), mean_sum(repair.before), mean_overlap(repair.after),
                mean_overlap(repair.before), static_cast<int>(std::ssize(repair.after)));
  std::string sentence = joint + text;
  if (repair.starts_from_capsule) {
    std::snprintf(text, sizeof text,
                  "; its weights blend over %.0f mm on the flexor side and %.0f mm on the extensor side",
                  repair.widths.flexor, repair.widths.extensor);
    sentence += text;
  }
  return sentence;
}

}  // namespace limber
