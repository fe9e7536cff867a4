// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/resample/part_bones.h"

#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <unordered_map>

namespace limber {

namespace {

// Number of passes over the voxels at which two components touch. In the first pass only the larger component gives
// voxels to another tissue, in later passes both do.
constexpr int kRounds = 4;

std::map<Label, int> large_parts(const Components& components, const LabelSet& soft) {
  std::vector<Label> label(components.voxels.size());
  for (const auto& run : components.runs) label[run.component] = run.label;
  std::map<Label, int> count;
  for (size_t c = 0; c < label.size(); ++c)
    if (!soft[label[c]] && components.voxels[c] >= kSmallestPart) ++count[label[c]];
  return count;
}

class Parting {
 public:
  Parting(LabelEdit posed, const Components& of_posed, const LabelView& rest, const Components& of_rest,
          const LabelSet& soft, const RestPoint& rest_point)
      : posed_(posed),
        of_posed_(of_posed),
        rest_(rest),
        of_rest_(of_rest),
        soft_(soft),
        rest_point_(rest_point) {}

  std::int64_t run() {
    const auto before = large_parts(of_rest_, soft_);
    std::int64_t changed = 0;
    auto after = large_parts(of_posed_, soft_);
    for (const auto& [label, count] : before)
      if (after[label] < count) changed += part(label);
    return changed;
  }

 private:
  std::int64_t part(Label label) {
    find_fused(label);
    std::int64_t changed = 0;
    // Giving a voxel to another tissue never creates a contact, so voxels that have no contact need not be examined
    // again.
    std::vector<glm::ivec3> touching = std::move(fused_);
    for (int round = 0; round < kRounds && !touching.empty(); ++round) {
      std::vector<glm::ivec3> still;
      for (const glm::ivec3& v : touching) {
        if (posed_.at(v) != label) continue;
        const int other = touched_part(label, v);
        if (other < 0) continue;
        if ((round > 0 || gives(part_of(v), other)) && give(v, label)) ++changed;
        else still.push_back(v);
      }
      touching = std::move(still);
    }
    return changed;
  }

  // Finds the posed components in which several large components of the body at rest (50 voxels or more) have fused,
  // and lists their voxels in fused_.
  void find_fused(Label label) {
    first_of_run_.assign(of_posed_.runs.size(), -1);
    part_of_.clear();
    fused_.clear();
    std::unordered_map<int, std::set<int>> sources;
    std::vector<std::pair<glm::ivec3, int>> voxels;  // each voxel with its posed component
    const int height = posed_.grid.size.y;
    for (std::int64_t row = 0; row + 1 < std::ssize(of_posed_.first_run); ++row)
      for (auto r = of_posed_.first_run[row]; r < of_posed_.first_run[row + 1]; ++r) {
        const auto& run = of_posed_.runs[r];
        if (run.label != label || of_posed_.voxels[run.component] < kSmallestPart) continue;
        first_of_run_[r] = std::ssize(part_of_);
        part_of_.resize(part_of_.size() + run.end - run.begin);
        int* parts = &part_of_[first_of_run_[r]];
        find_sources({run.begin, int(row % height), int(row / height)}, run.end - run.begin, label, parts);
        for (int x = run.begin; x < run.end; ++x) {
          const int part = parts[x - run.begin];
          if (part < 0) continue;
          sources[run.component].insert(part);
          voxels.push_back({{x, int(row % height), int(row / height)}, run.component});
        }
      }
    for (const auto& [v, component] : voxels)
      if (sources[component].size() > 1) fused_.push_back(v);
  }

  // Finds the large component at rest (50 voxels or more) that each voxel of a run along x comes from. Looks up every
  // fourth voxel. If two successive lookups give the same component, the voxels between them are assumed to come from
  // it too.
  void find_sources(const glm::ivec3& first, int count, Label label, int* parts) const {
    constexpr int kStep = 4;
    for (int done = -1; done < count - 1;) {
      const int next = std::min(done + kStep, count - 1);
      parts[next] = source(first + glm::ivec3(next, 0, 0), label);
      for (int i = done + 1; i < next; ++i)
        parts[i] = done >= 0 && parts[done] == parts[next] ? parts[next] : source(first + glm::ivec3(i, 0, 0), label);
      done = next;
    }
  }

  int source(const glm::ivec3& v, Label label) const {
    const int part = nearest_component(of_rest_, rest_, label, rest_point_(v));
    return part >= 0 && of_rest_.voxels[part] >= kSmallestPart ? part : -1;
  }

