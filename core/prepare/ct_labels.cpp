// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/prepare/ct_labels.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "core/base/error.h"
#include "core/base/parallel.h"
#include "core/volume/connected_components.h"
#include "core/volume/distance_transform.h"
#include "core/volume/outside_air.h"

namespace limber {

namespace {

enum : Label { kAir = 0, kSkin, kFat, kSoft, kLung, kGas, kBone };

constexpr double kThin = 3;            // half of the smallest thickness of a body, mm; thinner things are removed
constexpr double kSmallestBody = 1e4;  // volume of the smallest body, mm3; smaller components are removed
// Smallest part of a body, as a share of the largest part; smaller parts are removed.
constexpr double kLeastShare = 0.02;
// Volume of the smallest bone, mm3; smaller specks are noise and get no bone label.
constexpr double kSmallestBone = 150;
// Largest cavity in bone that may contain marrow, mm3. Larger cavities, such as the inside of a closed skull, get no
// bone label.
constexpr double kLargestMarrow = 1.5e5;
constexpr double kSmallestLung = 5e4;  // volume of the smallest lung, mm3; smaller regions are not labelled as lung
constexpr double kPureAir = -950;      // Hounsfield units; lungs are denser than this, gas in the bowel is not

using Mask = std::vector<std::uint8_t>;

// Calls body(index) for each voxel, on several threads.
template <class Body>
void for_each_voxel(const Grid& grid, const Body& body) {
  parallel_for(std::int64_t{grid.size.y} * grid.size.z, 64, [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t i = begin * grid.size.x; i < end * grid.size.x; ++i) body(static_cast<std::size_t>(i));
  });
}

VoxelBox whole(const Grid& grid) { return {glm::ivec3(0), grid.size}; }

LabelVolume volume_of(const Grid& grid, const Mask& mask) {
  LabelVolume volume;
  volume.grid = grid;
  volume.voxels.resize(mask.size());
  for_each_voxel(grid, [&](std::size_t i) {
    if (mask[i]) volume.voxels[i] = 1;
  });
  return volume;
}

// Calls keep(voxels, sum) for each connected component of the mask, with its number of voxels and the sum of `value`
// over them. Removes the components for which keep() returns false.
template <class Value, class Keep>
void filter_components(const Grid& grid, Mask& mask, const Value& value, const Keep& keep) {
  const Components components = connected_components(volume_of(grid, mask));
  std::vector<double> sums(components.voxels.size());
  std::vector<bool> kept(components.voxels.size());
  const auto for_each_run = [&](const auto& act) {
    for (std::size_t row = 0; row + 1 < components.first_run.size(); ++row)
      for (std::int64_t r = components.first_run[row]; r < components.first_run[row + 1]; ++r) {
        const Components::Run& run = components.runs[static_cast<std::size_t>(r)];
        act(static_cast<std::size_t>(run.component), row * static_cast<std::size_t>(grid.size.x), run);
      }
  };
  for_each_run([&](std::size_t component, std::size_t row, const Components::Run& run) {
    for (std::int32_t x = run.begin; x < run.end; ++x) sums[component] += value(row + static_cast<std::size_t>(x));
  });
  for (std::size_t c = 0; c < kept.size(); ++c) kept[c] = keep(double(components.voxels[c]), sums[c]);
  for_each_run([&](std::size_t component, std::size_t row, const Components::Run& run) {
    if (kept[component]) return;
    std::fill(mask.begin() + std::ptrdiff_t(row) + run.begin, mask.begin() + std::ptrdiff_t(row) + run.end, 0);
  });
}
double no_value(std::size_t) { return 0; }

bool is_empty(const Mask& mask) {
  return std::none_of(mask.begin(), mask.end(), [](std::uint8_t is) { return is != 0; });
}

// Returns the voxels of the body: those above the body's threshold that lie in or near a thick region. A morphological
// opening by 3 mm removes the table, blankets and cables. The remaining body is then grown by a little more than 3 mm
// within the voxels above the threshold, so that ears and fingers stay.
Mask body_of(const GreyLevels& image, double threshold, Progress& progress) {
  const Grid& grid = image.grid;
  const double coarsest = std::max({grid.spacing.x, grid.spacing.y, grid.spacing.z});
  Mask dense(image.levels.size()), outside(dense.size());
  for_each_voxel(grid, [&](std::size_t i) {
    dense[i] = image.value_of(image.levels[i]) >= threshold;
    outside[i] = !dense[i];
  });
  Mask thick = dense;
  if (std::any_of(outside.begin(), outside.end(), [](std::uint8_t is) { return is != 0; })) {
    const std::vector<float> depth = squared_distance(whole(grid), outside, grid.spacing, progress);
    // Distances are measured between voxel centres, and the surface of the air is half a voxel nearer, so half a voxel
    // is added.
    const double least = kThin + 0.5 * std::cbrt(grid.voxel_volume());
    for_each_voxel(grid, [&](std::size_t i) { thick[i] = double(depth[i]) > least * least; });
  }
  const double voxel = grid.voxel_volume();
  double largest = 0;
  filter_components(grid, thick, no_value, [&](double voxels, double) {
    largest = std::max(largest, voxels);
    return true;
  });
  filter_components(grid, thick, no_value, [&](double voxels, double) {
    return voxels * voxel >= kSmallestBody / 4 && voxels >= kLeastShare * largest;
  });
  if (is_empty(thick)) return {};
  const std::vector<float> reach = squared_distance(whole(grid), thick, grid.spacing, progress);
  const double most = kThin + 1.5 * std::max(1.0, coarsest) + 1;
  for_each_voxel(grid, [&](std::size_t i) { dense[i] = dense[i] && double(reach[i]) <= most * most; });
  filter_components(grid, dense, no_value, [&](double voxels, double) { return voxels * voxel >= kSmallestBody; });
  return dense;
}

// Returns the mean value of a voxel and its six face neighbours.
double smoothed(const GreyLevels& image, std::size_t i) {
  const glm::ivec3& size = image.grid.size;
  const auto at = static_cast<std::int64_t>(i);
  const glm::ivec3 v(at % size.x, at / size.x % size.y, at / size.x / size.y);
  const std::array<std::int64_t, 3> strides{1, size.x, std::int64_t{size.x} * size.y};
  double sum = image.levels[i];
  int count = 1;
  for (int axis = 0; axis < 3; ++axis) {
    if (v[axis] > 0) sum += image.levels[static_cast<std::size_t>(at - strides[axis])], ++count;
    if (v[axis] + 1 < size[axis]) sum += image.levels[static_cast<std::size_t>(at + strides[axis])], ++count;
  }
  return image.least + image.step * sum / count;
}

// Marks air that the body encloses within a slice across the body's longest axis. Lungs are enclosed in this way even
// if the windpipe is open to the outside.
Mask enclosed_in_slices(const LabelVolume& body) {
  const Grid& grid = body.grid;
  // Finds the axis of the grid that is most nearly parallel to the direction from feet to head.
  int up = 0;
  for (int axis = 1; axis < 3; ++axis)
    if (std::abs(grid.direction[axis].z) > std::abs(grid.direction[up].z)) up = axis;
  const int u = (up + 1) % 3, v = (up + 2) % 3;
  Mask enclosed(body.voxels.size());
  parallel_for(grid.size[up], 1, [&](std::int64_t begin, std::int64_t end) {
    std::vector<std::uint8_t> reached;
    std::vector<glm::ivec2> open;
    for (std::int64_t slice = begin; slice < end; ++slice) {
      const glm::ivec2 size(grid.size[u], grid.size[v]);
      const auto voxel = [&](const glm::ivec2& p) {
        glm::ivec3 at(0);
        at[up] = static_cast<int>(slice);
        at[u] = p.x;
        at[v] = p.y;
        return static_cast<std::size_t>(grid.index(at));
      };
      reached.assign(static_cast<std::size_t>(size.x) * size.y, 0);
      const auto reach = [&](const glm::ivec2& p) {
        if (p.x < 0 || p.y < 0 || p.x >= size.x || p.y >= size.y) return;
        std::uint8_t& is = reached[static_cast<std::size_t>(p.x + size.x * p.y)];
        if (is || body.voxels[voxel(p)]) return;
        is = 1;
        open.push_back(p);
      };
      for (int x = 0; x < size.x; ++x) reach({x, 0}), reach({x, size.y - 1});
      for (int y = 0; y < size.y; ++y) reach({0, y}), reach({size.x - 1, y});
      while (!open.empty()) {
        const glm::ivec2 p = open.back();
        open.pop_back();
        for (const glm::ivec2& step : {glm::ivec2(1, 0), glm::ivec2(-1, 0), glm::ivec2(0, 1), glm::ivec2(0, -1)})
          reach(p + step);
      }
      for (int y = 0; y < size.y; ++y)
        for (int x = 0; x < size.x; ++x)
          if (!reached[static_cast<std::size_t>(x + size.x * y)] && !body.voxels[voxel({x, y})])
            enclosed[voxel({x, y})] = 1;
    }
  });
  return enclosed;
}

// Labels the air inside the body: as lung if much of it is denser than air, as gas if the body encloses it on all
// sides.
void label_air(const GreyLevels& image, LabelVolume& volume) {
  const Grid& grid = image.grid;
  const Mask outside = outside_air(volume);
  Mask lung = enclosed_in_slices(volume);
  for_each_voxel(grid, [&](std::size_t i) {
    const bool inside = lung[i] || (!outside[i] && !volume.voxels[i]);
    if (inside && !outside[i]) volume.voxels[i] = kGas;
    lung[i] = inside && image.value_of(image.levels[i]) >= kPureAir;
  });
  filter_components(grid, lung, no_value,
                    [&](double voxels, double) { return voxels * grid.voxel_volume() >= kSmallestLung; });
  for_each_voxel(grid, [&](std::size_t i) {
    if (lung[i]) volume.voxels[i] = kLung;
  });
}

void label_bone(const GreyLevels& image, const CtThresholds& thresholds, LabelVolume& volume) {
  const Grid& grid = image.grid;
  const double voxel = grid.voxel_volume();
  Mask bone(volume.voxels.size());
  for_each_voxel(grid, [&](std::size_t i) { bone[i] = volume.voxels[i] && smoothed(image, i) >= thresholds.bone; });
  filter_components(grid, bone, no_value, [&](double voxels, double) { return voxels * voxel >= kSmallestBone; });
  const Mask outside = outside_air(volume_of(grid, bone));
  Mask marrow(bone.size());
  for_each_voxel(grid, [&](std::size_t i) { marrow[i] = !bone[i] && !outside[i] && volume.voxels[i]; });
  filter_components(grid, marrow, no_value, [&](double voxels, double) { return voxels * voxel <= kLargestMarrow; });
  for_each_voxel(grid, [&](std::size_t i) {
    if (bone[i] || marrow[i]) volume.voxels[i] = kBone;
  });
}

void label_skin(double thickness, LabelVolume& volume, Progress& progress) {
  const Grid& grid = volume.grid;
  const Mask outside = outside_air(volume);
  const std::vector<float> depth = squared_distance(whole(grid), outside, grid.spacing, progress);
  const double coarsest = std::max({grid.spacing.x, grid.spacing.y, grid.spacing.z});
  // Distances are measured between voxel centres, so the outermost layer of voxels has a depth of one spacing. Skin
  // includes at least this layer.
  const double most = std::max(thickness, coarsest) * (1 + 1e-6);
  for_each_voxel(grid, [&](std::size_t i) {
    Label& label = volume.voxels[i];
    if ((label == kFat || label == kSoft) && double(depth[i]) <= most * most) label = kSkin;
  });
}

TissueTable table_for(const LabelVolume& volume, const char* source) {
  struct Entry {
    Label label;
    const char* name;
    TissueKind kind;
  };
  constexpr Entry kEntries[] = {{kSkin, "Skin", TissueKind::Skin},          {kFat, "Fat", TissueKind::Fat},
                                {kSoft, "Soft tissue", TissueKind::Muscle}, {kLung, "Lung", TissueKind::Organ},
                                {kGas, "Gas", TissueKind::Cavity},          {kBone, "Bone", TissueKind::Bone}};
  std::array<bool, kBone + 1> present{};
  for (const Label label : volume.voxels) present[label] = true;
  TissueTable table;
  table.source = source;
  for (const Entry& entry : kEntries) {
    if (!present[entry.label]) continue;
    Tissue tissue;
    tissue.label = entry.label;
    tissue.file_value = entry.label;
    tissue.name = entry.name;
    tissue.kind = entry.kind;
    apply_kind_defaults(tissue);
    table.tissues.push_back(std::move(tissue));
  }
  return table;
}

void check(const CtThresholds& t) {
  if (t.body < t.fat && t.fat < t.soft && t.soft < t.bone && t.skin_mm >= 0) return;
  char text[160];
  std::snprintf(text, sizeof text, "body %g, fat %g, soft tissue %g, bone %g", t.body, t.fat, t.soft, t.bone);
  throw Error("the thresholds of a CT must ascend: body, fat, soft tissue, bone", text,
              "the usual thresholds are -300, -190, -30 and 200");
}

}  // namespace

