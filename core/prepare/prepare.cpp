// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/prepare/prepare.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <map>
#include <sstream>

#include "core/base/error.h"
#include "core/base/parallel.h"
#include "core/volume/connected_components.h"

namespace limber {

namespace {
constexpr std::int64_t kMostVoxels = std::int64_t{1} << 33;

// A permutation and flip of the voxel axes. The new voxel v gets the label of the old voxel `old`, where old[axis] is
// v[from[axis]], or size - 1 - v[from[axis]] for a flipped axis.
struct AxisMap {
  std::array<int, 3> from;  // for each old axis, the new axis that it becomes
  std::array<bool, 3> flipped;
};

LabelVolume permuted(const LabelVolume& volume, const Grid& grid, const AxisMap& map) {
  LabelVolume result{grid, ZeroedVector<Label>(volume.voxels.size())};
  parallel_for(grid.size.z, 4, [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t z = begin; z < end; ++z)
      for (int y = 0; y < grid.size.y; ++y)
        for (int x = 0; x < grid.size.x; ++x) {
          const glm::ivec3 v(x, y, z);
          glm::ivec3 old;
          for (int axis = 0; axis < 3; ++axis)
            old[axis] = map.flipped[axis] ? volume.grid.size[axis] - 1 - v[map.from[axis]] : v[map.from[axis]];
          result.at(v) = volume.at(old);
        }
  });
  return result;
}

// Returns the part of the volume in a box of `size` voxels, whose lowest voxel is `low`. Voxels of the box outside the
// volume are air.
LabelVolume boxed(const LabelVolume& volume, const glm::ivec3& low, const glm::ivec3& size) {
  LabelVolume result{volume.grid, {}};
  result.grid.size = size;
  result.grid.origin = world_from_voxel(volume.grid) * glm::dvec3(low);
  result.voxels.resize(result.grid.voxel_count());
  const glm::ivec3 first = glm::max(low, glm::ivec3(0)), end = glm::min(low + size, volume.grid.size);
  parallel_for(std::max(0, end.z - first.z), 4, [&](std::int64_t from, std::int64_t to) {
    for (std::int64_t k = from; k < to; ++k)
      for (int y = first.y; y < end.y; ++y) {
        const glm::ivec3 v(first.x, y, first.z + k);
        std::copy_n(&volume.voxels[volume.grid.index(v)], end.x - first.x, &result.voxels[result.grid.index(v - low)]);
      }
  });
  return result;
}

// Assigns to each of the three orthogonal unit vectors `wanted` the index of the voxel axis that is most nearly
// parallel to it. Each axis is used once: of the six possible assignments, the one with the largest sum of |cosine| is
// returned.
std::array<int, 3> nearest_axes(const glm::dmat3& direction, const std::array<glm::dvec3, 3>& wanted) {
  std::array<int, 3> axes{0, 1, 2}, best = axes;
  double most = -1;
  do {
    double sum = 0;
    for (int i = 0; i < 3; ++i) sum += std::abs(glm::dot(direction[axes[i]], wanted[i]));
    if (sum > most + 1e-12) most = sum, best = axes;
  } while (std::next_permutation(axes.begin(), axes.end()));
  return best;
}

glm::dvec3 direction_of_letter(char letter) {
  switch (letter) {
    case 'L':
    case 'l': return {1, 0, 0};
    case 'R':
    case 'r': return {-1, 0, 0};
    case 'P':
    case 'p': return {0, 1, 0};
    case 'A':
    case 'a': return {0, -1, 0};
    case 'S':
    case 's': return {0, 0, 1};
    case 'I':
    case 'i': return {0, 0, -1};
    default: return {0, 0, 0};
  }
}
}  // namespace

LabelVolume flip(const LabelVolume& volume, int axis) {
  if (axis < 0 || axis > 2) throw Error("there is no such axis", std::to_string(axis), "flip x, y or z");
  const std::array<glm::dvec3, 3> world{glm::dvec3(1, 0, 0), {0, 1, 0}, {0, 0, 1}};
  AxisMap map{{0, 1, 2}, {false, false, false}};
  map.flipped[nearest_axes(volume.grid.direction, world)[axis]] = true;
  return permuted(volume, volume.grid, map);
}

