// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/resample/air_pockets.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <set>
#include <unordered_map>
#include <unordered_set>

#include "core/resample/skin_at_rest.h"
#include "core/volume/label_runs.h"

namespace limber {

namespace {

struct AirRun {
  int begin, end;  // range [begin, end) of the run's voxels along x
};

// Finds the runs of air voxels along x that have tissue at both ends, and joins runs that share a voxel face. Air
// without tissue at both ends reaches the border of the grid along x, so it is not enclosed.
class AirRuns {
 public:
  explicit AirRuns(const LabelView& volume) : size_(volume.grid.size) {
    rows_.reserve(std::size_t(size_.y) * size_.z + 1);
    std::vector<Label> room;
    for (int z = 0; z < size_.z; ++z)
      for (int y = 0; y < size_.y; ++y) add_row(volume.row(y, z, room));
    rows_.push_back({std::ssize(runs_), 0, 0});
    joined_.resize(runs_.size());
    std::iota(joined_.begin(), joined_.end(), 0);
    is_open_.resize(runs_.size());
    for_each_row_with_runs([&](std::int64_t here, int y, int z) {
      if (y > 0) join_rows(here, row(y - 1, z));
      if (z > 0) join_rows(here, row(y, z - 1));
      open_beside_border(here, y, z);
    });
  }

  std::vector<AirPocket> pockets() {
    for (std::int64_t r = 0; r < std::ssize(runs_); ++r)
      if (is_open_[r]) is_open_[root(r)] = true;
    std::map<std::int64_t, AirPocket> found;
    for_each_row_with_runs([&](std::int64_t here, int y, int z) {
      for (std::int64_t r = rows_[here].first; r < rows_[here + 1].first; ++r)
        if (!is_open_[root(r)])
          for (int x = runs_[r].begin; x < runs_[r].end; ++x) found[root(r)].push_back({x, y, z});
    });
    std::vector<AirPocket> pockets;
    for (auto& [_, pocket] : found) pockets.push_back(std::move(pocket));
    return pockets;
  }

 private:
  struct Row {
    std::int64_t first;  // index in runs_ of the row's first air run
    // Range [begin, end) of the row's tissue along x; (grid size, 0): the row has no tissue.
    int tissue_begin, tissue_end;
  };

  std::int64_t row(int y, int z) const { return y + std::int64_t{size_.y} * z; }

  void add_row(const Label* labels) {
    Row row{std::ssize(runs_), end_of_air(labels, 0, size_.x), 0};
    for (int x = row.tissue_begin; x < size_.x;) {
      const int begin = row.tissue_end = end_of_tissue(labels, x, size_.x);
      x = end_of_air(labels, begin, size_.x);
      if (x < size_.x) runs_.push_back({begin, x});
    }
    rows_.push_back(row);
  }

  std::int64_t root(std::int64_t run) {
    while (joined_[run] != run) run = joined_[run] = joined_[joined_[run]];
    return run;
  }

  void join_rows(std::int64_t a, std::int64_t b) {
    std::int64_t i = rows_[a].first, k = rows_[b].first;
    while (i < rows_[a + 1].first && k < rows_[b + 1].first) {
      if (std::max(runs_[i].begin, runs_[k].begin) < std::min(runs_[i].end, runs_[k].end)) {
        const std::int64_t one = root(i), other = root(k);
        joined_[std::max(one, other)] = std::min(one, other);
      }
      runs_[i].end < runs_[k].end ? ++i : ++k;
    }
  }

  // Marks each air run of a row as open if it touches the border of the grid, or air of a neighbouring row that reaches
  // the border.
  void open_beside_border(std::int64_t here, int y, int z) {
    const bool at_border = y == 0 || z == 0 || y == size_.y - 1 || z == size_.z - 1;
    for (std::int64_t r = rows_[here].first; r < rows_[here + 1].first; ++r) {
      const auto opens = [&](const Row& beside) {
        return runs_[r].begin < beside.tissue_begin || runs_[r].end > beside.tissue_end;
      };
      is_open_[r] = at_border || opens(rows_[row(y - 1, z)]) || opens(rows_[row(y + 1, z)]) ||
                    opens(rows_[row(y, z - 1)]) || opens(rows_[row(y, z + 1)]);
    }
  }

  template <class Body>
  void for_each_row_with_runs(const Body& body) const {
    for (int z = 0; z < size_.z; ++z)
      for (int y = 0; y < size_.y; ++y)
        if (const std::int64_t here = row(y, z); rows_[here].first < rows_[here + 1].first) body(here, y, z);
  }

