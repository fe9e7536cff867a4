// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/report/metrics.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>

#include "core/base/parallel.h"
#include "core/report/voxel_pieces.h"

namespace limber {

namespace {
constexpr double kSameVoxel = 0.01;  // two voxel volumes count as equal if their relative difference is smaller
constexpr int kSmallest = 50;        // connected components of fewer voxels are not counted
constexpr int kLabels = std::numeric_limits<Label>::max() + 1;

// Union-find over voxel runs: each set holds connected runs. The root of a set holds the set's number of voxels and its
// label.
class Components {
 public:
  int add(Label label) {
    parent_.push_back(static_cast<int>(parent_.size()));
    voxels_.push_back(0);
    label_.push_back(label);
    return parent_.back();
  }
  int root(int set) {
    while (parent_[set] != set) set = parent_[set] = parent_[parent_[set]];
    return set;
  }
  // Unites the sets that contain a and b, and returns the root. The older set stays the root, so that set 0 always
  // means outside air.
  int unite(int a, int b) {
    a = root(a);
    b = root(b);
    if (a == b) return a;
    const auto [older, younger] = std::minmax(a, b);
    parent_[younger] = older;
    voxels_[older] += voxels_[younger];
    return older;
  }
  void count(int set, std::int64_t voxels) { voxels_[root(set)] += voxels; }

  int size() const { return static_cast<int>(parent_.size()); }
  bool is_root(int set) const { return parent_[set] == set; }
  std::int64_t voxels(int set) const { return voxels_[set]; }
  Label label(int set) const { return label_[set]; }

 private:
  std::vector<int> parent_;
  std::vector<std::int64_t> voxels_;
  std::vector<Label> label_;
};

// A run of voxels with equal labels in one row, at x = begin .. end - 1.
struct Run {
  int begin, end;
  Label label;
  int set;
};

// The runs of one slice, row by row.
struct Slice {
  std::vector<Run> runs;
  std::vector<int> first;  // #rows + 1: index of each row's first run
};

// Returns the first x, from `begin` on, whose label is not `label`; `size`: there is none. Compares four labels at
// once.
int end_of_run(const Label* row, int begin, int size, Label label) {
  const std::uint64_t four = std::uint64_t{label} * 0x0001000100010001u;
  int x = begin;
  for (std::uint64_t word; x + 4 <= size; x += 4) {
    std::memcpy(&word, row + x, sizeof word);
    if (word != four) break;
  }
  while (x < size && row[x] == label) ++x;
  return x;
}

// A neighbouring row of the current row. Its runs are stepped through while those of the current row are added.
class Neighbour {
 public:
  Neighbour(const Slice& slice, int row, bool diagonal)
      : next_(slice.runs.data() + slice.first[row]),
        end_(slice.runs.data() + slice.first[row + 1]),
        diagonal_(diagonal) {}

  // Unites `run` with the runs of the same label that it touches. Tissue is connected through faces, edges and corners,
  // air only through faces.
  void join(Run& run, Components& components) {
    const int reach = run.label ? 1 : 0;
    if (diagonal_ && !reach) return;
    while (next_ < end_ && next_->end < run.begin) ++next_;
    for (const Run* other = next_; other < end_ && other->begin < run.end + reach; ++other)
      if (other->label == run.label && other->end + reach > run.begin)
        run.set = run.set < 0 ? components.root(other->set) : components.unite(run.set, other->set);
  }

