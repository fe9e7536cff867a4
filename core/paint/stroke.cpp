// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/paint/stroke.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "core/base/error.h"
#include "core/base/parallel.h"
#include "core/skin/simd_weights.h"
#include "core/skin/smooth_weights.h"

namespace limber {

namespace {

constexpr int kBrick = TissueVoxels::kBrick;
// Number of bricks that a thread paints at a time. For fewer bricks, waking another thread costs more than it saves.
constexpr std::int64_t kBricksAtOnce = 16;

using Target = WeightSum;
using Words = std::array<std::uint64_t, 2>;  // the 16 bytes of an Influence

// Returns whether two influences are equal. Compares 64-bit numbers: a comparison of arrays would be a function call.
bool equal(const Influence& a, const Influence& b) {
  const Words first = std::bit_cast<Words>(a), second = std::bit_cast<Words>(b);
  return first[0] == second[0] && first[1] == second[1];
}

}  // namespace

class Stroke::Work {
 public:
  Work(const WeightedBody& body, std::shared_ptr<const SkinWeights> weights, StrokeSettings settings);

  void to(const glm::dvec3& point, double pressure);
  void lift();
  void dab(const glm::dvec3& centre, double pressure);
  InfluenceView view(std::int64_t brick) const {
    const int slot = slot_of_[brick];
    return slot < 0 ? weights_->chunk(brick) : now_of(bricks_[slot]);
  }
  SkinWeights::Influences chunk(std::int64_t brick) {
    paint_waiting();
    const int slot = slot_of_[brick];
    if (slot >= 0 && !bricks_[slot].now.empty()) return bricks_[slot].now;
    return slot >= 0 && bricks_[slot].shown ? shown_.chunk(brick) : weights_->chunk(brick);
  }
  const SkinWeights& original() const { return *weights_; }
  std::vector<int> take_dirty();
  bool empty();
  const SkinWeights& weights();
  SkinWeights finish();
  std::int64_t memory_bytes() const;

  const std::vector<std::int64_t>& blocked_by() {
    paint_waiting();
    return blocked_;
  }

  int dab_count = 0;

 private:
  // A brick that some dab of the stroke has touched.
  struct Brick {
    int brick = 0;
    SkinWeights::Influences now;  // weights painted since the last call of weights(); empty: nothing painted
    // Largest cover of each voxel by any dab so far, in 1/65535. One list is for the stroke's own side of the body, one
    // for the mirrored side. Empty when dabs accumulate.
    std::array<std::vector<std::uint16_t>, 2> cover;
    bool dirty = false;
    bool shown = false;  // true: shown_ contains changed weights of this brick
    bool waits = false;
    std::array<std::uint64_t, 8> waiting{};  // one bit for each voxel, set if its cover has risen since it was painted
    std::vector<std::uint64_t> blocked;      // bits of the voxels that a locked bone kept from changing; empty: none
  };
  // One side of the body (the stroke's own or the mirrored side): the painted bones there and the brush's data.
  struct Side {
    std::vector<int> bones;
    std::unique_ptr<BrushSide> brush;  // null for plain brushes
  };
  // Working memory for painting the voxels of a brick whose cover has risen.
  struct Canvas {
    std::array<Influence, kBrick * kBrick * kBrick> made;
    std::array<std::uint16_t, kBrick * kBrick * kBrick> at, weight;
  };
  struct Blocked {
    std::vector<std::pair<int, std::int64_t>> by;
    Brick* brick = nullptr;  // brick of the voxel that is being painted; `at` is the voxel's index in it
    int at = 0;
    void add(int bone);  // counts this voxel for the locked bone, at most once per stroke
  };