  // Returns the large component at rest (50 voxels or more) that a voxel of the current label comes from; -1: none.
  int part_of(const glm::ivec3& v) const {
    // Successive calls ask for neighbouring voxels, so the voxel run found last is stored for each of 16 adjacent rows.
    const std::int64_t row = v.y + std::int64_t{posed_.grid.size.y} * v.z;
    LastRun& last = last_runs_[(v.y & 3) + 4 * (v.z & 3)];
    if (last.row != row || of_posed_.runs[last.run].begin > v.x || of_posed_.runs[last.run].end <= v.x) {
      const std::int64_t found = run_at(of_posed_, posed_, v);
      if (found == std::ssize(of_posed_.runs)) return -1;
      last = {row, found};
    }
    const std::int64_t run = last.run;
    if (first_of_run_[run] < 0 || of_posed_.runs[run].begin > v.x) return -1;
    return part_of_[first_of_run_[run] + v.x - of_posed_.runs[run].begin];
  }

  // Returns the component at rest of a neighbour of voxel v that comes from another component than v; -1: there is no
  // such neighbour.
  int touched_part(Label label, const glm::ivec3& v) const {
    const int own = part_of(v);
    for (const glm::ivec3& step : neighbours()) {
      if (posed_.at_or_air(v + step) != label) continue;
      if (const int there = part_of(v + step); there >= 0 && there != own) return there;
    }
    return -1;
  }

  bool gives(int part, int other) const {
    return of_rest_.voxels[part] != of_rest_.voxels[other] ? of_rest_.voxels[part] > of_rest_.voxels[other]
                                                           : part > other;
  }

  int component_of(const glm::ivec3& v) const {
    const auto given = given_.find(posed_.grid.index(v));
    return given != given_.end() ? given->second : component_at(of_posed_, posed_, v);
  }

  bool give(const glm::ivec3& v, Label label) {
    if (!part_can_spare(v, label)) return false;
    std::map<Label, int> around;
    for (const glm::ivec3& step : neighbours())
      if (const Label there = posed_.at_or_air(v + step); there != label && !soft_[there]) ++around[there];
    while (!around.empty()) {
      const auto most = std::max_element(around.begin(), around.end(),
                                         [](const auto& a, const auto& b) { return a.second < b.second; });
      if (const int component = only_component(v, most->first); component >= 0) {
        posed_.at(v) = most->first;
        given_[posed_.grid.index(v)] = component;
        return true;
      }
      around.erase(most);
    }
    return false;
  }

  // Returns true if voxel v is not needed to connect its neighbours that come from the same component at rest.
  bool part_can_spare(const glm::ivec3& v, Label label) const {
    const int own = part_of(v);
    std::array<bool, 27> same{};
    for (int k = 0; k < 27; ++k) {
      const glm::ivec3 at = v + glm::ivec3(k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1);
      same[k] = posed_.at_or_air(at) == label && part_of(at) == own;
    }
    return is_connected_26(same);
  }

  // Returns the posed component of `tissue` that touches voxel v; -1: none does, or two large ones (50 voxels or more)
  // do. If a large and a small component touch v, returns the large one.
  int only_component(const glm::ivec3& v, Label tissue) const {
    int found = -1;
    for (const glm::ivec3& step : neighbours()) {
      if (posed_.at_or_air(v + step) != tissue) continue;
      const int component = component_of(v + step);
      if (component == found) continue;
      const bool is_large = of_posed_.voxels[component] >= kSmallestPart;
      if (found >= 0 && is_large && of_posed_.voxels[found] >= kSmallestPart) return -1;
      if (found < 0 || is_large) found = component;
    }
    return found;
  }

  LabelEdit posed_;
  const Components& of_posed_;
  const LabelView rest_;
  const Components& of_rest_;
  const LabelSet& soft_;
  const RestPoint& rest_point_;
  struct LastRun {
    std::int64_t row = -1, run = 0;
  };
  mutable std::array<LastRun, 16> last_runs_;
  // Index in part_of_ of the first voxel of each run (voxels in a row along x); -1: the run is not in a large component
  // of the current label.
  std::vector<std::int64_t> first_of_run_;
  // Component at rest of each voxel of the runs that have an index in first_of_run_; -1: none.
  std::vector<int> part_of_;
  // Voxels of the posed components in which several large components of the body at rest have fused.
  std::vector<glm::ivec3> fused_;
  // New component of each voxel that was given to another tissue, by voxel index.
  std::unordered_map<std::int64_t, int> given_;
};

}  // namespace

std::int64_t part_bones(LabelEdit posed, const Components& of_posed, const LabelView& rest, const Components& of_rest,
                        const LabelSet& soft, const RestPoint& rest_point) {
  return Parting(posed, of_posed, rest, of_rest, soft, rest_point).run();
}

}  // namespace limber