 private:
  const Run *next_, *end_;
  bool diagonal_;  // true: this row shares only edges and corners with the current row
};

constexpr int kOutside = 0;  // the set of all air that is connected with the grid's border

void add_row(const LabelVolume& volume, int y, int z, const Slice& below, Slice& slice, Components& components) {
  const glm::ivec3 size = volume.grid.size;
  const Label* row = volume.voxels.data() + volume.grid.index({0, y, z});
  const bool border_row = y == 0 || z == 0 || y == size.y - 1 || z == size.z - 1;

  std::array<Neighbour, 4> beside{Neighbour(slice, std::max(y - 1, 0), false), Neighbour(below, y, false),
                                  Neighbour(below, std::max(y - 1, 0), true),
                                  Neighbour(below, std::min(y + 1, size.y - 1), true)};
  const std::array<bool, 4> there{y > 0, z > 0, y > 0 && z > 0, y + 1 < size.y && z > 0};
  for (int x = 0; x < size.x;) {
    Run run{x, end_of_run(row, x, size.x, row[x]), row[x], -1};
    x = run.end;
    if (!run.label && (border_row || run.begin == 0 || run.end == size.x)) run.set = kOutside;
    for (int i = 0; i < 4; ++i)
      if (there[i]) beside[i].join(run, components);
    if (run.set < 0) run.set = components.add(run.label);
    components.count(run.set, run.end - run.begin);
    slice.runs.push_back(run);
  }
}

// Adds to `surface`, by label, the numbers of tissue voxels in a slice that share a face with air.
void count_surface(const LabelVolume& volume, int z, const Slice& slice, std::vector<std::int64_t>& surface) {
  const glm::ivec3 size = volume.grid.size;
  const std::vector<Label> air(size.x, 0);
  auto row_or_air = [&](int y, int row_z) {
    const bool there = y >= 0 && row_z >= 0 && y < size.y && row_z < size.z;
    return there ? volume.voxels.data() + volume.grid.index({0, y, row_z}) : air.data();
  };
  for (int y = 0; y < size.y; ++y) {
    const int first = slice.first[y], last = slice.first[y + 1];
    if (last - first == 1 && !slice.runs[first].label) continue;
    const std::array<const Label*, 4> beside{row_or_air(y - 1, z), row_or_air(y + 1, z), row_or_air(y, z - 1),
                                             row_or_air(y, z + 1)};
    for (int r = first; r < last; ++r) {
      const Run& run = slice.runs[r];
      if (!run.label) continue;
      std::int64_t open = 0;
      for (int x = run.begin; x < run.end; ++x) open += !beside[0][x] | !beside[1][x] | !beside[2][x] | !beside[3][x];
      auto closed_across = [&](int x) { return beside[0][x] && beside[1][x] && beside[2][x] && beside[3][x]; };
      const bool open_before = r == first || !slice.runs[r - 1].label;
      const bool open_after = r + 1 == last || !slice.runs[r + 1].label;
      if (run.end - run.begin == 1) open += (open_before || open_after) && closed_across(run.begin);
      else open += (open_before && closed_across(run.begin)) + (open_after && closed_across(run.end - 1));
      surface[run.label] += open;
    }
  }
}

double percent_change(double before, double after) { return before > 0 ? 100 * (after - before) / before : 0; }

// Returns the number of components of a label with at least kSmallest voxels, minus `before`, but at least 0.
// Components with a small gap between them count as connected, since such gaps are no tears: a thin part at another
// position on the grid may get a gap of one voxel, and a gap that one thick slice bridged at rest may become visible.
//   touching  number of such components if only voxels that touch count as connected
int torn_parts(const LabelVolume& after, Label label, int touching, int before) {
  if (touching <= before) return 0;
  std::vector<std::int64_t> voxels;
  for (std::int64_t at = 0; at < std::ssize(after.voxels); ++at)
    if (after.voxels[at] == label) voxels.push_back(at);
  const glm::dvec3& spacing = after.grid.spacing;
  const glm::ivec3 reach = glm::ivec3(std::max({spacing.x, spacing.y, spacing.z}) / spacing + 0.5) + 1;
  const auto pieces = pieces_of(after.grid, voxels, reach);
  const auto large =
      std::count_if(pieces.begin(), pieces.end(), [](const auto& piece) { return std::ssize(piece) >= kSmallest; });
  return std::max(0, static_cast<int>(large) - before);
}

double skin_share(const LabelCensus& census, const TissueTable& tissues) {
  std::int64_t surface = 0, skin = 0;
  for (std::int64_t voxels : census.surface_voxels) surface += voxels;
  for (const Tissue& tissue : tissues.tissues)
    if (tissue.kind == TissueKind::Skin) skin += census.surface_voxels[tissue.label];
  return surface ? double(skin) / double(surface) : 0;
}
}  // namespace

LabelCensus take_census(const LabelVolume& volume, std::int64_t smallest) {
  LabelCensus census{std::vector<std::int64_t>(kLabels), std::vector<int>(kLabels), std::vector<int>(kLabels),
                     std::vector<std::int64_t>(kLabels)};
  const glm::ivec3 size = volume.grid.size;
  Components components;
  components.add(0);
  Slice below, slice;
  below.first.assign(size.y + 1, 0);
  for (int z = 0; z < size.z; ++z) {
    slice.runs.clear();
    slice.first.assign(size.y + 1, 0);
    // The class Neighbour has pointers to the runs of this slice, so their vector must not reallocate.
    slice.runs.reserve(std::int64_t{size.x} * size.y);
    for (int y = 0; y < size.y; ++y) {
      slice.first[y] = static_cast<int>(slice.runs.size());
      add_row(volume, y, z, below, slice, components);
      slice.first[y + 1] = static_cast<int>(slice.runs.size());
    }
    count_surface(volume, z, slice, census.surface_voxels);
    std::swap(below, slice);
  }
  for (int set = 0; set < components.size(); ++set) {
    if (!components.is_root(set)) continue;
    const Label label = components.label(set);
    census.voxels[label] += components.voxels(set);
    census.components[label] += components.voxels(set) >= smallest;
    census.half_components[label] += 2 * components.voxels(set) >= smallest;
    if (label == 0 && set != kOutside) census.enclosed_air_voxels += components.voxels(set);
  }
  return census;
}

VolumeMetrics compare(const LabelVolume& before, const LabelVolume& after, const TissueTable& tissues) {
  std::array<LabelCensus, 2> census;
  parallel_for(2, 1, [&](std::int64_t which, std::int64_t) { census[which] = take_census(which ? after : before); });

  VolumeMetrics metrics;
  const double mm3[] = {before.grid.voxel_volume(), after.grid.voxel_volume()};
  for (int label = 1; label < kLabels; ++label) {
    const std::int64_t voxels[] = {census[0].voxels[label], census[1].voxels[label]};
    if (!voxels[0] && !voxels[1]) continue;
    const Tissue* tissue = tissues.find(static_cast<Label>(label));
    const double grams_per_mm3 = (tissue ? tissue->density : 1.0) / 1000;
    TissueChange change{.label = static_cast<Label>(label)};
    change.file_value = tissue ? tissue->file_value : label;
    change.name = tissue ? tissue->name : "label " + std::to_string(label);
    change.kind = tissue ? tissue->kind : TissueKind::Unknown;
    change.voxels_before = voxels[0];
    change.voxels_after = voxels[1];
    change.mm3_before = voxels[0] * mm3[0];
    change.mm3_after = voxels[1] * mm3[1];
    change.mass_before = change.mm3_before * grams_per_mm3;
    change.mass_after = change.mm3_after * grams_per_mm3;
    change.volume_change_percent = percent_change(change.mm3_before, change.mm3_after);
    change.mass_change_percent = percent_change(change.mass_before, change.mass_after);
    change.components_before = census[0].components[label];
    change.components_after = census[1].components[label];
    if (std::abs(mm3[1] / mm3[0] - 1) < kSameVoxel)
      change.torn_parts =
          torn_parts(after, static_cast<Label>(label), census[1].components[label], census[0].half_components[label]);
    metrics.has_skin |= tissue && tissue->kind == TissueKind::Skin;
    metrics.voxels_before += change.voxels_before;
    metrics.voxels_after += change.voxels_after;
    metrics.mm3_before += change.mm3_before;
    metrics.mm3_after += change.mm3_after;
    metrics.mass_before += change.mass_before;
    metrics.mass_after += change.mass_after;
    metrics.tissues.push_back(change);
  }
  metrics.volume_change_percent = percent_change(metrics.mm3_before, metrics.mm3_after);
  metrics.mass_change_percent = percent_change(metrics.mass_before, metrics.mass_after);
  metrics.enclosed_air_before = census[0].enclosed_air_voxels;
  metrics.enclosed_air_after = census[1].enclosed_air_voxels;
  metrics.trapped_air_voxels = std::max<std::int64_t>(0, metrics.enclosed_air_after - metrics.enclosed_air_before);
  if (metrics.has_skin) {
    metrics.skin_share_before = skin_share(census[0], tissues);
    metrics.skin_share_after = skin_share(census[1], tissues);
  }
  return metrics;
}

}  // namespace limber