LabelVolume reorient(const LabelVolume& volume, const std::string& code) {
  std::array<glm::dvec3, 3> wanted{};
  glm::dvec3 covered(0);
  for (std::size_t i = 0; i < 3 && code.size() == 3; ++i) {
    wanted[i] = direction_of_letter(code[i]);
    covered += glm::abs(wanted[i]);
  }
  if (covered != glm::dvec3(1))
    throw Error("this is not an orientation", code,
                "name three axes by L or R, P or A, S or I, for example LPS or RAS");

  const Grid& grid = volume.grid;
  // For each new axis, the index of the old axis that becomes it.
  const std::array<int, 3> old_axis = nearest_axes(grid.direction, wanted);
  Grid turned = grid;
  AxisMap map{};
  glm::dvec3 first(0);  // the old voxel that becomes voxel (0, 0, 0)
  for (int i = 0; i < 3; ++i) {
    const int old = old_axis[i];
    const bool back = glm::dot(grid.direction[old], wanted[i]) < 0;
    map.from[old] = i;
    map.flipped[old] = back;
    turned.size[i] = grid.size[old];
    turned.spacing[i] = grid.spacing[old];
    turned.direction[i] = back ? -grid.direction[old] : grid.direction[old];
    if (back) first[old] = grid.size[old] - 1;
  }
  turned.origin = world_from_voxel(grid) * first;
  return permuted(volume, turned, map);
}

LabelVolume crop(const LabelVolume& volume, const glm::ivec3& low, const glm::ivec3& high) {
  const glm::ivec3 first = glm::max(low, glm::ivec3(0)), last = glm::min(high, volume.grid.size - 1);
  if (glm::any(glm::lessThan(last, first)))
    throw Error("there is nothing to crop to", "the box", "move the box over the volume");
  return boxed(volume, first, last - first + 1);
}

LabelVolume crop_to_tissue(const LabelVolume& volume) {
  const glm::ivec3 size = volume.grid.size;
  std::vector<glm::ivec3> lows(size.z, glm::ivec3(INT32_MAX)), highs(size.z, glm::ivec3(-1));
  parallel_for(size.z, 4, [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t z = begin; z < end; ++z)
      for (int y = 0; y < size.y; ++y) {
        const Label* row = &volume.voxels[volume.grid.index({0, y, z})];
        const auto tissue = [](Label label) { return label != 0; };
        const auto first = std::find_if(row, row + size.x, tissue);
        if (first == row + size.x) continue;
        int last = size.x - 1;
        while (row[last] == 0) --last;
        lows[z] = glm::min(lows[z], glm::ivec3(first - row, y, z));
        highs[z] = glm::max(highs[z], glm::ivec3(last, y, z));
      }
  });
  glm::ivec3 low(INT32_MAX), high(-1);
  for (int z = 0; z < size.z; ++z) low = glm::min(low, lows[z]), high = glm::max(high, highs[z]);
  if (high.x < 0) throw Error("there is nothing to crop to", "the volume", "every voxel is air: check the file");
  return boxed(volume, low, high - low + 1);
}

LabelVolume pad(const LabelVolume& volume, int voxels) {
  if (voxels < 0) throw Error("a margin cannot be negative", std::to_string(voxels), "use --crop to remove air");
  const glm::dvec3 size = glm::dvec3(volume.grid.size) + 2.0 * voxels;
  if (size.x * size.y * size.z > static_cast<double>(kMostVoxels))
    throw Error("the padded volume would have more than " + std::to_string(kMostVoxels) + " voxels",
                std::to_string(voxels), "choose a smaller margin");
  return boxed(volume, glm::ivec3(-voxels), volume.grid.size + 2 * voxels);
}

LabelVolume merge_labels(const LabelVolume& volume, Label from, Label into) {
  LabelVolume result = volume;
  parallel_for(std::ssize(result.voxels), 1 << 20, [&](std::int64_t begin, std::int64_t end) {
    std::replace(result.voxels.begin() + begin, result.voxels.begin() + end, from, into);
  });
  return result;
}

LabelVolume drop_specks(const LabelVolume& volume, std::int64_t voxels) {
  const Components components = connected_components(volume);
  const glm::ivec3 size = volume.grid.size;
  const auto is_speck = [&](const Components::Run& run) { return components.voxels[run.component] < voxels; };

  // Neighbouring labels are read from `volume`, which does not change, so that the result does not depend on the order
  // in which specks are removed.
  LabelVolume result = volume;
  // The voxels of each component that is a speck, as runs along x: first voxel and length. Empty for larger components.
  std::vector<std::vector<std::pair<glm::ivec3, int>>> runs_of(components.voxels.size());
  for (std::int64_t row = 0; row + 1 < std::ssize(components.first_run); ++row)
    for (std::int64_t i = components.first_run[row]; i < components.first_run[row + 1]; ++i) {
      const Components::Run& run = components.runs[i];
      if (!is_speck(run)) continue;
      const glm::ivec3 start(run.begin, row % size.y, row / size.y);
      runs_of[run.component].push_back({start, run.end - run.begin});
    }
  std::vector<bool> open(volume.voxels.size(), false);
  for (const auto& runs : runs_of)
    for (const auto& [start, length] : runs) std::fill_n(open.begin() + volume.grid.index(start), length, true);

  for (const auto& runs : runs_of) {
    if (runs.empty()) continue;
    std::map<std::int64_t, Label> around;  // labels of the voxels around the speck, by voxel index
    for (const auto& [start, length] : runs)
      for (int x = start.x - 1; x <= start.x + length; ++x)
        for (int j = -1; j <= 1; ++j)
          for (int k = -1; k <= 1; ++k) {
            const glm::ivec3 v(x, start.y + j, start.z + k);
            if (volume.grid.contains(v) && !open[volume.grid.index(v)]) around[volume.grid.index(v)] = volume.at(v);
          }
    std::map<Label, std::int64_t> votes;
    for (const auto& [index, label] : around) ++votes[label];
    Label most = 0;
    std::int64_t count = 0;
    for (const auto& [label, number] : votes)
      if (number > count) most = label, count = number;
    for (const auto& [start, length] : runs)
      std::fill_n(result.voxels.begin() + volume.grid.index(start), length, most);
  }
  return result;
}