CtLabels labels_of_ct(const GreyLevels& image, const CtThresholds& thresholds, Progress& progress) {
  check(thresholds);
  if (image.least >= thresholds.body) {
    char text[80];
    std::snprintf(text, sizeof text, "its smallest value is %g", image.least);
    throw Error("this is not a CT: it has no air", text, "give a CT in Hounsfield units, where air is -1000");
  }
  progress.update("body", 0);
  const Mask body = body_of(image, thresholds.body, progress);
  if (is_empty(body)) {
    char text[80];
    std::snprintf(text, sizeof text, "values from %.0f to %.0f", image.least, image.most());
    throw Error("no body was found in this image", text,
                "give a CT in Hounsfield units; if this is a CT, lower the threshold of the body");
  }
  CtLabels labels;
  LabelVolume& volume = labels.volume;
  volume.grid = image.grid;
  volume.voxels.resize(body.size());
  for_each_voxel(image.grid, [&](std::size_t i) {
    if (!body[i]) return;
    const double value = smoothed(image, i);
    volume.voxels[i] = value >= thresholds.fat && value < thresholds.soft ? kFat : kSoft;
  });
  progress.update("air inside the body", 0.4);
  label_air(image, volume);
  progress.update("bone", 0.6);
  label_bone(image, thresholds, volume);
  progress.update("skin", 0.8);
  label_skin(thresholds.skin_mm, volume, progress);
  labels.tissues = table_for(volume, "thresholds of the CT");
  progress.update("skin", 1);
  return labels;
}

