// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/resample/preserve_connectivity.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <optional>
#include <set>
#include <unordered_map>
#include <unordered_set>

#include "core/resample/part_bones.h"

namespace limber {

namespace {

// Upper limit on the voxels of a bridge between two components. A longer bridge would create tissue that the anatomy
// does not have.
constexpr int kLongestBridge = 4;
// Upper limit on the voxels of a bridge whose voxels all come from positions inside or beside the tissue at rest.
constexpr int kLongestTrace = 64;
// Upper limit on the rest points (positions at rest) that are computed to find long bridges, since each takes time.
// Once it is reached, long bridges avoid all further voxels.
constexpr std::size_t kTraced = 20000;
// Upper limit on the bridges that are tried for one component. Each new bridge avoids the voxels that the earlier ones
// failed to take.
constexpr int kAttempts = 32;
// Smallest size, in voxels, of a posed component that is enlarged to 50 voxels.
constexpr int kSmallestKept = kSmallestPart / 2;
// Number of voxels of a posed component whose rest points are computed to find where the component comes from.
constexpr int kSamples = 4;

struct Part {
  int component;
  std::int64_t voxels;
};

// Returns the connected components of 50 voxels or more of every label, smallest first.
std::map<Label, std::vector<Part>> large_parts(const Components& components) {
  std::vector<Label> label(components.voxels.size());
  for (const auto& run : components.runs) label[run.component] = run.label;
  std::map<Label, std::vector<Part>> parts;
  for (size_t c = 0; c < components.voxels.size(); ++c)
    if (components.voxels[c] >= kSmallestPart) parts[label[c]].push_back({int(c), components.voxels[c]});
  for (auto& [_, list] : parts)
    std::stable_sort(list.begin(), list.end(), [](const Part& a, const Part& b) { return a.voxels < b.voxels; });
  return parts;
}

class Mending {
 public:
  // Prepares the repair; run() changes the labels of `posed`.
  //   tissue  the posed tissues, from which voxels may be taken; may be the same volume as `posed`
  Mending(LabelEdit posed, Components of_posed, const LabelView& rest, const Components& of_rest,
          const LabelView& tissue, const LabelSet& soft, const RestPoint& rest_point)
      : posed_(posed),
        rest_(rest),
        tissue_(tissue),
        soft_(soft),
        in_tissue_(posed.is_of_same(tissue)),
        rest_point_(rest_point),
        of_posed_(std::move(of_posed)),
        of_rest_(of_rest),
        joined_(of_posed_.voxels.size()) {
    std::iota(joined_.begin(), joined_.end(), 0);
  }

  std::vector<glm::ivec3> run() {
    auto after = large_parts(of_posed_);
    for (const auto& [label, before] : large_parts(of_rest_)) {
      const auto& parts = after[label];
      if (!parts.empty() && parts.size() > before.size()) {
        const std::int64_t too_many = preserve_connectivity(label, parts, parts.size() - before.size());
        if (in_tissue_ && !soft_[label]) trim(label, parts, too_many);
      }
      if (parts.size() < before.size()) grow(label, parts, before.size() - parts.size());
    }
    return std::move(bridges_);
  }

 private:
  struct Bridge {
    std::vector<glm::ivec3> voxels;
    int other = -1;  // component at the other end of the bridge
  };

  // Joins components of a tissue that has `too_many` more large components (50 voxels or more) than at rest. Returns
  // the excess that is left.
  std::int64_t preserve_connectivity(Label label, const std::vector<Part>& parts, std::int64_t too_many) {
    find_stretches(label);
    const std::vector<bool> is_torn = torn(label, parts);
    for (size_t i = 0; i + 1 < parts.size() && too_many > 0; ++i) {
      if (!is_torn[i] || joined(parts[i].component) == joined(parts.back().component)) continue;
      barred_.clear();
      if (bridge_from(label, parts[i].component, false) || bridge_from(label, parts[i].component, true)) --too_many;
    }
    return too_many;
  }

