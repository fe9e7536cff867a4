// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/skin/weight_edits.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "core/base/error.h"
#include "core/base/parallel.h"
#include "core/skin/neighbour_weights.h"
#include "core/skin/weight_at.h"

namespace limber {

namespace {

constexpr int kBrick = TissueVoxels::kBrick;
constexpr std::int64_t kBricksAtOnce = 16;
constexpr std::int64_t kBricksOfStep = 2048;  // bricks between two progress updates, some ten milliseconds of work

void check(const WeightedBody& body, const SkinWeights& weights, const EditScope& scope) {
  if (weights.size() != body.tissue.size() || weights.bones().size() != body.armature.bones.size())
    throw std::logic_error("the edited weights belong to another body");
  if (!scope.region.empty() && std::ssize(scope.region) != body.tissue.size())
    throw std::logic_error("the region belongs to another body");
}

void check_bones(const WeightedBody& body, std::span<const int> bones) {
  const auto in_rig = [&](int bone) { return bone >= 0 && bone < std::ssize(body.armature.bones); };
  if (bones.empty() || !std::all_of(bones.begin(), bones.end(), in_rig))
    throw std::logic_error("a bone is not in the rig, or no bone is given");
}

// Returns the unlocked bone with the most weight in the region, or -1 if there is none. It serves as the fallback bone
// where all bones connected in the bone tree are locked.
int most_of_region(const SkinWeights& weights, const WeightedBody& body, const EditScope& scope) {
  std::vector<std::int64_t> sum(body.armature.bones.size());
  std::int64_t place = 0;
  for (std::int64_t b = 0; b < weights.chunk_count(); ++b)
    for (const Influence& influence : weights.chunk(b)) {
      const bool counts = scope.region.empty() || scope.region[place];
      ++place;
      for (int i = 0; i < 4 && counts; ++i) sum[influence.bone[i]] += influence.weight[i];
    }
  int best = -1;
  for (int b = 0; b < std::ssize(sum); ++b)
    if (sum[b] > 0 && (scope.locked.empty() || !scope.locked[b]) && (best < 0 || sum[b] > sum[best])) best = b;
  return best;
}

// Returns true if some bone has no fallback bone: no unlocked bone of the bone tree could take over its weight.
bool needs_nearby(const WeightedBody& body, const WeightRules& rules) {
  for (int b = 0; b < std::ssize(body.armature.bones); ++b)
    if (rules.fallback_bone(b) < 0) return true;
  return false;
}

WeightRules rules_of(const WeightedBody& body, const SkinWeights& weights, const EditScope& scope) {
  WeightRules rules(body.armature, scope.locked, scope.normalize);
  if (!needs_nearby(body, rules)) return rules;
  return WeightRules(body.armature, scope.locked, scope.normalize, most_of_region(weights, body, scope));
}

LabelSet bone_labels(const WeightedBody& body) {
  LabelSet labels(65536, 0);
  for (const Tissue& tissue : body.tissues.tissues) labels[tissue.label] = is_bone(tissue.kind);
  return labels;
}

int whole(double weight) { return static_cast<int>(std::clamp(weight, 0.0, double(kFullWeight)) + 0.5); }

// Counts the voxels that an edit changed, and for each locked bone the voxels whose change it prevented.
struct Tally {
  std::int64_t changed = 0;
  std::vector<std::pair<int, std::int64_t>> blocked;