std::vector<LabelStatistics> label_statistics(const LabelVolume& volume) {
  const Components components = connected_components(volume);
  const glm::ivec3 size = volume.grid.size;
  struct Sums {
    std::int64_t voxels = 0, components = 0;
    glm::dvec3 position{0};  // sum of voxel coordinates, in voxels; exact, since all addends are whole or half numbers
    glm::ivec3 low{INT32_MAX}, high{-1};
  };
  std::vector<Sums> sums(65536);
  std::vector<bool> seen(components.voxels.size(), false);
  for (std::int64_t row = 0; row + 1 < std::ssize(components.first_run); ++row)
    for (std::int64_t i = components.first_run[row]; i < components.first_run[row + 1]; ++i) {
      const Components::Run& run = components.runs[i];
      const glm::ivec3 first(run.begin, row % size.y, row / size.y);
      const int length = run.end - run.begin;
      Sums& sum = sums[run.label];
      sum.voxels += length;
      sum.position += static_cast<double>(length) * glm::dvec3(0.5 * (run.begin + run.end - 1), first.y, first.z);
      sum.low = glm::min(sum.low, first);
      sum.high = glm::max(sum.high, glm::ivec3(run.end - 1, first.y, first.z));
      if (!seen[run.component]) ++sum.components, seen[run.component] = true;
    }

  std::vector<std::atomic<std::int64_t>> surface(65536);
  parallel_for(std::int64_t{size.y} * size.z, 256, [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t row = begin; row < end; ++row)
      for (std::int64_t i = components.first_run[row]; i < components.first_run[row + 1]; ++i) {
        const Components::Run& run = components.runs[i];
        const int y = static_cast<int>(row % size.y), z = static_cast<int>(row / size.y);
        std::int64_t count = 0;
        for (int x = run.begin; x < run.end; ++x) {
          bool differs = x == run.begin || x + 1 == run.end;
          for (int step = -1; step <= 1 && !differs; step += 2)
            differs =
                volume.at_or_air({x, y + step, z}) != run.label || volume.at_or_air({x, y, z + step}) != run.label;
          count += differs;
        }
        surface[run.label].fetch_add(count, std::memory_order_relaxed);
      }
  });

  std::vector<LabelStatistics> result;
  const auto world = world_from_voxel(volume.grid);
  for (int label = 1; label < 65536; ++label) {
    const Sums& sum = sums[label];
    if (sum.voxels == 0) continue;
    const double count = static_cast<double>(sum.voxels);
    result.push_back({.label = static_cast<Label>(label),
                      .voxels = sum.voxels,
                      .volume_mm3 = count * volume.grid.voxel_volume(),
                      .centre = world * (sum.position / count),
                      .lowest = sum.low,
                      .highest = sum.high,
                      .components = static_cast<int>(sum.components),
                      .surface_voxels = surface[label]});
  }
  return result;
}

std::string to_csv(const std::vector<LabelStatistics>& statistics, const TissueTable& tissues) {
  std::ostringstream csv;
  csv.precision(10);
  csv << "label,name,voxels,mm3,mass_g,centre_x,centre_y,centre_z,low_x,low_y,low_z,high_x,high_y,high_z,components,"
         "surface_voxels\n";
  for (const LabelStatistics& s : statistics) {
    const Tissue* tissue = tissues.find(s.label);
    std::string name = tissue ? tissue->name : "";
    // Doubles each quotation mark in the name, which CSV requires inside quoted fields [RFC 4180].
    for (std::size_t i = 0; i < name.size(); ++i)
      if (name[i] == '"') name.insert(i++, 1, '"');
    csv << (tissue ? tissue->file_value : s.label) << ",\"" << name << "\"," << s.voxels << ',' << s.volume_mm3 << ','
        << s.volume_mm3 * (tissue ? tissue->density : 1.0) / 1000 << ',' << s.centre.x << ',' << s.centre.y << ','
        << s.centre.z << ',' << s.lowest.x << ',' << s.lowest.y << ',' << s.lowest.z << ',' << s.highest.x << ','
        << s.highest.y << ',' << s.highest.z << ',' << s.components << ',' << s.surface_voxels << '\n';
  }
  return csv.str();
}

}  // namespace limber