  // Joins a component to another component of its tissue by a bridge of voxels. Returns false if no bridge is possible.
  //   along_trace  true: allows a longer bridge if all its voxels come from positions inside or beside the tissue
  bool bridge_from(Label label, int part, bool along_trace) {
    for (int attempt = 0; attempt < kAttempts; ++attempt) {
      const std::optional<Bridge> bridge = shortest_bridge(label, part, along_trace);
      if (!bridge) return false;
      if (build(*bridge, label, part)) return true;
    }
    return false;
  }

  // Returns, for each posed component, true if another posed component comes from the same component at rest.
  std::vector<bool> torn(Label label, const std::vector<Part>& parts) const {
    std::map<int, std::vector<size_t>> of_rest_part;
    for (size_t i = 0; i < parts.size(); ++i)
      for (int rest_part : sources(label, parts[i].component)) of_rest_part[rest_part].push_back(i);
    std::vector<bool> torn(parts.size(), false);
    for (const auto& [_, pieces] : of_rest_part)
      for (size_t i : pieces) torn[i] = torn[i] || pieces.size() > 1;
    return torn;
  }

  // Returns the components at rest from which a posed component comes, judged from kSamples of its voxels.
  std::set<int> sources(Label label, int part) const {
    const auto& stretches = stretches_.at(part);
    std::set<int> from;
    for (int s = 0; s < kSamples; ++s) {
      const Stretch& at = stretches[stretches.size() * s / kSamples];
      from.insert(rest_part(label, {at.begin, at.y, at.z}));
    }
    return from;
  }

  // Shrinks components of bone tissue that have 50 voxels or more only because of resampling, and fewer at rest: they
  // get fewer than 50.
  void trim(Label label, const std::vector<Part>& parts, std::int64_t too_many) {
    for (size_t i = 0; i + 1 < parts.size() && too_many > 0 && parts[i].voxels < kSmallestPart + kSmallestKept; ++i) {
      const auto from = sources(label, parts[i].component);
      const bool was_small = std::all_of(from.begin(), from.end(), [&](int rest_part) {
        return rest_part >= 0 && of_rest_.voxels[rest_part] < kSmallestPart;
      });
      if (was_small && pare(label, parts[i].component)) --too_many;
    }
  }

  // Gives voxels of a component to other bone tissue until the component has fewer than 50 voxels. Begins with the
  // voxels that touch the other tissue most. Returns false if no voxel can be given.
  bool pare(Label label, int part) {
    const std::vector<glm::ivec3> voxels = voxels_of(part);
    while (of_posed_.voxels[part] >= kSmallestPart) {
      int most = 0;
      glm::ivec3 best(0);
      Label taker = 0;
      for (const glm::ivec3& v : voxels) {
        if (posed_.at(v) != label || !is_simple_point(posed_, v)) continue;
        std::map<Label, int> touches;
        for (const glm::ivec3& step : neighbours())
          if (const Label there = posed_.at_or_air(v + step); there != label && !soft_[there]) ++touches[there];
        for (const auto& [there, count] : touches)
          if (count > most && only_component(v, there) >= 0) most = count, best = v, taker = there;
      }
      if (most == 0) return false;
      take(best, taker, only_component(best, taker));
      bridges_.push_back(best);
    }
    return true;
  }

  // Returns the component of `tissue` that touches voxel v; -1: none or several do.
  int only_component(const glm::ivec3& v, Label tissue) const {
    int found = -1;
    for (const glm::ivec3& step : neighbours()) {
      if (posed_.at_or_air(v + step) != tissue) continue;
      const int component = joined(component_of(v + step));
      if (found >= 0 && component != found) return -1;
      found = component;
    }
    return found;
  }

