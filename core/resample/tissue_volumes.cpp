// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/resample/tissue_volumes.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <set>
#include <unordered_map>
#include <utility>

namespace limber {

namespace {

// A voxel keeps its label if its membership of its own tissue exceeds that of the new tissue by at least this number.
constexpr double kMostSure = 0.8;
// Cost that is added to the cost of every move (change of a voxel's label), so that paths over few tissues are
// preferred.
constexpr double kEach = 0.1;
// Connected components with fewer voxels than this are not changed. Only components of 50 voxels or more are counted,
// and a smaller component that changes its size could cross this limit and change the count.
constexpr std::int64_t kFrozen = 2 * kSmallestPart;
// Upper limit on the rounds. Each round tries again the moves that were not possible in the previous one.
constexpr int kRounds = 8;
const std::array<glm::ivec3, 6> kFaces{{{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}}};

// The possible moves (changes of a voxel's label) from one tissue to another one.
struct Border {
  std::vector<BorderMove> moves;    // possible moves, in ascending order of cost
  size_t next = 0;                  // index of the next move to try
  std::vector<BorderMove> refused;  // moves that are not possible now, but may be after other moves
};

class Exchange {
 public:
  Exchange(LabelVolume& posed, const std::map<Label, std::int64_t>& wanted, const LabelSet& soft, const LabelSet& skin)
      : posed_(posed),
        soft_(soft),
        skin_(skin),
        parts_(connected_components(posed, nullptr, &soft)),
        missing_(wanted) {
    for (const auto& run : parts_.runs) has_skin_ |= skin_[run.label] != 0;
    for (const auto& run : parts_.runs)
      if (const auto found = missing_.find(run.label); found != missing_.end()) found->second -= run.end - run.begin;
    missing_[0] = -std::accumulate(missing_.begin(), missing_.end(), std::int64_t{0},
                                   [](std::int64_t sum, const auto& tissue) { return sum + tissue.second; });
  }

  void add(const BorderMove& move) {
    borders_[{move.from, move.to}].moves.push_back(move);
    if (move.to == 0 && skin_[move.from])
      for (const glm::ivec3& step : kFaces)
        if (const Label under = posed_.at_or_air(voxel_at(posed_.grid, move.at) + step);
            under && soft_[under] && !skin_[under])
          borders_[{under, 0}].moves.push_back({move.at, under, 0, move.cost});
  }

  // Adds the moves that turn air beside soft tissue into tissue, so that the body may grow. A move is cheaper the more
  // of the air voxel's 26 neighbours are tissue.
  void add_air() {
    const glm::ivec3 size = posed_.grid.size;
    glm::ivec3 v;
    for (v.z = 0; v.z < size.z; ++v.z)
      for (v.y = 0; v.y < size.y; ++v.y)
        for (v.x = 0; v.x < size.x; ++v.x) {
          if (posed_.at(v)) continue;
          std::set<Label> gains;
          for (const glm::ivec3& step : kFaces) {
            const Label beside = posed_.at_or_air(v + step);
            if (!may_meet_air(beside)) continue;
            gains.insert(beside);
            if (skin_[beside])
              for (const glm::ivec3& below : kFaces)
                if (const Label under = posed_.at_or_air(v + step + below); under && soft_[under]) gains.insert(under);
          }
          if (gains.empty()) continue;
          const auto around = std::count_if(neighbours().begin(), neighbours().end(),
                                            [&](const glm::ivec3& step) { return posed_.at_or_air(v + step) != 0; });
          for (const Label label : gains) add({posed_.grid.index(v), 0, label, 1 - float(around) / 26});
        }
  }

  TissueVolumes run() {
    bool new_layer = true, moved = true;
    for (int round = 0; round < kRounds && (moved || new_layer); ++round) {
      if (new_layer && missing_.at(0) < 0) add_air();
      moved = exchange();
      // Adds the next layer of air voxels only after no move into the previous layer is possible any more.
      new_layer = !moved && !new_layer;
      if (new_layer) std::erase_if(borders_, [](const auto& border) { return border.first.first == 0; });
    }
    std::erase_if(missing_, [](const auto& tissue) { return tissue.first == 0 || tissue.second == 0; });
    return {changed_, missing_};
  }

 private:
  // The change of one voxel's label. A move has one change, or two where skin moves with the tissue under it.
  struct Change {
    std::int64_t at;
    Label to;
  };
  using Changes = std::vector<Change>;
  using Way = std::vector<Label>;

  // Makes every possible move, along the cheapest paths first. Returns false if no move was possible.
  bool exchange() {
    for (auto& [_, border] : borders_)
      std::sort(border.moves.begin(), border.moves.end(), [](const BorderMove& a, const BorderMove& b) {
        return a.cost != b.cost ? a.cost < b.cost : std::pair(shuffled(a.at), a.at) < std::pair(shuffled(b.at), b.at);
      });
    bool moved = false;
    while (const auto way = cheapest_way()) moved |= go(*way);
    for (auto& [_, border] : borders_) {
      border.moves = std::exchange(border.refused, {});
      border.next = 0;
    }
    return moved;
  }