  BrushFilter filter_of(const WeightedBody& body, const StrokeSettings& settings) const;
  Side side_of(std::vector<int> bones, const std::optional<MirrorPlane>& mirror);
  void find_nearby(const Reached& reached);
  void dab_side(int side, const glm::dvec3& centre, const glm::dvec3& way, double strength);
  InfluenceView now_of(const Brick& brick) const {
    if (!brick.now.empty()) return brick.now;
    return brick.shown ? shown_.chunk(brick.brick) : weights_->chunk(brick.brick);
  }
  SkinWeights::Influences& unpacked(Brick& brick) const;
  void touch(const Reached& reached, int plane);
  void cover_plainly(const Reached& reached, const Reached::Brick& part, float strength);
  void paint_waiting();
  void paint_waiting(Brick& brick, Canvas& canvas, Blocked& blocked);
  // Returns the weight that a plain brush makes of `before`, in 1/65535. `covered` is the voxel's cover, in 1/65535.
  std::uint16_t painted(int before, int covered) const {
    return static_cast<std::uint16_t>(rule_.paint_whole(before, covered, brush_));
  }
  void paint_plainly(const Reached& reached, const Reached::Brick& part, int side, float strength, Blocked& blocked);
  void paint_plainly(Influence& influence, int bone, int covered, Brick& brick, int at, Blocked& blocked) const;
  void count_blocked(const std::vector<Blocked>& blocked_in);
  void put(Brick& brick, int at, const Influence& made) const;
  bool differs(const Brick& brick) const;
  void paint_brick(const Reached& reached, const Reached::Brick& part, int side, float strength, Influence* next,
                   Blocked& blocked);
  void apply(const Side& side, Influence& influence, const Target* target, const glm::ivec3& voxel, double cover,
             Blocked& blocked) const;

  static bool target_at(const Side& side, const VoxelView& voxel, Target& target) {
    target.clear();
    return side.brush->target_at(voxel, target);
  }

  // Returns the weights of a brick from which a dab starts. These are the current weights when dabs accumulate, else
  // the weights before the stroke.
  InfluenceView source(int brick) const { return accumulate_ ? view(brick) : weights_->chunk(brick); }
  const WeightedBody body_;
  std::shared_ptr<const SkinWeights> weights_;
  const Brush brush_;
  const BrushRule& rule_;
  const bool accumulate_, relative_to_locks_;
  WeightRules rules_;
  BrushReach reach_;
  SmoothWeights smooth_;
  std::array<Side, 2> sides_;
  std::optional<MirrorPlane> mirror_;
  bool same_bones_ = false;  // true: both sides of the body paint the same bones and share one list of covers
  BoneSet locked_;
  Normalize normalize_;
  bool ready_ = false;
  std::vector<std::int64_t> blocked_;  // number of voxels that each locked bone kept from changing