  // Enlarges components that have fewer than 50 voxels only because of resampling, and 50 or more at rest: they get 50.
  void grow(Label label, const std::vector<Part>& parts, std::int64_t too_few) {
    find_stretches(label);
    std::set<int> found;
    for (const Part& part : parts) found.merge(sources(label, part.component));
    std::vector<Part> small;
    for (const auto& [component, _] : stretches_)
      if (of_posed_.voxels[component] < kSmallestPart) small.push_back({component, of_posed_.voxels[component]});
    std::stable_sort(small.begin(), small.end(), [](const Part& a, const Part& b) { return a.voxels > b.voxels; });
    barred_.clear();
    for (const Part& part : small) {
      if (too_few == 0) break;
      const auto from = sources(label, part.component);
      const bool was_large = std::any_of(from.begin(), from.end(), [&](int rest_part) {
        return rest_part >= 0 && of_rest_.voxels[rest_part] >= kSmallestPart && !found.contains(rest_part);
      });
      if (!was_large || !fill_up(label, part.component)) continue;
      found.insert(from.begin(), from.end());
      --too_few;
    }
  }

  // Adds voxels of other tissue to a component until the component has 50. Begins with the voxels that touch the
  // component most. Returns false if no voxel can be taken.
  bool fill_up(Label label, int part) {
    std::vector<glm::ivec3> voxels = voxels_of(part);
    while (of_posed_.voxels[part] < kSmallestPart) {
      // For each voxel around the component, the number of the component's voxels that touch it.
      std::map<std::int64_t, int> touches;
      for (const glm::ivec3& v : voxels)
        for (const glm::ivec3& step : neighbours())
          if (posed_.grid.contains(v + step) && posed_.at(v + step) != label) ++touches[posed_.grid.index(v + step)];
      int most = 0;
      std::int64_t best = 0;
      for (const auto& [at, count] : touches)
        if (count > most && can_take(voxel_at(posed_.grid, at), label) &&
            !joins_another(voxel_at(posed_.grid, at), label, part, part)) {
          most = count;
          best = at;
        }
      if (most == 0) return false;
      take(voxel_at(posed_.grid, best), label, part);
      ++of_posed_.voxels[part];
      bridges_.push_back(voxel_at(posed_.grid, best));
      voxels.push_back(voxel_at(posed_.grid, best));
    }
    return true;
  }

  void take(const glm::ivec3& v, Label label, int part) {
    if (posed_.at(v)) --of_posed_.voxels[component_of(v)];
    posed_.at(v) = label;
    taken_[posed_.grid.index(v)] = joined(part);
  }

  int joined(int component) const {
    while (joined_[component] != component) component = joined_[component];
    return component;
  }

  int component_of(const glm::ivec3& v) const {
    const auto taken = taken_.find(posed_.grid.index(v));
    return taken != taken_.end() ? taken->second : component_at(of_posed_, posed_, v);
  }

  // Returns the bridge with the fewest voxels from a component to another large component of its tissue. Breadth-first
  // search from all voxels of the component: each layer adds one voxel to the bridge, and voxels of small components of
  // the tissue cost nothing.
  //   along_trace  true: allows a longer bridge, whose voxels all come from positions inside or beside the tissue at
  //                rest. This repairs a thin sheet that the pose has stretched so far that it misses voxel centres
  std::optional<Bridge> shortest_bridge(Label label, int part, bool along_trace) {
    const int own = joined(part), longest = along_trace ? kLongestTrace : kLongestBridge;
    // Predecessor of each visited voxel outside the component, by voxel index; also set for voxels that cannot be
    // taken.
    std::unordered_map<std::int64_t, std::int64_t> came_from;
    std::vector<glm::ivec3> layer = voxels_of(own);
    const size_t own_voxels = layer.size();
    for (int length = 0; length <= longest && !layer.empty(); ++length) {
      std::vector<glm::ivec3> next;
      for (size_t i = 0; i < layer.size(); ++i) {
        const glm::ivec3 from = layer[i];
        if (length == 0 && i < own_voxels && is_enclosed(posed_, from)) continue;
        for (const glm::ivec3& step : neighbours()) {
          const glm::ivec3 to = from + step;
          if (!posed_.grid.contains(to)) continue;
          const Label there = posed_.at(to);
          const bool within = there == label && length == 0 && i < own_voxels;
          if (within) continue;
          const std::int64_t at = posed_.grid.index(to);
          if (there == label) {
            const int component = joined(component_of(to));
            if (component == own || came_from.contains(at)) continue;
            came_from[at] = posed_.grid.index(from);
            if (of_posed_.voxels[component] < kSmallestPart) layer.push_back(to);
            else if (same_rest_part(label, came_from, to)) return path(came_from, label, to, component);
          } else if (length < longest && came_from.try_emplace(at, posed_.grid.index(from)).second &&
                     can_take(to, label) && (!along_trace || comes_from_beside(to, label))) {
            next.push_back(to);
          }
        }
      }
      layer = std::move(next);
    }
    return std::nullopt;
  }