  // Returns the cheapest path from a tissue with surplus voxels to a tissue that lacks voxels; none: there is no path.
  // Uses the algorithm of Bellman and Ford, since the graph has only about a dozen nodes (tissues).
  std::optional<Way> cheapest_way() {
    struct Step {
      double cost;
      Label from;
    };
    std::map<Label, Step> reached;
    for (const auto& [label, missing] : missing_)
      if (missing < 0) reached[label] = {0, label};
    if (reached.empty()) return std::nullopt;

    std::vector<std::pair<std::pair<Label, Label>, double>> open;
    for (auto& [ends, border] : borders_)
      if (const std::optional<float> cost = next_cost(border)) open.emplace_back(ends, *cost + kEach);
    for (bool shorter = true; shorter;) {
      shorter = false;
      for (const auto& [ends, cost] : open) {
        const auto from = reached.find(ends.first);
        if (from == reached.end()) continue;
        const double sum = from->second.cost + cost;
        const auto to = reached.find(ends.second);
        if (to != reached.end() && to->second.cost <= sum) continue;
        reached[ends.second] = {sum, ends.first};
        shorter = true;
      }
    }

    std::optional<Label> best;
    for (const auto& [label, step] : reached)
      if (const auto found = missing_.find(label);
          found != missing_.end() && found->second > 0 && (!best || step.cost < reached.at(*best).cost))
        best = label;
    if (!best) return std::nullopt;
    Way way{*best};
    while (reached.at(way.back()).from != way.back()) way.push_back(reached.at(way.back()).from);
    std::reverse(way.begin(), way.end());
    return way;
  }

  std::optional<float> next_cost(Border& border) {
    for (; border.next < border.moves.size(); ++border.next) {
      const BorderMove& move = border.moves[border.next];
      // Skips the move if an earlier one has changed the voxel's label.
      if (move.to != 0 && posed_.voxels[move.at] != move.from) continue;
      if (!changes(move).empty()) return move.cost;
      border.refused.push_back(move);
    }
    return std::nullopt;
  }

  bool go(const Way& way) {
    bool moved = false;
    for (size_t i = 0; i + 1 < way.size(); ++i) {
      Border& border = borders_.at({way[i], way[i + 1]});
      // Ends the path early if an earlier move of the path has made the next one impossible. The current tissue then
      // keeps the voxel.
      if (!next_cost(border)) break;
      const BorderMove move = border.moves[border.next++];
      for (const Change& change : changes(move)) make(change);
      ++missing_[move.from];
      --missing_[move.to];
      moved = true;
    }
    return moved;
  }

  void make(const Change& change) {
    const Label was = posed_.voxels[change.at];
    const glm::ivec3 v = voxel_at(posed_.grid, change.at);
    if (was) --parts_.voxels[part_of(v)];
    if (change.to) {
      const int part = *part_beside(v, change.to);
      part_of_changed_[change.at] = part;
      ++parts_.voxels[part];
    }
    posed_.voxels[change.at] = change.to;
    ++changed_;
  }

  int part_of(const glm::ivec3& v) const {
    const auto changed = part_of_changed_.find(posed_.grid.index(v));
    return changed != part_of_changed_.end() ? changed->second : component_at(parts_, posed_, v);
  }

  std::optional<int> part_beside(const glm::ivec3& v, Label label) const {
    for (const glm::ivec3& step : neighbours())
      if (posed_.at_or_air(v + step) == label) return part_of(v + step);
    return std::nullopt;
  }

  // Returns true if voxels of a tissue may change from air or to air. On a body with skin only skin may do this: flesh
  // that touches air there is a cut surface or a nail, and stays as it is.
  bool may_meet_air(Label label) const { return has_skin_ ? skin_[label] != 0 : label && soft_[label]; }

  // Returns the label changes that a move consists of. The list is empty if the move is not possible, because it would
  // tear or join a tissue, open the skin or enclose air.
  Changes changes(const BorderMove& move) {
    const glm::ivec3 v = voxel_at(posed_.grid, move.at);
    if (move.from == 0) return grow(v, move.to);
    if (move.to == 0) return shrink(v, move.from);
    return may_change(v, move.to) ? Changes{{move.at, move.to}} : Changes{};
  }

  // Returns true if a voxel may change from its soft tissue to another. Where the voxel touches air, skin stays skin
  // and flesh stays flesh.
  bool may_change(const glm::ivec3& v, Label to) const {
    const Label from = posed_.at(v);
    return !(touches_air(posed_, v) && skin_[from] != skin_[to]) && may_lose(v) && may_gain(v, to);
  }