  void count(const WeightChange& change) {
    changed += change.changed;
    if (change.changed || change.blocked_by < 0) return;
    for (auto& [bone, times] : blocked)
      if (bone == change.blocked_by) {
        ++times;
        return;
      }
    blocked.emplace_back(change.blocked_by, 1);
  }
};

// The interval of the whole progress that one edit fills, [0, 1].
struct Share {
  double from = 0, to = 1;
};

template <class Change>
WeightEdit edited_voxels(const WeightedBody& body, const SkinWeights& weights, const EditScope& scope,
                         const Change& change, const Share& share = {}) {
  check(body, weights, scope);
  const WeightRules rules = rules_of(body, weights, scope);
  const LabelSet bone = bone_labels(body);
  const std::int64_t bricks = std::ssize(body.tissue.bricks());
  std::vector<SkinWeights::Influences> made(bricks);
  std::vector<Tally> tallies((bricks + kBricksAtOnce - 1) / kBricksAtOnce);
  const auto edit_bricks = [&](std::int64_t begin, std::int64_t end) {
    for (auto b = begin; b < end; ++b) {
      const std::int64_t first = body.tissue.bricks()[b].first;
      const SkinWeights::Influences before = weights.chunk(b);
      const WeightsAround around(body.tissue, static_cast<int>(b),
                                 [&](int index) -> InfluenceView { return weights.chunk(index); });
      body.tissue.for_each(b, b + 1, [&](std::int64_t place, const glm::ivec3& voxel) {
        if (!scope.region.empty() && !scope.region[place]) return;
        if (scope.rigid_bone_tissue && bone[body.volume.at(voxel)]) return;
        Influence influence = before[place - first];
        const WeightChange done = change(rules, influence, place, voxel, around);
        tallies[begin / kBricksAtOnce].count(done);
        if (!done.changed) return;
        if (made[b].empty()) made[b] = before;
        made[b][place - first] = influence;
      });
    }
  };
  for (std::int64_t step = 0; step < bricks; step += kBricksOfStep) {
    if (scope.progress)
      scope.progress->update("weights", share.from + (share.to - share.from) * double(step) / double(bricks));
    parallel_for(std::min(kBricksOfStep, bricks - step), kBricksAtOnce,
                 [&](std::int64_t begin, std::int64_t end) { edit_bricks(step + begin, step + end); });
  }
  WeightEdit edit{weights};
  for (std::int64_t b = 0; b < bricks; ++b)
    if (!made[b].empty()) edit.weights.set_chunk(b, std::move(made[b]));
  std::vector<std::int64_t> blocked(body.armature.bones.size());
  for (const Tally& tally : tallies) {
    edit.changed += tally.changed;
    for (const auto& [by, times] : tally.blocked) blocked[by] += times, edit.blocked += times;
  }
  if (edit.blocked > 0)
    edit.blocked_by = static_cast<int>(std::max_element(blocked.begin(), blocked.end()) - blocked.begin());
  return edit;
}

}  // namespace

WeightEdit edited(const WeightedBody& body, const SkinWeights& weights, const EditScope& scope,
                  const VoxelChange& change) {
  return edited_voxels(body, weights, scope,
                       [&](const WeightRules& rules, Influence& influence, std::int64_t place, const glm::ivec3& voxel,
                           const auto&) { return change(rules, influence, place, voxel); });
}

// ---- regions

TissueRegion region_where(const TissueVoxels& tissue,
                          const std::function<bool(std::int64_t, const glm::ivec3&)>& belongs) {
  TissueRegion region(tissue.size(), 0);
  parallel_for(std::ssize(tissue.bricks()), kBricksAtOnce, [&](std::int64_t begin, std::int64_t end) {
    tissue.for_each(begin, end,
                    [&](std::int64_t place, const glm::ivec3& voxel) { region[place] = belongs(place, voxel); });
  });
  return region;
}

TissueRegion connected_part(const LabelVolume& volume, const TissueVoxels& tissue, const glm::ivec3& voxel, Part part) {
  TissueRegion region(tissue.size(), 0);
  const Label label = volume.at_or_air(voxel);
  if (label == 0) return region;
  std::vector<glm::ivec3> front{voxel};
  region[tissue.index_of(voxel)] = 1;
  while (!front.empty()) {
    const glm::ivec3 v = front.back();
    front.pop_back();
    for (int d = 0; d < 6; ++d) {
      glm::ivec3 next = v;
      next[d >> 1] += d & 1 ? 1 : -1;
      const Label other = volume.at_or_air(next);
      if (other == 0 || (part == Part::Label && other != label)) continue;
      std::uint8_t& mark = region[tissue.index_of(next)];
      if (mark) continue;
      mark = 1;
      front.push_back(next);
    }
  }
  return region;
}

TissueRegion region_of_label(const LabelVolume& volume, const TissueVoxels& tissue, Label label) {
  return region_where(tissue, [&](std::int64_t, const glm::ivec3& voxel) { return volume.at(voxel) == label; });
}

TissueRegion region_of_bone(const SkinWeights& weights, const TissueVoxels& tissue, int bone, double least) {
  return region_where(tissue, [&](std::int64_t place, const glm::ivec3& voxel) {
    const int brick = tissue.brick_at(voxel);
    return weights.chunk(brick)[place - tissue.bricks()[brick].first].of(bone) >= least;
  });
}

// ---- edits

WeightEdit flooded(const WeightedBody& body, const SkinWeights& weights, std::span<const int> bones, Flood kind,
                   double value, double amount, const EditScope& scope) {
  check_bones(body, bones);
  return edited(body, weights, scope,
                [&](const WeightRules& rules, Influence& influence, std::int64_t, const glm::ivec3&) {
                  const double before = WeightRules::sum_of(influence, bones);
                  double to = before;
                  switch (kind) {
                    case Flood::Add: to = before + value * kFullWeight; break;
                    case Flood::Subtract: to = before - value * kFullWeight; break;
                    case Flood::Set: to = value * kFullWeight; break;
                    case Flood::Multiply: to = before * value; break;
                  }
                  return rules.set(influence, bones, whole(before + (to - before) * amount));
                });
}

WeightEdit with_gradient(const WeightedBody& body, const SkinWeights& weights, std::span<const int> bones,
                         const Gradient& gradient, double amount, const EditScope& scope) {
  check_bones(body, bones);
  const glm::dvec3 way = gradient.to - gradient.from;
  const double length = glm::length(way);
  if (!(length > 0)) throw std::logic_error("the two ends of the gradient are at the same position");
  const AffineTransform world = world_from_voxel(body.volume.grid);
  return edited(
      body, weights, scope, [&](const WeightRules& rules, Influence& influence, std::int64_t, const glm::ivec3& voxel) {
        const glm::dvec3 off = world * glm::dvec3(voxel) - gradient.from;
        const double share =
            std::clamp((gradient.radial ? glm::length(off) : glm::dot(off, way) / length) / length, 0.0, 1.0);
        const double value =
            gradient.to_value + (gradient.from_value - gradient.to_value) * gradient.falloff(static_cast<float>(share));
        const double before = WeightRules::sum_of(influence, bones);
        return rules.set(influence, bones, whole(before + (value * kFullWeight - before) * amount));
      });
}

WeightEdit smoothed(const WeightedBody& body, const SkinWeights& weights, int passes, double amount,
                    const EditScope& scope, Progress& progress) {
  WeightEdit all{weights};
  for (int pass = 0; pass < passes; ++pass) {
    if (!scope.progress) progress.update("smoothing", double(pass) / passes);
    const auto towards_mean = [&](const WeightRules& rules, Influence& influence, std::int64_t, const glm::ivec3& voxel,
                                  const WeightsAround& around) {
      std::array<Influence, 6> beside;
      const int count = around.beside(voxel & (kBrick - 1), beside);
      bool differs = false;
      for (int i = 0; i < count; ++i) differs = differs || beside[i] != influence;
      if (!differs) return WeightChange{};
      WeightSum mean;
      for (int i = 0; i < count; ++i) add_to(mean, beside[i], 1);
      return rules.blend(influence, mean, amount);
    };
    WeightEdit once =
        edited_voxels(body, all.weights, scope, towards_mean, {double(pass) / passes, double(pass + 1) / passes});
    all = std::move(once);
  }
  // Counts the voxels that differ from the original weights, since the last pass counted only its own changes.
  all.changed = 0;
  for (std::int64_t b = 0; b < weights.chunk_count(); ++b)
    if (weights.shared_chunk(b) != all.weights.shared_chunk(b))
      for (std::size_t i = 0; i < weights.chunk(b).size(); ++i)
        all.changed += weights.chunk(b)[i] != all.weights.chunk(b)[i];
  return all;
}

WeightEdit copied(const WeightedBody& body, const SkinWeights& weights, int from, int to, Copy kind,
                  const EditScope& scope) {
  const std::array<int, 2> both{from, to};
  check_bones(body, both);
  if (from == to) throw std::logic_error("a bone cannot be copied to itself");
  return edited(body, weights, scope,
                [&](const WeightRules& rules, Influence& influence, std::int64_t, const glm::ivec3&) {
                  const int source = WeightRules::sum_of(influence, std::span(&both[0], 1)),
                            target = WeightRules::sum_of(influence, std::span(&both[1], 1));
                  switch (kind) {
                    case Copy::Replace: return rules.set(influence, to, source);
                    case Copy::Add: return rules.set(influence, to, std::min(source + target, kFullWeight));
                    case Copy::Move: return rules.divide(influence, to, from, source + target);
                    case Copy::Swap: return rules.divide(influence, to, from, source);
                  }
                  return WeightChange{};
                });
}

WeightEdit limited(const WeightedBody& body, const SkinWeights& weights, int most, const EditScope& scope) {
  return edited(body, weights, scope,
                [&](const WeightRules& rules, Influence& influence, std::int64_t, const glm::ivec3&) {
                  return rules.limit(influence, most);
                });
}

WeightEdit pruned(const WeightedBody& body, const SkinWeights& weights, double least, const EditScope& scope) {
  return edited(body, weights, scope,
                [&](const WeightRules& rules, Influence& influence, std::int64_t, const glm::ivec3&) {
                  return rules.prune(influence, whole(least * kFullWeight));
                });
}

WeightEdit in_steps(const WeightedBody& body, const SkinWeights& weights, int steps, const EditScope& scope) {
  return edited(body, weights, scope,
                [&](const WeightRules& rules, Influence& influence, std::int64_t, const glm::ivec3&) {
                  return rules.quantize_to(influence, steps);
                });
}

WeightEdit with_levels(const WeightedBody& body, const SkinWeights& weights, int bone,
                       const WeightRules::Levels& levels, const EditScope& scope) {
  check_bones(body, std::span(&bone, 1));
  return edited(body, weights, scope,
                [&](const WeightRules& rules, Influence& influence, std::int64_t, const glm::ivec3&) {
                  return rules.levels(influence, bone, levels);
                });
}

namespace {

// Returns the nearest voxel, at most `reach` mm away, for which `fits` returns true; nothing if there is none. Searches
// cubes of growing size around the point.
template <class Fits>
std::optional<glm::ivec3> nearest_voxel(const Grid& grid, const glm::dvec3& at, double reach, const Fits& fits) {
  const glm::ivec3 centre(glm::round(glm::clamp(at, glm::dvec3(-1e6), glm::dvec3(1e6))));
  const double least_spacing = std::min({grid.spacing.x, grid.spacing.y, grid.spacing.z});
  double best = reach * reach * (1 + 1e-9);
  std::optional<glm::ivec3> found;
  // Shell n is the surface of the n-th cube. Its voxels are at least n - 0.5 voxels from the point, since the centre
  // was rounded by up to half a voxel.
  for (int shell = 0; (shell - 0.5) * least_spacing <= std::sqrt(best); ++shell) {
    const glm::ivec3 low = glm::max(centre - shell, glm::ivec3(0)), high = glm::min(centre + shell, grid.size - 1);
    for (int z = low.z; z <= high.z; ++z)
      for (int y = low.y; y <= high.y; ++y) {
        const bool face = std::abs(z - centre.z) == shell || std::abs(y - centre.y) == shell;
        const int step = face || shell == 0 ? 1 : 2 * shell;
        for (int x = face ? low.x : centre.x - shell; x <= (face ? high.x : centre.x + shell); x += step) {
          if (x < 0 || x >= grid.size.x) continue;
          const glm::dvec3 way = (glm::dvec3(x, y, z) - at) * grid.spacing;
          const double squared = glm::dot(way, way);
          if (squared > best || (found && squared == best) || !fits(glm::ivec3(x, y, z))) continue;
          best = squared;
          found = glm::ivec3(x, y, z);
        }
      }
  }
  return found;
}

}  // namespace

MirrorEdit mirrored(const WeightedBody& body, const SkinWeights& weights, const MirrorSettings& settings,
                    const EditScope& scope) {
  const std::vector<int> pairs = mirror_pairs(body.armature);
  const AffineTransform world = world_from_voxel(body.volume.grid), to_voxel = voxel_from_world(body.volume.grid);
  const LabelSet bone = bone_labels(body);
  const auto is_mirrored_to = [&](const glm::ivec3& voxel) {
    return glm::dot(world * glm::dvec3(voxel) - settings.plane.point, settings.plane.normal) > 0;
  };
  std::vector<std::uint8_t> unmatched(body.tissue.size(), 0);
  MirrorEdit edit{
      edited(body, weights, scope,
             [&](const WeightRules& rules, Influence& influence, std::int64_t place, const glm::ivec3& voxel) {
               if (!is_mirrored_to(voxel)) return WeightChange{};
               const glm::dvec3 point = world * glm::dvec3(voxel);
               const bool is_bone = bone[body.volume.at(voxel)] != 0;
               const auto source = nearest_voxel(
                   body.volume.grid, to_voxel * settings.plane.place(point), settings.reach, [&](const glm::ivec3& v) {
                     const Label label = body.volume.at(v);
                     return label != 0 && (bone[label] != 0) == is_bone && !is_mirrored_to(v);
                   });
               if (!source) {
                 unmatched[place] = 1;
                 return WeightChange{};
               }
               const int brick = body.tissue.brick_at(*source);
               const Influence& from =
                   weights.chunk(brick)[body.tissue.index_of(*source) - body.tissue.bricks()[brick].first];
               std::array<std::pair<int, double>, 4> target;
               int count = 0;
               for (int i = 0; i < 4; ++i)
                 if (from.weight[i]) target[count++] = {pairs[from.bone[i]], double(from.weight[i])};
               return rules.blend(influence, std::span(target.data(), count), 1);
             }),
      {}};
  for (std::int64_t place = 0; place < body.tissue.size(); ++place)
    if (unmatched[place]) edit.unmatched.push_back(place);
  return edit;
}

TransferEdit transferred(const WeightedBody& body, const SkinWeights& weights, const TransferSource& from,
                         const EditScope& scope, Progress& progress) {
  // Each bone of the other rig maps to the bone of the same name, else to the bone of its nearest ancestor.
  std::vector<int> to(from.armature.bones.size(), -1);
  std::vector<bool> own(to.size(), false);
  bool any = false;
  for (std::size_t b = 0; b < to.size(); ++b) {
    const Bone& bone = from.armature.bones[b];
    if (const auto found = body.armature.find(bone.name)) {
      to[b] = *found;
      own[b] = any = true;
    } else if (bone.parent >= 0) {
      to[b] = to[bone.parent];
    }
  }
  if (!any)
    throw Error("the two rigs have no bone in common", "bones by name",
                "rename the bones, or use weights of the same rig");
  progress.update("weights of the other volume", 0);
  const AffineTransform world = world_from_voxel(body.volume.grid);
  std::vector<glm::dvec3> points(body.tissue.size());
  body.tissue.for_each([&](std::int64_t place, const glm::ivec3& voxel) { points[place] = world * glm::dvec3(voxel); });
  const std::vector<SkinAt> skin = skin_at(from.volume, from.tissue, from.weights, points);
  progress.update("weights of the other volume", 0.8);
  TransferEdit edit{edited(body, weights, scope,
                           [&](const WeightRules& rules, Influence& influence, std::int64_t place, const glm::ivec3&) {
                             const Influence& source = skin[place].influence;
                             std::array<std::pair<int, double>, 4> target;
                             int count = 0;
                             for (int i = 0; i < 4; ++i)
                               if (source.weight[i] && to[source.bone[i]] >= 0)
                                 target[count++] = {to[source.bone[i]], double(source.weight[i])};
                             return rules.blend(influence, std::span(target.data(), count), 1);
                           }),
                    {}};
  std::vector<bool> used(to.size(), false);
  for (const SkinAt& at : skin)
    for (int i = 0; i < 4; ++i)
      if (at.influence.weight[i]) used[at.influence.bone[i]] = true;
  for (std::size_t b = 0; b < to.size(); ++b)
    if (used[b] && !own[b]) edit.missing.push_back(from.armature.bones[b].name);
  return edit;
}

}  // namespace limber
