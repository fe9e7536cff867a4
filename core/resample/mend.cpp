// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/resample/mend.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <map>
#include <numeric>
#include <optional>
#include <set>
#include <unordered_map>
#include <unordered_set>

#include "core/volume/components.h"

namespace limber {

namespace {

constexpr int kLongestBridge = 4;  // voxels: a longer one would invent anatomy
constexpr int kAttempts = 32;      // bridges tried for one part, each around the voxels that earlier ones may not take
constexpr int kSamples = 4;        // voxels of a part that are asked where they come from
constexpr int kReach = 8;          // voxels around a rest point within which its tissue is looked for

const std::array<glm::ivec3, 26>& neighbours() {
  static const std::array<glm::ivec3, 26> all = [] {
    std::array<glm::ivec3, 26> steps;
    int count = 0;
    for (int i = 0; i < 27; ++i)
      if (i != 13) steps[count++] = {i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1};
    return steps;
  }();
  return all;
}

// The component of a tissue voxel.
int component_at(const Components& components, const LabelVolume& volume, const glm::ivec3& v) {
  const std::int64_t row = v.y + std::int64_t{volume.grid.size.y} * v.z;
  const auto begin = components.runs.begin() + components.first_run[row], end = components.runs.begin() + components.first_run[row + 1];
  const auto run = std::partition_point(begin, end, [&](const Components::Run& r) { return r.end <= v.x; });
  return run->component;
}

struct Part {
  int component;
  std::int64_t voxels;
};

// Of every label, rising by size.
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

// The 3^3 voxels around a voxel as bits, x fastest; bit 13 is the voxel itself.
constexpr unsigned kAll = (1u << 27) - 1, kCentre = 1u << 13;

// Of every place among the 3^3, the places beside it.
const std::array<unsigned, 27>& beside() {
  static const std::array<unsigned, 27> all = [] {
    std::array<unsigned, 27> places{};
    for (int a = 0; a < 27; ++a)
      for (int b = 0; b < 27; ++b)
        if (std::abs(a % 3 - b % 3) <= 1 && std::abs(a / 3 % 3 - b / 3 % 3) <= 1 && std::abs(a / 9 - b / 9) <= 1) places[a] |= 1u << b;
    return places;
  }();
  return all;
}

// Whether places other than the centre hang together, 26-connected, without it; not when there are none.
bool hang_together(unsigned places) {
  places &= ~kCentre;
  unsigned reached = places & -places;
  for (unsigned fresh = reached; fresh;) {
    unsigned next = 0;
    for (; fresh; fresh &= fresh - 1) next |= beside()[std::countr_zero(fresh)];
    fresh = next & places & ~reached;
    reached |= fresh;
  }
  return places && reached == places;
}

// A voxel that its tissue can spare: away from air, and the tissue around it hangs together without it.
bool can_spare(const LabelVolume& volume, const glm::ivec3& voxel) {
  const glm::ivec3 size = volume.grid.size;
  if (glm::any(glm::lessThan(voxel, glm::ivec3(1))) || glm::any(glm::greaterThan(voxel, size - 2))) return false;
  const Label* at = &volume.voxels[volume.grid.index(voxel)];
  const std::int64_t row = size.x, slice = row * size.y;
  unsigned same = 0, tissue = 0;
  for (int k = 0; k < 27; ++k) {
    const Label label = at[(k % 3 - 1) + row * (k / 3 % 3 - 1) + slice * (k / 9 - 1)];
    same |= unsigned{label == *at} << k;
    tissue |= unsigned{label != 0} << k;
  }
  return tissue == kAll && hang_together(same);
}

class Mending {
 public:
  // `posed` may be `tissue` itself.
  Mending(LabelVolume& posed, const LabelVolume& rest, const LabelVolume& tissue, const LabelSet& soft, const RestPoint& rest_point)
      : posed_(posed), rest_(rest), tissue_(tissue), soft_(soft), in_tissue_(&posed == &tissue), rest_point_(rest_point), of_posed_(connected_components(posed)),
        of_rest_(connected_components(rest)), joined_(of_posed_.voxels.size()) {
    std::iota(joined_.begin(), joined_.end(), 0);
  }

  std::vector<glm::ivec3> run() {
    const auto before = large_parts(of_rest_);
    for (const auto& [label, parts] : large_parts(of_posed_)) {
      const auto was = before.find(label);
      if ((!in_tissue_ || soft_[label]) && was != before.end() && parts.size() > was->second.size())
        mend(label, parts, parts.size() - was->second.size());
    }
    return std::move(bridges_);
  }

