// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/resample/organ_volumes.h"

#include <algorithm>
#include <cmath>
#include <unordered_map>
#include <vector>

#include "core/volume/label_runs.h"

namespace limber {

namespace {

// Upper limit on the layers of voxels that one pass adds to an organ's surface or removes from it.
constexpr int kLayers = 6;
// Connected components with fewer voxels than this are not changed. Only components of 50 voxels or more are counted,
// and a smaller component that changes its size could cross this limit and change the count.
constexpr std::int64_t kFrozen = 2 * kSmallestPart;
// Number of passes over all organs. An organ that gave voxels in the first pass may be too small afterwards.
constexpr int kRounds = 2;

class Organs {
 public:
  Organs(LabelVolume& posed, const std::map<Label, std::int64_t>& wanted, const LabelSet& soft, const LabelSet& skin)
      : posed_(posed),
        wanted_(wanted),
        soft_(soft),
        skin_(skin),
        parts_(connected_components(posed, nullptr, &soft)),
        has_(65536),
        box_(65536) {
    for_each_tissue_voxel({glm::ivec3(0), posed.grid.size - 1}, [&](const glm::ivec3& v, const Label* at) {
      ++has_[*at];
      box_[*at].low = glm::min(box_[*at].low, v);
      box_[*at].high = glm::max(box_[*at].high, v);
    });
  }

  std::map<Label, std::int64_t> run() {
    std::vector<std::pair<double, Label>> order;  // (-relative error of the volume, organ), the largest error first
    for (const auto& [label, voxels] : wanted_)
      if (off(label) != 0) order.emplace_back(-std::abs(double(off(label))) / double(voxels), label);
    std::sort(order.begin(), order.end());
    std::map<Label, std::int64_t> before;
    for (const auto& [_, label] : order) before[label] = has_[label];
    for (int round = 0; round < kRounds; ++round)
      for (const auto& [_, label] : order)
        for (int layer = 0; layer < kLayers && off(label) != 0 && move_surface(label); ++layer) {
        }
    for (auto& [label, voxels] : before) voxels = has_[label] - voxels;
    std::erase_if(before, [](const auto& each) { return each.second == 0; });
    return before;
  }

 private:
  struct Box {
    glm::ivec3 low{INT32_MAX}, high{INT32_MIN};
  };
  struct Candidate {
    int around;  // number of the 26 neighbours that belong to the organ
    std::uint64_t shuffle;
    glm::ivec3 voxel;
  };

  std::int64_t least(Label label) const { return std::llround(std::ceil(double(wanted_.at(label)) * (1 - kMostOff))); }
  std::int64_t most(Label label) const { return std::llround(std::floor(double(wanted_.at(label)) * (1 + kMostOff))); }
  // Returns the number of voxels by which an organ is below its allowed range of volumes; negative: above it; 0:
  // within.
  std::int64_t off(Label label) const {
    return has_[label] < least(label)  ? least(label) - has_[label]
           : has_[label] > most(label) ? most(label) - has_[label]
                                       : 0;
  }
  // Calls body(voxel, pointer to its label) for every tissue voxel of a box, x fastest.
  template <class Body>
  void for_each_tissue_voxel(const Box& box, const Body& body) const {
    glm::ivec3 v;
    for (v.z = box.low.z; v.z <= box.high.z; ++v.z)
      for (v.y = box.low.y; v.y <= box.high.y; ++v.y) {
        const Label* row = &posed_.voxels[posed_.grid.index({0, v.y, v.z})];
        for (v.x = box.low.x; v.x <= box.high.x; ++v.x)
          if (row[v.x]) body(v, row + v.x);
          else v.x = end_of_air(row, v.x, box.high.x + 1) - 1;
      }
  }

  // Returns true if is(label) is true for at least one face neighbour of voxel v. Voxels outside the grid are air.
  //   at  pointer to the label of v in posed_
  template <class Is>
  bool has_beside(const glm::ivec3& v, const Label* at, const Is& is) const {
    const glm::ivec3 size = posed_.grid.size;
    const bool inside = glm::all(glm::greaterThan(v, glm::ivec3(0))) && glm::all(glm::lessThan(v, size - 1));
    const std::int64_t row = size.x, slice = row * size.y;
    if (inside) return is(at[-1]) || is(at[1]) || is(at[-row]) || is(at[row]) || is(at[-slice]) || is(at[slice]);
    return std::any_of(kFaceNeighbours.begin(), kFaceNeighbours.end(),
                       [&](const glm::ivec3& step) { return is(posed_.at_or_air(v + step)); });
  }