  bool comes_from_beside(const glm::ivec3& posed_voxel, Label label) {
    const auto [known, is_new] = comes_from_.try_emplace(posed_.grid.index(posed_voxel));
    if (is_new && comes_from_.size() <= kTraced) known->second = glm::ivec3(glm::floor(rest_point_(posed_voxel) + 0.5));
    if (!known->second) return false;
    const glm::ivec3 from = *known->second;
    return rest_.at_or_air(from) == label ||
           std::any_of(neighbours().begin(), neighbours().end(),
                       [&](const glm::ivec3& step) { return rest_.at_or_air(from + step) == label; });
  }

  struct Stretch {
    int begin, end, y, z;
  };

  // Fills stretches_: the voxel runs (along x) of each component of a label that has 25 voxels or more.
  void find_stretches(Label label) {
    stretches_.clear();
    const int height = posed_.grid.size.y;
    for (std::int64_t row = 0; row + 1 < std::ssize(of_posed_.first_run); ++row)
      for (auto r = of_posed_.first_run[row]; r < of_posed_.first_run[row + 1]; ++r)
        if (const auto& run = of_posed_.runs[r]; run.label == label && of_posed_.voxels[run.component] >= kSmallestKept)
          stretches_[run.component].push_back({run.begin, run.end, int(row % height), int(row / height)});
  }

  std::vector<glm::ivec3> voxels_of(int part) const {
    std::vector<glm::ivec3> voxels;
    for (const auto& [component, stretches] : stretches_) {
      if (joined(component) != part) continue;
      for (const Stretch& s : stretches)
        for (int x = s.begin; x < s.end; ++x) voxels.emplace_back(x, s.y, s.z);
    }
    return voxels;
  }

  // Returns true if a tissue may take a voxel. Soft tissue may take voxels of soft tissue, and bone tissue those of
  // bone tissue. If whole rig bones are repaired (mend_bones), they may take voxels of soft tissue.
  bool can_take(const glm::ivec3& v, Label taker) const {
    const Label label = tissue_.at(v);
    const bool may_give = label && (in_tissue_ ? soft_[label] == soft_[taker] : soft_[label] != 0);
    if (!may_give || barred_.contains(posed_.grid.index(v)) || !can_spare_inside(tissue_, v)) return false;
    return !in_tissue_ || of_posed_.voxels[component_of(v)] != kSmallestPart;
  }

  Bridge path(const std::unordered_map<std::int64_t, std::int64_t>& came_from, Label label, const glm::ivec3& end,
              int component) const {
    Bridge bridge;
    bridge.other = component;
    for (auto step = came_from.find(posed_.grid.index(end)); step != came_from.end();
         step = came_from.find(step->second))
      if (const glm::ivec3 v = voxel_at(posed_.grid, step->first); posed_.at(v) != label) bridge.voxels.push_back(v);
    return bridge;
  }

  bool same_rest_part(Label label, const std::unordered_map<std::int64_t, std::int64_t>& came_from,
                      const glm::ivec3& end) const {
    std::int64_t start = posed_.grid.index(end);
    for (auto step = came_from.find(start); step != came_from.end(); step = came_from.find(start)) start = step->second;
    return rest_part(label, voxel_at(posed_.grid, start)) == rest_part(label, end);
  }

  // Returns the component at rest of `label` that is nearest to the rest point of a posed voxel; -1: there is none
  // within 8 voxels.
  int rest_part(Label label, const glm::ivec3& posed_voxel) const {
    return nearest_component(of_rest_, rest_, label, rest_point_(posed_voxel));
  }