double body_threshold(const GreyLevels& image) {
  std::vector<std::int64_t> counts(65536);
  for (const std::uint16_t level : image.levels) ++counts[level];
  // Levels are counted from 1, since cross entropy takes the logarithm of their means, which must be positive.
  std::vector<double> voxels(65537), sums(65537);
  for (std::size_t level = 0; level < 65536; ++level) {
    voxels[level + 1] = voxels[level] + double(counts[level]);
    sums[level + 1] = sums[level] + double(counts[level]) * double(level + 1);
  }
  if (voxels.back() == 0) return image.least;
  double threshold = sums.back() / voxels.back();  // start value of the fixed-point iteration: the mean of all values
  for (int round = 0; round < 1000; ++round) {
    const auto cut = static_cast<std::size_t>(std::clamp(std::ceil(threshold) - 1, 1.0, 65535.0));
    const double below = voxels[cut], above = voxels.back() - below;
    if (below == 0 || above == 0) break;
    const double dark = sums[cut] / below, bright = (sums.back() - sums[cut]) / above;
    const double next = (bright - dark) / (std::log(bright) - std::log(dark));
    if (std::abs(next - threshold) < 0.5) break;
    threshold = next;
  }
  return image.least + image.step * (threshold - 1);
}

CtLabels labels_of_body(const GreyLevels& image, double threshold, double skin_mm, Progress& progress) {
  char range[80];
  std::snprintf(range, sizeof range, "values from %g to %g", image.least, image.most());
  if (!(skin_mm >= 0)) throw Error("the thickness of the skin is negative", "labels of the body", "give 0 mm or more");
  if (image.least >= threshold)
    throw Error("no value is below the threshold of the body", range, "raise the threshold");
  progress.update("body", 0);
  const Mask body = body_of(image, threshold, progress);
  if (is_empty(body)) throw Error("no body was found above the threshold", range, "lower the threshold of the body");
  CtLabels labels;
  LabelVolume& volume = labels.volume;
  volume.grid = image.grid;
  volume.voxels.resize(body.size());
  for_each_voxel(image.grid, [&](std::size_t i) { volume.voxels[i] = body[i] ? kSoft : kAir; });
  progress.update("dark regions inside the body", 0.5);
  const Mask enclosed = enclosed_in_slices(volume), outside = outside_air(volume);
  for_each_voxel(image.grid, [&](std::size_t i) {
    if (enclosed[i] || !outside[i]) volume.voxels[i] = kSoft;
  });
  progress.update("skin", 0.8);
  label_skin(skin_mm, volume, progress);
  labels.tissues = table_for(volume, "a threshold of the image");
  progress.update("skin", 1);
  return labels;
}

}  // namespace limber