 private:
  struct Bridge {
    std::vector<glm::ivec3> voxels;
    int other = -1;  // component
  };

  void mend(Label label, const std::vector<Part>& parts, std::int64_t too_many) {
    find_stretches(label);
    const std::vector<bool> is_torn = torn(label, parts);
    for (size_t i = 0; i + 1 < parts.size() && too_many > 0; ++i) {
      if (!is_torn[i] || joined(parts[i].component) == joined(parts.back().component)) continue;
      barred_.clear();
      for (int attempt = 0; attempt < kAttempts; ++attempt) {
        const std::optional<Bridge> bridge = shortest_bridge(label, parts[i].component);
        if (!bridge) break;
        if (!build(*bridge, label, parts[i].component)) continue;
        --too_many;
        break;
      }
    }
  }

  // Of each part, whether another one comes from the same rest part as some of its voxels.
  std::vector<bool> torn(Label label, const std::vector<Part>& parts) const {
    std::map<int, std::vector<size_t>> of_rest_part;
    for (size_t i = 0; i < parts.size(); ++i) {
      const auto& stretches = stretches_.at(parts[i].component);
      std::set<int> from;
      for (int s = 0; s < kSamples; ++s) {
        const Stretch& at = stretches[stretches.size() * s / kSamples];
        from.insert(rest_part(label, {at.begin, at.y, at.z}));
      }
      for (int rest_part : from) of_rest_part[rest_part].push_back(i);
    }
    std::vector<bool> torn(parts.size(), false);
    for (const auto& [_, pieces] : of_rest_part)
      for (size_t i : pieces) torn[i] = torn[i] || pieces.size() > 1;
    return torn;
  }

  int joined(int component) const {
    while (joined_[component] != component) component = joined_[component];
    return component;
  }

  int component_of(const glm::ivec3& v) const {
    const auto taken = taken_.find(posed_.grid.index(v));
    return taken != taken_.end() ? taken->second : component_at(of_posed_, posed_, v);
  }

  // Breadth first from the whole part; each layer is one voxel of bridge more. Smaller pieces of the tissue are crossed
  // for nothing.
  std::optional<Bridge> shortest_bridge(Label label, int part) const {
    const int own = joined(part);
    std::unordered_map<std::int64_t, std::int64_t> came_from;  // of voxels outside the part
    std::vector<glm::ivec3> layer = voxels_of(own);
    const size_t own_voxels = layer.size();
    for (int length = 0; length <= kLongestBridge && !layer.empty(); ++length) {
      std::vector<glm::ivec3> next;
      for (size_t i = 0; i < layer.size(); ++i) {
        const glm::ivec3 from = layer[i];
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
            if (of_posed_.voxels[component] < kSmallestPart)
              layer.push_back(to);
            else if (same_rest_part(label, came_from, to))
              return path(came_from, label, to, component);
          } else if (length < kLongestBridge && !came_from.contains(at) && can_take(to)) {
            came_from[at] = posed_.grid.index(from);
            next.push_back(to);
          }
        }
      }
      layer = std::move(next);
    }
    return std::nullopt;
  }

  struct Stretch {
    int begin, end, y, z;
  };