  bool may_lose(const glm::ivec3& v) const {
    return is_simple_point(posed_, v) && parts_.voxels[part_of(v)] >= kFrozen;
  }

  bool may_gain(const glm::ivec3& v, Label label) const {
    return can_join(posed_, v, label) && parts_.voxels[*part_beside(v, label)] >= kFrozen;
  }

  // Returns the changes by which the tissue `gain` grows by one voxel and air voxel v is filled. If skin lies between v
  // and `gain`, v becomes skin, and the skin voxel under v becomes `gain`. The list is empty if this is not possible.
  Changes grow(const glm::ivec3& v, Label gain) {
    if (!air_can_change(posed_, v)) return {};
    for (const glm::ivec3& step : kFaces) {
      const glm::ivec3 under = v + step;
      const Label beside = posed_.at_or_air(under);
      if (!may_meet_air(beside) || !may_gain(v, beside)) continue;
      if (beside == gain) return {{posed_.grid.index(v), gain}};
      if (!skin_[beside]) continue;
      posed_.at(v) = beside;
      const bool fits = !touches_air(posed_, under) && may_lose(under) && may_gain(under, gain);
      posed_.at(v) = 0;
      if (fits) return {{posed_.grid.index(v), beside}, {posed_.grid.index(under), gain}};
    }
    return {};
  }

  // Returns the changes by which the tissue `loss` shrinks by one voxel and voxel v becomes air. If v is skin over
  // `loss`, the voxel of `loss` under v becomes skin. The list is empty if this is not possible.
  Changes shrink(const glm::ivec3& v, Label loss) {
    const Label own = posed_.at(v);
    if (!may_meet_air(own) || !touches_air(posed_, v) || !air_can_change(posed_, v) || !may_lose(v)) return {};
    std::vector<glm::ivec3> laid_bare;
    for (const glm::ivec3& step : kFaces)
      if (const Label beside = posed_.at_or_air(v + step); beside && beside != own) laid_bare.push_back(v + step);
    if (own == loss) return laid_bare.empty() ? Changes{{posed_.grid.index(v), 0}} : Changes{};
    if (!skin_[own] || laid_bare.size() != 1 || posed_.at(laid_bare[0]) != loss) return {};
    posed_.at(v) = 0;
    const bool fits = may_lose(laid_bare[0]) && may_gain(laid_bare[0], own);
    posed_.at(v) = own;
    // The voxel under the skin voxel changes first, so that it joins the skin voxel's component. Then the skin voxel
    // becomes air.
    return fits ? Changes{{posed_.grid.index(laid_bare[0]), own}, {posed_.grid.index(v), 0}} : Changes{};
  }

  LabelVolume& posed_;
  const LabelSet &soft_, &skin_;
  bool has_skin_ = false;
  // Connected components: their sizes are kept up to date, but their voxel runs are those of the initial volume.
  Components parts_;
  std::unordered_map<std::int64_t, int> part_of_changed_;  // current component of each changed voxel, by voxel index
  std::map<Label, std::int64_t> missing_;  // voxels that each tissue lacks; the entry of air (0) balances the sum
  std::map<std::pair<Label, Label>, Border> borders_;  // key: (tissue that loses a voxel, tissue that gains it)
  std::int64_t changed_ = 0;
};

}  // namespace

void add_moves(const LabelVolume& posed, const glm::ivec3& voxel, const LabelSampler& sampler, const glm::dvec3& rest,
               const LabelSet& soft, std::vector<BorderMove>& moves) {
  static const LabelSet every(65536, 1);
  const Label label = posed.at(voxel);
  const LabelSampler::Memberships found = sampler.memberships(rest, every);
  double own = 0, body = 0;
  for (int k = 0; k < found.count; ++k) {
    body += found.share[k];
    if (found.label[k] == label) own = found.share[k];
  }
  const std::int64_t at = posed.grid.index(voxel);
  const auto add = [&](Label to, double share) {
    if (own - share < kMostSure) moves.push_back({at, label, to, static_cast<float>(std::max(own - share, 0.0))});
  };
  const auto is_beside = [&](Label other) {
    return std::any_of(kFaceNeighbours.begin(), kFaceNeighbours.end(),
                       [&](const glm::ivec3& step) { return posed.at_or_air(voxel + step) == other; });
  };
  for (int k = 0; k < found.count; ++k)
    if (found.label[k] != label && soft[found.label[k]] && is_beside(found.label[k]))
      add(found.label[k], found.share[k]);
  if (touches_air(posed, voxel)) add(0, 1 - body);
}

TissueVolumes keep_tissue_volumes(LabelVolume& posed, const std::map<Label, std::int64_t>& wanted,
                                  const std::vector<BorderMove>& moves, const LabelSet& soft, const LabelSet& skin) {
  Exchange exchange(posed, wanted, soft, skin);
  for (const BorderMove& move : moves) exchange.add(move);
  return exchange.run();
}

}  // namespace limber