  std::vector<std::int32_t> slot_of_;  // index of each brick in bricks_; -1: not touched by the stroke
  std::vector<Brick> bricks_;
  SkinWeights shown_;            // the weights that the last call of weights() returned
  std::vector<Influence> next_;  // results of one dab, for accumulating brushes that read other voxels
  std::optional<glm::dvec3> last_point_, last_dab_;
  double last_pressure_ = 1, since_dab_ = 0;
};

void Stroke::Work::Blocked::add(int bone) {
  constexpr std::size_t kWords = kBrick * kBrick * kBrick / 64;
  if (brick->blocked.empty()) brick->blocked.assign(kWords, 0);
  std::uint64_t& word = brick->blocked[static_cast<std::size_t>(at) / 64];
  const std::uint64_t bit = std::uint64_t{1} << (at % 64);
  if (word & bit) return;
  word |= bit;
  for (auto& [other, count] : by)
    if (other == bone) {
      ++count;
      return;
    }
  by.emplace_back(bone, 1);
}

// ---- Construction

BrushFilter Stroke::Work::filter_of(const WeightedBody& body, const StrokeSettings& settings) const {
  BrushFilter filter = settings.filter;
  if (!settings.rigid_bone_tissue) return filter;
  LabelSet soft = filter.labels.empty() ? LabelSet(65536, 1) : filter.labels;
  bool any = false;
  for (const Tissue& tissue : body.tissues.tissues)
    if (is_bone(tissue.kind) && tissue.label < soft.size()) {
      soft[tissue.label] = 0;
      any = true;
    }
  if (any) filter.labels = std::move(soft);
  return filter;
}

Stroke::Work::Work(const WeightedBody& body, std::shared_ptr<const SkinWeights> weights, StrokeSettings settings)
    : body_(body),
      weights_(std::move(weights)),
      brush_(settings.brush),
      rule_(rule_of(brush_.kind)),
      accumulate_(brush_.accumulate || rule_.accumulates),
      relative_to_locks_(settings.relative_to_locks),
      rules_(body.armature, settings.locked, settings.normalize),
      reach_(body.volume, body.tissue, filter_of(body, settings)),
      smooth_(body.tissue, body.volume.grid.spacing),
      mirror_(settings.mirror),
      locked_(settings.locked),
      normalize_(settings.normalize) {
  if (weights_->size() != body.tissue.size() || weights_->bones().size() != body.armature.bones.size())
    throw std::logic_error("Stroke: the weights belong to another body");
  const auto in_rig = [&](int bone) { return bone >= 0 && bone < std::ssize(body.armature.bones); };
  if (settings.bones.empty() || !std::all_of(settings.bones.begin(), settings.bones.end(), in_rig))
    throw std::logic_error("Stroke: a bone is not in the rig, or no bone is given");
  blocked_.assign(body.armature.bones.size(), 0);
  slot_of_.assign(body.tissue.bricks().size(), -1);
  sides_[0] = side_of(settings.bones, std::nullopt);
  if (mirror_) {
    const std::vector<int> pairs = mirror_pairs(body.armature);
    std::vector<int> others;
    for (const int bone : settings.bones) others.push_back(pairs[bone]);
    sides_[1] = side_of(others, mirror_);
    same_bones_ = others == settings.bones;
  }
}

Stroke::Work::Side Stroke::Work::side_of(std::vector<int> bones, const std::optional<MirrorPlane>& mirror) {
  Side side;
  side.bones = std::move(bones);
  const BrushView view{body_, brush_, smooth_, mirror, [this](int brick) { return source(brick); }};
  if (rule_.side) side.brush = rule_.side(view, side.bones);
  return side;
}

// If all bones that are connected to the painted bone in the bone tree are locked, selects a fallback bone, which gets
// the weight that is taken from the painted bone: the unlocked bone with the most weight where the stroke begins.
void Stroke::Work::find_nearby(const Reached& reached) {
  ready_ = true;
  const std::vector<int>& bones = sides_[0].bones;
  if (rules_.fallback_bone(bones[0], bones) >= 0) return;
  std::vector<std::int64_t> sum(body_.armature.bones.size());
  for (const Reached::Brick& part : reached.bricks)
    for (int i = part.begin; i < part.end; ++i) {
      const Influence& influence = weights_->chunk(part.brick)[reached.at[i]];
      for (int k = 0; k < 4; ++k) sum[influence.bone[k]] += influence.weight[k];
    }
  int best = -1;
  for (int b = 0; b < std::ssize(sum); ++b) {
    const bool free = !rules_.is_locked(b) && std::find(bones.begin(), bones.end(), b) == bones.end();
    if (free && sum[b] > 0 && (best < 0 || sum[b] > sum[best])) best = b;
  }
  rules_ = WeightRules(body_.armature, locked_, normalize_, best);
}

// ---- The stroke's path

void Stroke::Work::to(const glm::dvec3& point, double pressure) {
  if (!last_point_) {
    last_point_ = point;
    last_pressure_ = pressure;
    dab(point, pressure);
    return;
  }
  const double step = std::max(brush_.spacing, 0.01) * brush_.radius, length = glm::length(point - *last_point_);
  double at = step - since_dab_;
  for (; at <= length; at += step) {
    const double share = length > 0 ? at / length : 1;
    dab(glm::mix(*last_point_, point, share), glm::mix(last_pressure_, pressure, share));
  }
  since_dab_ = length - (at - step);
  last_point_ = point;
  last_pressure_ = pressure;
}

void Stroke::Work::lift() {
  last_point_.reset();
  last_dab_.reset();
  since_dab_ = 0;
}

void Stroke::Work::dab(const glm::dvec3& centre, double pressure) {
  const double strength = std::clamp(brush_.strength * pressure, 0.0, 1.0);
  const glm::dvec3 way = last_dab_ ? centre - *last_dab_ : glm::dvec3(0);
  dab_side(0, centre, way, strength);
  if (mirror_) dab_side(1, mirror_->place(centre), mirror_->direction(way), strength);
  last_dab_ = centre;
  ++dab_count;
}

// ---- One dab

void Stroke::Work::touch(const Reached& reached, int plane) {
  for (const Reached::Brick& part : reached.bricks) {
    std::int32_t& slot = slot_of_[part.brick];
    if (slot < 0) {
      slot = static_cast<std::int32_t>(bricks_.size());
      bricks_.emplace_back().brick = part.brick;
    }
    auto& cover = bricks_[slot].cover[plane];
    if (!accumulate_ && cover.empty()) cover.assign(weights_->chunk(part.brick).size(), 0);
  }
}

void Stroke::Work::dab_side(int side, const glm::dvec3& centre, const glm::dvec3& way, double strength) {
  const Reached& reached = reach_.dab(centre, brush_.radius, brush_.distance);
  if (reached.bricks.empty()) return;
  if (!ready_) find_nearby(reached);
  const int plane = same_bones_ ? 0 : side;
  touch(reached, plane);
  if (sides_[side].brush) sides_[side].brush->begin_dab({reached, centre, way, static_cast<float>(strength)});
  // A brush that reads other voxels must not read weights that the current dab has changed. So its results are
  // collected in next_ and stored after the dab.
  const bool keep = rule_.looks_around && accumulate_;
  const bool plain = rule_.paint_whole && sides_[side].bones.size() == 1 && (!mirror_ || same_bones_ || accumulate_) &&
                     !relative_to_locks_;
  if (plain && !accumulate_) {
    for (const Reached::Brick& part : reached.bricks) cover_plainly(reached, part, static_cast<float>(strength));
    return;
  }
  if (keep) next_.resize(reached.size());

  const std::int64_t count = std::ssize(reached.bricks), grain = count <= 2 * kBricksAtOnce ? count : kBricksAtOnce;
  std::vector<Blocked> blocked_in((count + grain - 1) / grain);
  parallel_for(count, grain, [&](std::int64_t begin, std::int64_t end) {
    for (auto b = begin; b < end; ++b) {
      if (plain)
        paint_plainly(reached, reached.bricks[b], side, static_cast<float>(strength), blocked_in[begin / grain]);
      else
        paint_brick(reached, reached.bricks[b], side, static_cast<float>(strength), keep ? next_.data() : nullptr,
                    blocked_in[begin / grain]);
    }
  });
  if (keep)
    for (const Reached::Brick& part : reached.bricks) {
      Brick& brick = bricks_[slot_of_[part.brick]];
      for (int i = part.begin; i < part.end; ++i) {
        if (!equal(next_[i], view(part.brick)[reached.at[i]])) put(brick, reached.at[i], next_[i]);
      }
    }
  count_blocked(blocked_in);
}

void Stroke::Work::count_blocked(const std::vector<Blocked>& blocked_in) {
  for (const Blocked& some : blocked_in)
    for (const auto& [bone, times] : some.by) blocked_[bone] += times;
}

SkinWeights::Influences& Stroke::Work::unpacked(Brick& brick) const {
  if (brick.now.empty()) brick.now = brick.shown ? shown_.chunk(brick.brick) : weights_->chunk(brick.brick);
  return brick.now;
}

void Stroke::Work::put(Brick& brick, int at, const Influence& made) const {
  Influence& now = unpacked(brick)[at];
  // Writes the bones and the weights separately, as they were computed. A copy of all 16 bytes would have to wait until
  // both halves are in memory.
  now.bone = made.bone;
  now.weight = made.weight;
  brick.dirty = true;
}

// Records the cover of one dab of a plain brush that paints one bone, by far the most frequent case. The result depends
// only on a voxel's largest cover by any dab. So a voxel is painted later, once for all dabs, when its weights are
// read.
void Stroke::Work::cover_plainly(const Reached& reached, const Reached::Brick& part, float strength) {
  Brick& brick = bricks_[slot_of_[part.brick]];
  const int count = part.end - part.begin;
  std::array<std::uint16_t, kBrick * kBrick * kBrick> covers;
  brush_.falloff.covers(reached.distance.data() + part.begin, count, static_cast<float>(1 / brush_.radius), strength,
                        covers.data());
  const std::uint16_t* places = reached.at.data() + part.begin;
  std::uint16_t* most = brick.cover[0].data();
  std::uint64_t grown = 0, any = 0;
  int word = places[0] / 64;
  for (int i = 0; i < count; ++i) {
    const int at = places[i];
    if (at / 64 != word) {
      brick.waiting[word] |= grown;
      any |= grown;
      grown = 0;
      word = at / 64;
    }
    const std::uint16_t before = most[at];
    grown |= std::uint64_t{covers[i] > before} << (at % 64);
    most[at] = std::max(covers[i], before);
  }
  brick.waiting[word] |= grown;
  brick.waits = brick.waits || any || grown;
}

void Stroke::Work::paint_waiting() {
  std::vector<Brick*> waiting;
  for (Brick& brick : bricks_)
    if (brick.waits) waiting.push_back(&brick);
  const std::int64_t count = std::ssize(waiting),
                     grain = count <= 2 * kBricksAtOnce ? std::max<std::int64_t>(count, 1) : kBricksAtOnce;
  std::vector<Blocked> blocked_in((count + grain - 1) / grain);
  parallel_for(count, grain, [&](std::int64_t begin, std::int64_t end) {
    Canvas canvas;
    for (auto b = begin; b < end; ++b) {
      Brick& brick = *waiting[b];
      paint_waiting(brick, canvas, blocked_in[begin / grain]);
      brick.waits = false;
    }
  });
  count_blocked(blocked_in);
}

// Paints the voxels of a brick whose cover has risen. Those without locked bones are painted together.
void Stroke::Work::paint_waiting(Brick& brick, Canvas& canvas, Blocked& blocked) {
  auto& [made, at, weight] = canvas;
  const int bone = sides_[0].bones[0], fallback_bone = rules_.fallback_bone(bone);
  int waiting = 0;
  for (int word = 0; word < std::ssize(brick.waiting); ++word)
    for (std::uint64_t bits = std::exchange(brick.waiting[word], 0); bits; bits &= bits - 1)
      at[waiting++] = static_cast<std::uint16_t>(64 * word + std::countr_zero(bits));
  weights_->chunk(brick.brick).unpack(std::span(at.data(), waiting), made.data());
  int count = waiting;
  if (fallback_bone < 0 || !rules_.is_free_everywhere()) {
    count = 0;
    for (int i = 0; i < waiting; ++i) {
      if (fallback_bone >= 0 && rules_.is_free(made[i], bone)) {
        made[count] = made[i];
        at[count++] = at[i];
        continue;
      }
      paint_plainly(made[i], bone, brick.cover[0][at[i]], brick, at[i], blocked);
      if (!equal(made[i], now_of(brick)[at[i]])) put(brick, at[i], made[i]);
    }
  }
  const int padded = (count + kWeightLanes - 1) / kWeightLanes * kWeightLanes;
  weights_of(std::span(made.data(), padded), bone, std::span(weight.data(), padded));
  if (brush_.kind == BrushKind::Add)
    for (int i = 0; i < count; ++i)
      weight[i] = static_cast<std::uint16_t>(std::min(weight[i] + brick.cover[0][at[i]], kFullWeight));
  else
    for (int i = 0; i < count; ++i) weight[i] = painted(weight[i], brick.cover[0][at[i]]);
  set_weights(std::span(made.data(), padded), bone, fallback_bone, std::span(weight.data(), padded));

  int i = 0;
  if (brick.now.empty())
    for (const InfluenceView now = now_of(brick); i < count && equal(made[i], now[at[i]]);) ++i;
  if (i == count) return;
  Influence* const now = unpacked(brick).data();
  std::uint64_t changed = 0;
  for (; i < count; ++i) {
    const Words next = std::bit_cast<Words>(made[i]), before = std::bit_cast<Words>(now[at[i]]);
    changed |= (next[0] ^ before[0]) | (next[1] ^ before[1]);
    now[at[i]] = made[i];
  }
  brick.dirty = brick.dirty || changed;
}

// Paints the voxels of a brick for one dab of a plain brush, when dabs accumulate.
void Stroke::Work::paint_plainly(const Reached& reached, const Reached::Brick& part, int side, float strength,
                                 Blocked& blocked_here) {
  Brick& brick = bricks_[slot_of_[part.brick]];
  const int count = part.end - part.begin;
  std::array<std::uint16_t, kBrick * kBrick * kBrick> covers;
  brush_.falloff.covers(reached.distance.data() + part.begin, count, static_cast<float>(1 / brush_.radius), strength,
                        covers.data());
  InfluenceView now = now_of(brick);
  for (int i = 0; i < count; ++i) {
    if (covers[i] == 0) continue;
    const int at = reached.at[part.begin + i];
    const Influence before = now[at];
    Influence made = before;
    paint_plainly(made, sides_[side].bones[0], covers[i], brick, at, blocked_here);
    if (equal(made, before)) continue;
    put(brick, at, made);
    now = brick.now;
  }
}

void Stroke::Work::paint_plainly(Influence& influence, int bone, int covered, Brick& brick, int at,
                                 Blocked& blocked_here) const {
  int before = 0;
  for (int k = 0; k < 4; ++k) before += influence.bone[k] == bone ? influence.weight[k] : 0;
  const WeightChange change = rules_.set(influence, bone, painted(before, covered));
  if (change.changed || change.blocked_by < 0) return;
  blocked_here.brick = &brick;
  blocked_here.at = at;
  blocked_here.add(change.blocked_by);
}

void Stroke::Work::paint_brick(const Reached& reached, const Reached::Brick& part, int side, float strength,
                               Influence* next, Blocked& blocked_here) {
  Brick& brick = bricks_[slot_of_[part.brick]];
  const SkinWeights::Chunk& original = weights_->chunk(part.brick);
  const TissueVoxels::Brick& tissue = body_.tissue.bricks()[part.brick];
  const float per_radius = static_cast<float>(1 / brush_.radius);
  const int plane = same_bones_ ? 0 : side, other = 1 - plane;
  const bool two = mirror_ && !same_bones_ && !accumulate_ && !brick.cover[other].empty();
  const bool around = rule_.looks_around;
  Target target, other_target;
  for (int i = part.begin; i < part.end; ++i) {
    const int at = reached.at[i], cell = reached.cell[i];
    const float cover = strength * brush_.falloff(std::min(reached.distance[i] * per_radius, 1.0f));
    const auto covered = static_cast<std::uint16_t>(cover * kFullWeight + 0.5f);
    if (!accumulate_ && covered <= brick.cover[plane][at]) continue;
    const Influence now = now_of(brick)[at];
    if (next) next[i] = now;
    blocked_here.brick = &brick;
    blocked_here.at = at;
    const glm::ivec3 voxel = tissue.corner + glm::ivec3(cell & 7, cell >> 3 & 7, cell >> 6);
    Influence made = now;
    if (accumulate_) {
      if (!(cover > 0)) continue;
      if (around && !target_at(sides_[side], {voxel, part.brick, cell, now}, target)) continue;
      apply(sides_[side], made, around ? &target : nullptr, voxel, cover, blocked_here);
    } else {
      brick.cover[plane][at] = covered;
      const Influence own = original[at];
      made = own;
      const std::uint16_t beside = two ? brick.cover[other][at] : 0;
      const bool has_target = !around || target_at(sides_[side], {voxel, part.brick, cell, own}, target);
      const auto here = [&] {
        if (has_target)
          apply(sides_[side], made, around ? &target : nullptr, voxel, double(covered) / kFullWeight, blocked_here);
      };
      if (beside == 0) {
        here();
      } else {
        // Both sides of the body paint this voxel. The side with the larger cover is applied first, so that the weights
        // of the two sides are mirror images.
        const bool other_has = !around || target_at(sides_[other], {voxel, part.brick, cell, own}, other_target);
        if (beside <= covered) here();
        if (other_has)
          apply(sides_[other], made, around ? &other_target : nullptr, voxel, double(beside) / kFullWeight,
                blocked_here);
        if (beside > covered) here();
      }
    }
    if (next) {
      next[i] = made;
    } else if (!equal(made, now)) {
      put(brick, at, made);
    }
  }
}

void Stroke::Work::apply(const Side& side, Influence& influence, const Target* target, const glm::ivec3& voxel,
                         double cover, Blocked& blocked_here) const {
  WeightChange change;
  const auto own_way = side.brush ? side.brush->change(rules_, influence, voxel, cover) : std::nullopt;
  if (own_way) {
    change = *own_way;
  } else if (target && brush_.all_bones) {
    change = rules_.blend(influence, *target, cover);
  } else {
    const int before = WeightRules::sum_of(influence, side.bones);
    const double full = relative_to_locks_ ? rules_.room(influence) : kFullWeight;
    double to = before;
    if (rule_.paint) {
      to = rule_.paint(before, cover, full, brush_);
    } else {
      double all = 0, group = 0;
      for (const auto& [bone, share] : *target) {
        all += share;
        if (std::find(side.bones.begin(), side.bones.end(), bone) != side.bones.end()) group += share;
      }
      to = before + (group / all * kFullWeight - before) * cover;
    }
    // Rounds by adding 0.5 and truncating, because std::lround would be a slow function call.
    const int whole = static_cast<int>(std::clamp(to, 0.0, double(kFullWeight)) + 0.5);
    change =
        side.bones.size() == 1 ? rules_.set(influence, side.bones[0], whole) : rules_.set(influence, side.bones, whole);
  }
  if (!change.changed && change.blocked_by >= 0) blocked_here.add(change.blocked_by);
}

// ---- The result

std::vector<int> Stroke::Work::take_dirty() {
  paint_waiting();
  std::vector<int> dirty;
  for (Brick& brick : bricks_) {
    if (brick.dirty) dirty.push_back(brick.brick);
    brick.dirty = false;
  }
  std::sort(dirty.begin(), dirty.end());
  return dirty;
}

// Returns true if the weights of a brick differ from the weights before the stroke.
bool Stroke::Work::differs(const Brick& brick) const {
  return brick.now.empty() ? brick.shown : weights_->chunk(brick.brick) != brick.now;
}

bool Stroke::Work::empty() {
  paint_waiting();
  return std::all_of(bricks_.begin(), bricks_.end(), [&](const Brick& brick) { return !differs(brick); });
}

const SkinWeights& Stroke::Work::weights() {
  paint_waiting();
  if (shown_.chunk_count() == 0) shown_ = *weights_;
  for (Brick& brick : bricks_) {
    if (brick.now.empty()) continue;
    brick.shown = differs(brick);
    if (brick.shown) shown_.set_chunk(brick.brick, brick.now);
    else shown_.share_chunk(brick.brick, *weights_);
    brick.now = SkinWeights::Influences();  // by assignment, since this also frees the memory
  }
  return shown_;
}

SkinWeights Stroke::Work::finish() {
  weights();
  bricks_.clear();
  slot_of_.assign(slot_of_.size(), -1);
  return std::exchange(shown_, SkinWeights());
}

std::int64_t Stroke::Work::memory_bytes() const {
  std::int64_t bytes = reach_.memory_bytes() + std::ssize(slot_of_) * 4 +
                       static_cast<std::int64_t>(bricks_.capacity() * sizeof(Brick)) +
                       static_cast<std::int64_t>(next_.capacity() * sizeof(Influence));
  bytes += shown_.chunk_count() * static_cast<std::int64_t>(sizeof(std::shared_ptr<const SkinWeights::Chunk>));
  for (const Brick& brick : bricks_) {
    bytes += static_cast<std::int64_t>(brick.now.capacity() * sizeof(Influence));
    if (brick.shown)
      bytes += shown_.chunk(brick.brick).heap_bytes() + static_cast<std::int64_t>(sizeof(SkinWeights::Chunk));
    bytes += static_cast<std::int64_t>(2 * (brick.cover[0].capacity() + brick.cover[1].capacity()) +
                                       8 * brick.blocked.capacity());
  }
  return bytes;
}

Stroke::Stroke(const WeightedBody& body, std::shared_ptr<const SkinWeights> weights, StrokeSettings settings)
    : work_(std::make_unique<Work>(body, std::move(weights), std::move(settings))) {}
Stroke::~Stroke() = default;
Stroke::Stroke(Stroke&&) noexcept = default;
Stroke& Stroke::operator=(Stroke&&) noexcept = default;

void Stroke::to(const glm::dvec3& point, double pressure) { work_->to(point, pressure); }
void Stroke::lift() { work_->lift(); }
void Stroke::dab(const glm::dvec3& centre, double pressure) { work_->dab(centre, pressure); }
SkinWeights::Influences Stroke::chunk(std::int64_t brick) const { return work_->chunk(brick); }
const SkinWeights& Stroke::original() const { return work_->original(); }
std::vector<int> Stroke::take_dirty() { return work_->take_dirty(); }
bool Stroke::empty() const { return work_->empty(); }
int Stroke::dab_count() const { return work_->dab_count; }
SkinWeights Stroke::weights() const { return work_->weights(); }
SkinWeights Stroke::finish() { return work_->finish(); }
std::int64_t Stroke::memory_bytes() const { return work_->memory_bytes(); }

std::int64_t Stroke::blocked_count() const {
  std::int64_t all = 0;
  for (const std::int64_t times : work_->blocked_by()) all += times;
  return all;
}

int Stroke::blocked_by() const {
  const std::vector<std::int64_t>& blocked = work_->blocked_by();
  const auto most = std::max_element(blocked.begin(), blocked.end());
  return most != blocked.end() && *most > 0 ? static_cast<int>(most - blocked.begin()) : -1;
}

}  // namespace limber