  // Returns true if voxel v touches a large component of the label other than `part` and `other`, which v would join to
  // them.
  bool joins_another(const glm::ivec3& v, Label label, int part, int other) const {
    return std::any_of(neighbours().begin(), neighbours().end(), [&](const glm::ivec3& step) {
      if (posed_.at_or_air(v + step) != label) return false;
      const int component = joined(component_of(v + step));
      return component != joined(part) && component != joined(other) && of_posed_.voxels[component] >= kSmallestPart;
    });
  }

  // Gives all voxels of a bridge to the tissue. Changes nothing and returns false if one of them cannot be taken.
  bool build(const Bridge& bridge, Label label, int part) {
    std::vector<std::pair<glm::ivec3, Label>> changed;
    for (const glm::ivec3& v : bridge.voxels) {
      if (!can_take(v, label) || joins_another(v, label, part, bridge.other)) {
        barred_.insert(posed_.grid.index(v));
        for (const auto& [undone, was] : changed) {
          posed_.at(undone) = was;
          taken_.erase(posed_.grid.index(undone));
          if (was) ++of_posed_.voxels[component_of(undone)];
        }
        return false;
      }
      changed.emplace_back(v, posed_.at(v));
      take(v, label, part);
    }
    joined_[joined(bridge.other)] = joined(part);
    bridges_.insert(bridges_.end(), bridge.voxels.begin(), bridge.voxels.end());
    return true;
  }

  LabelEdit posed_;
  const LabelView rest_, tissue_;
  const LabelSet& soft_;
  // True: posed_ and tissue_ are the same volume of tissue labels. False: the labels in posed_ are rig bones.
  const bool in_tissue_;
  const RestPoint& rest_point_;
  Components of_posed_;  // its voxel runs are those before any change; its sizes are kept up to date
  const Components& of_rest_;
  std::map<int, std::vector<Stretch>> stretches_;  // voxel runs of the current label, by component
  std::vector<int> joined_;  // index of the component that each component was joined to, or its own index
  std::unordered_map<std::int64_t, int> taken_;  // new component of each taken voxel, by voxel index
  std::vector<glm::ivec3> bridges_;
  // For each posed voxel that was tried for a long bridge, by voxel index: the voxel at rest from which it comes. Only
  // the first kTraced voxels have a value.
  std::unordered_map<std::int64_t, std::optional<glm::ivec3>> comes_from_;
  // Voxels that bridges of the current component may not take.
  std::unordered_set<std::int64_t> barred_;
};

}  // namespace

std::int64_t preserve_connectivity(LabelEdit posed, const LabelView& rest, const LabelSet& soft,
                                   const RestPoint& rest_point, const MendRows& rows, const MendRows& bone_rows) {
  LabelSet asked(soft.size());
  for (size_t label = 1; label < soft.size(); ++label) asked[label] = !soft[label];
  const std::int64_t parted = part_bones(posed, connected_components(posed, bone_rows.posed, &asked), rest,
                                         connected_components(rest, bone_rows.rest, &asked), soft, rest_point);
  Components of_posed = connected_components(posed, rows.posed);
  // A soft tissue with one large component is not torn. So rest components are computed only for soft tissues with
  // several large components, and for all bone tissues.
  for (const auto& [label, parts] : large_parts(of_posed)) asked[label] |= parts.size() > 1;
  const Components of_rest = connected_components(rest, rows.rest, &asked);
  return parted + std::ssize(Mending(posed, std::move(of_posed), rest, of_rest, posed, soft, rest_point).run());
}

std::vector<glm::ivec3> mend_bones(LabelEdit posed_bones, const LabelView& rest_bones, const LabelView& tissue,
                                   const LabelSet& soft, const RestPoint& rest_point, const MendRows& rows) {
  const Components of_rest = connected_components(rest_bones, rows.rest);
  Components of_posed = connected_components(posed_bones, rows.posed);
  return Mending(posed_bones, std::move(of_posed), rest_bones, of_rest, tissue, soft, rest_point).run();
}

}  // namespace limber