  // Where the label lies, by component.
  void find_stretches(Label label) {
    stretches_.clear();
    const int height = posed_.grid.size.y;
    for (std::int64_t row = 0; row + 1 < std::ssize(of_posed_.first_run); ++row)
      for (auto r = of_posed_.first_run[row]; r < of_posed_.first_run[row + 1]; ++r)
        if (const auto& run = of_posed_.runs[r]; run.label == label && of_posed_.voxels[run.component] >= kSmallestPart)
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

  bool can_take(const glm::ivec3& v) const {
    const Label label = tissue_.at(v);
    if (!label || !soft_[label] || barred_.contains(posed_.grid.index(v)) || !can_spare(tissue_, v)) return false;
    return !in_tissue_ || of_posed_.voxels[component_of(v)] != kSmallestPart;
  }

  glm::ivec3 voxel(std::int64_t at) const {
    const glm::ivec3 size = posed_.grid.size;
    return {int(at % size.x), int(at / size.x % size.y), int(at / size.x / size.y)};
  }

  Bridge path(const std::unordered_map<std::int64_t, std::int64_t>& came_from, Label label, const glm::ivec3& end, int component) const {
    Bridge bridge;
    bridge.other = component;
    for (auto step = came_from.find(posed_.grid.index(end)); step != came_from.end(); step = came_from.find(step->second))
      if (const glm::ivec3 v = voxel(step->first); posed_.at(v) != label) bridge.voxels.push_back(v);
    return bridge;
  }

  bool same_rest_part(Label label, const std::unordered_map<std::int64_t, std::int64_t>& came_from, const glm::ivec3& end) const {
    std::int64_t start = posed_.grid.index(end);
    for (auto step = came_from.find(start); step != came_from.end(); step = came_from.find(start)) start = step->second;
    return rest_part(label, voxel(start)) == rest_part(label, end);
  }

  // The rest part nearest to where a posed voxel comes from, -1 when there is none about.
  int rest_part(Label label, const glm::ivec3& posed_voxel) const {
    const glm::dvec3 point = rest_point_(posed_voxel);
    const glm::ivec3 centre(glm::floor(point + 0.5));
    for (int shell = 0; shell <= kReach; ++shell) {
      double nearest = INFINITY;
      glm::ivec3 found(0);
      for (int z = -shell; z <= shell; ++z)
        for (int y = -shell; y <= shell; ++y) {
          const bool face = std::abs(z) == shell || std::abs(y) == shell;
          for (int x = -shell; x <= shell; x += face || shell == 0 ? 1 : 2 * shell) {
            const glm::ivec3 v = centre + glm::ivec3(x, y, z);
            if (rest_.at_or_air(v) != label) continue;
            const glm::dvec3 away = glm::dvec3(v) - point;
            if (const double squared = glm::dot(away, away); squared < nearest) {
              nearest = squared;
              found = v;
            }
          }
        }
      if (nearest < INFINITY) return component_at(of_rest_, rest_, found);
    }
    return -1;
  }

  // Whether a voxel would also join a third part.
  bool joins_another(const glm::ivec3& v, Label label, int part, int other) const {
    return std::any_of(neighbours().begin(), neighbours().end(), [&](const glm::ivec3& step) {
      if (posed_.at_or_air(v + step) != label) return false;
      const int component = joined(component_of(v + step));
      return component != joined(part) && component != joined(other) && of_posed_.voxels[component] >= kSmallestPart;
    });
  }

  // False, and nothing changed, when the voxels of the bridge cannot all be spared together.
  bool build(const Bridge& bridge, Label label, int part) {
    std::vector<std::pair<glm::ivec3, Label>> changed;
    for (const glm::ivec3& v : bridge.voxels) {
      if (!can_take(v) || joins_another(v, label, part, bridge.other)) {
        barred_.insert(posed_.grid.index(v));
        for (const auto& [undone, was] : changed) {
          posed_.at(undone) = was;
          taken_.erase(posed_.grid.index(undone));
          if (was) ++of_posed_.voxels[component_of(undone)];
        }
        return false;
      }
      changed.emplace_back(v, posed_.at(v));
      if (posed_.at(v)) --of_posed_.voxels[component_of(v)];
      posed_.at(v) = label;
      taken_[posed_.grid.index(v)] = joined(part);
    }
    joined_[joined(bridge.other)] = joined(part);
    bridges_.insert(bridges_.end(), bridge.voxels.begin(), bridge.voxels.end());
    return true;
  }

  LabelVolume& posed_;
  const LabelVolume &rest_, &tissue_;
  const LabelSet& soft_;
  const bool in_tissue_;  // voxels are taken from the parts' own volume
  const RestPoint& rest_point_;
  Components of_posed_, of_rest_;                 // as they were before the first bridge, but for the parts' sizes
  std::map<int, std::vector<Stretch>> stretches_; // of the present label's parts
  std::vector<int> joined_;                       // component it was joined to; itself where it was not
  std::unordered_map<std::int64_t, int> taken_;   // component of voxels in bridges
  std::vector<glm::ivec3> bridges_;
  std::unordered_set<std::int64_t> barred_;       // voxels that the present part's bridges may not take
};

}  // namespace

std::int64_t mend(LabelVolume& posed, const LabelVolume& rest, const LabelSet& soft, const RestPoint& rest_point) {
  return std::ssize(Mending(posed, rest, posed, soft, rest_point).run());
}

std::vector<glm::ivec3> mend_bones(LabelVolume& posed_bones, const LabelVolume& rest_bones, const LabelVolume& tissue,
                                   const LabelSet& soft, const RestPoint& rest_point) {
  return Mending(posed_bones, rest_bones, tissue, soft, rest_point).run();
}

}  // namespace limber