  glm::ivec3 size_;
  std::vector<Row> rows_;
  std::vector<AirRun> runs_;
  std::vector<std::int64_t> joined_;
  std::vector<bool> is_open_;
};

// Returns the number of rest voxels in the hollow that a posed air pocket comes from. This is the sum over those air
// pockets of the body at rest that touch the rest positions of the posed pocket's walls.
std::int64_t size_at_rest(const AirPocket& pocket, const LabelView& posed, const LabelView& rest,
                          const std::vector<AirPocket>& rest_pockets,
                          const std::unordered_map<std::int64_t, int>& pocket_at_rest, const RestPoint& rest_point) {
  std::set<int> found;
  for (const glm::ivec3& v : pocket)
    for (const glm::ivec3& face : kFaceNeighbours) {
      const glm::ivec3 wall = v + face;
      if (posed.at_or_air(wall) == 0) continue;
      const glm::ivec3 from = glm::ivec3(glm::floor(rest_point(wall) + 0.5));
      for (const glm::ivec3& step : neighbours())
        if (rest.grid.contains(from + step))
          if (const auto at = pocket_at_rest.find(rest.grid.index(from + step)); at != pocket_at_rest.end())
            found.insert(at->second);
    }
  std::int64_t size = 0;
  for (int p : found) size += std::ssize(rest_pockets[p]);
  return size;
}

bool touches_tissue(const LabelView& posed, const glm::ivec3& v) {
  return std::any_of(kFaceNeighbours.begin(), kFaceNeighbours.end(),
                     [&](const glm::ivec3& face) { return posed.at_or_air(v + face) != 0; });
}

// Returns the label that fills an air voxel at a pocket's border: the flesh that is most common within two voxels. If
// there is no flesh, the label is the soft tissue that is most common among the 26 neighbours.
Label flesh_behind(const LabelView& posed, const glm::ivec3& v, const LabelSet& flesh, const LabelSet& soft) {
  for (int reach : {1, 2})
    if (const Label found = most_common_around(posed, v, reach, flesh)) return found;
  return most_common_around(posed, v, 1, soft);
}

// Returns the label of the skin on more than half of the voxel faces around an air pocket; 0: there is no such skin.
Label lining_of(const AirPocket& pocket, const LabelView& posed, const LabelSet& flesh, const LabelSet& soft) {
  std::map<Label, std::int64_t> faces;
  std::int64_t walls = 0;
  for (const glm::ivec3& v : pocket)
    for (const glm::ivec3& face : kFaceNeighbours)
      if (const Label wall = posed.at_or_air(v + face)) {
        ++walls;
        if (soft[wall] && !flesh[wall]) ++faces[wall];
      }
  for (const auto& [skin, count] : faces)
    if (2 * count > walls) return skin;
  return 0;
}

// Fills an air pocket with tissue from the walls inwards, layer by layer, until `kept` voxels of air are left.
void fill(const LabelEdit& posed, AirPocket pocket, std::int64_t kept, const LabelSet& flesh, const LabelSet& soft,
          std::vector<glm::ivec3>& filled) {
  while (std::ssize(pocket) > kept) {
    AirPocket inner;
    std::vector<std::pair<glm::ivec3, Label>> layer;
    for (const glm::ivec3& v : pocket) {
      const bool is_next = std::ssize(pocket) - std::ssize(layer) > kept && touches_tissue(posed, v);
      const Label found = is_next ? flesh_behind(posed, v, flesh, soft) : Label{0};
      if (found) layer.push_back({v, found});
      else inner.push_back(v);
    }
    if (layer.empty()) break;
    for (const auto& [v, label] : layer) {
      posed.at(v) = label;
      filled.push_back(v);
    }
    pocket = std::move(inner);
  }
}

}  // namespace

std::vector<AirPocket> air_pockets(const LabelView& volume) { return AirRuns(volume).pockets(); }

std::vector<glm::ivec3> fill_grown_pockets(LabelEdit posed, const LabelView& rest, const PocketsOfBoth& pockets,
                                           const LabelSet& flesh, const LabelSet& soft, const RestPoint& rest_point) {
  if (pockets.posed.empty()) return {};
  std::unordered_map<std::int64_t, int> pocket_at_rest;
  for (size_t p = 0; p < pockets.rest.size(); ++p)
    for (const glm::ivec3& v : pockets.rest[p]) pocket_at_rest[rest.grid.index(v)] = static_cast<int>(p);
  const double posed_per_rest = rest.grid.voxel_volume() / posed.grid.voxel_volume();
  std::vector<glm::ivec3> filled;
  for (const AirPocket& pocket : pockets.posed) {
    const std::int64_t before = size_at_rest(pocket, posed, rest, pockets.rest, pocket_at_rest, rest_point);
    const Label lining = lining_of(pocket, posed, flesh, soft);
    const auto first = std::ssize(filled);
    fill(posed, pocket, std::llround(posed_per_rest * double(before)), flesh, soft, filled);
    if (lining == 0) continue;
    for (auto v = filled.begin() + first; v != filled.end(); ++v)
      if (touches_air(posed, *v)) posed.at(*v) = lining;
  }
  return filled;
}

Origins origins_of(const LabelView& posed, const std::vector<glm::ivec3>& was_air, const RestPoint& rest_point) {
  const Grid& grid = posed.grid;
  Origins origins;
  std::unordered_set<std::int64_t> waiting;
  for (const glm::ivec3& v : was_air) waiting.insert(grid.index(v));
  for (const glm::ivec3& v : was_air) {
    const auto source = std::find_if(neighbours().begin(), neighbours().end(), [&](const glm::ivec3& step) {
      return posed.at_or_air(v + step) != 0 && !waiting.contains(grid.index(v + step));
    });
    waiting.erase(grid.index(v));
    if (source == neighbours().end()) continue;
    const std::int64_t beside = grid.index(v + *source);
    const auto known = origins.find(beside);
    origins[grid.index(v)] = known != origins.end() ? known->second : Origin{beside, rest_point(v + *source)};
  }
  return origins;
}

}  // namespace limber