  bool is_flesh(Label label) const { return label && soft_[label] && !skin_[label]; }
  bool can_give(Label label) const { return is_flesh(label) && wanted_.contains(label) && has_[label] > least(label); }
  bool can_take(Label label) const { return is_flesh(label) && wanted_.contains(label) && has_[label] < most(label); }

  // Adds one layer of voxels to an organ's surface or removes one, but not more voxels than the organ needs. Returns
  // false if no voxel could change.
  bool move_surface(Label label) {
    const bool grows = off(label) > 0;
    std::vector<Candidate> surface = surface_of(label, grows);
    // A growing organ fills its hollows first; a shrinking organ loses its protruding voxels first.
    std::sort(surface.begin(), surface.end(), [&](const Candidate& a, const Candidate& b) {
      if (a.around != b.around) return grows ? a.around > b.around : a.around < b.around;
      return a.shuffle < b.shuffle;
    });
    bool moved = false;
    for (const Candidate& each : surface) {
      if (off(label) == 0) break;
      moved |= grows ? give(each.voxel, label) : give(each.voxel, taker(each.voxel, label));
    }
    return moved;
  }

  // Returns the flesh voxels just outside an organ that grows, or the surface voxels of an organ that shrinks.
  std::vector<Candidate> surface_of(Label label, bool grows) {
    std::vector<Candidate> surface;
    Box& box = box_[label];
    box.low = glm::max(box.low - int(grows), glm::ivec3(0));
    box.high = glm::min(box.high + int(grows), posed_.grid.size - 1);
    for_each_tissue_voxel(box, [&](const glm::ivec3& v, const Label* at) {
      if ((*at == label) == grows || !is_flesh(*at)) return;
      const bool at_border = has_beside(
          v, at, [&](Label beside) { return grows ? beside == label : beside != label && is_flesh(beside); });
      if (!at_border) return;
      const auto around = std::count_if(neighbours().begin(), neighbours().end(),
                                        [&](const glm::ivec3& step) { return posed_.at_or_air(v + step) == label; });
      surface.push_back({static_cast<int>(around), shuffled(static_cast<std::uint64_t>(posed_.grid.index(v))), v});
    });
    return surface;
  }

  // Returns the tissue that takes voxel v if the tissue `from` loses it: of the face neighbours' tissues that may grow,
  // the most common; 0: none may grow.
  Label taker(const glm::ivec3& v, Label from) const {
    std::map<Label, int> count;
    for (const glm::ivec3& step : kFaceNeighbours)
      if (const Label beside = posed_.at_or_air(v + step); beside != from && can_take(beside)) ++count[beside];
    Label best = 0;
    for (const auto& [label, faces] : count)
      if (best == 0 || faces > count[best]) best = label;
    return best;
  }

  bool give(const glm::ivec3& v, Label to) {
    const Label from = posed_.at(v);
    if (to == 0 || from == to || !can_give(from) || touches_air(posed_, v) || !is_simple_point(posed_, v) ||
        !can_join(posed_, v, to))
      return false;
    const int leaves = part_of(v), joins = part_beside(v, to);
    if (parts_.voxels[leaves] < kFrozen || parts_.voxels[joins] < kFrozen) return false;
    --parts_.voxels[leaves];
    ++parts_.voxels[joins];
    part_of_changed_[posed_.grid.index(v)] = joins;
    posed_.at(v) = to;
    --has_[from];
    ++has_[to];
    return true;
  }

  int part_of(const glm::ivec3& v) const {
    const auto changed = part_of_changed_.find(posed_.grid.index(v));
    return changed != part_of_changed_.end() ? changed->second : component_at(parts_, posed_, v);
  }

  // Returns the connected component of `label` beside a voxel. At least one neighbour must have the label.
  int part_beside(const glm::ivec3& v, Label label) const {
    const auto step = std::find_if(neighbours().begin(), neighbours().end(),
                                   [&](const glm::ivec3& each) { return posed_.at_or_air(v + each) == label; });
    return part_of(v + *step);
  }

  LabelVolume& posed_;
  const std::map<Label, std::int64_t>& wanted_;
  const LabelSet &soft_, &skin_;
  // Connected components: their sizes are kept up to date, but their voxel runs are those of the initial volume.
  Components parts_;
  std::unordered_map<std::int64_t, int> part_of_changed_;  // current component of each changed voxel, by voxel index
  std::vector<std::int64_t> has_;                          // number of voxels of each tissue, by label
  std::vector<Box> box_;                                   // box around all voxels of each tissue, by label
};

}  // namespace

std::map<Label, std::int64_t> keep_organ_volumes(LabelVolume& posed, const std::map<Label, std::int64_t>& wanted,
                                                 const LabelSet& soft, const LabelSet& skin) {
  return Organs(posed, wanted, soft, skin).run();
}

}  // namespace limber
