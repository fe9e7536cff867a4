// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/volume/distance.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <mutex>

#include "core/base/parallel.h"

namespace limber {

namespace {
constexpr float kInfinity = std::numeric_limits<float>::infinity();
// Lines along y or z are gathered this many at a time, so that memory is read in whole cache lines.
constexpr int kLines = 16;

// Along x the seeds are a mask: two sweeps count steps.
void distance_along_x(const std::uint8_t* seed, float* squared, int count, double step) {
  const int far = std::numeric_limits<int>::max();
  int steps = far;
  for (int x = 0; x < count; ++x) {
    steps = seed[x] ? 0 : steps == far ? far : steps + 1;
    squared[x] = steps == far ? kInfinity : static_cast<float>(steps * step * (steps * step));
  }
  steps = far;
  for (int x = count - 1; x >= 0; --x) {
    steps = seed[x] ? 0 : steps == far ? far : steps + 1;
    if (steps != far) squared[x] = std::min(squared[x], static_cast<float>(steps * step * (steps * step)));
  }
}

// Scratch of one line's lower envelope.
struct Envelope {
  std::vector<int> vertex;     // parabolas of the envelope, by rising place
  std::vector<double> border;  // where parabola k takes over from k - 1

  explicit Envelope(int count) : vertex(count), border(count + 1) {}

  // line[i] becomes min over j of line[j] + (step (i - j))^2
  void lower(float* line, float* out, int count, double step) {
    const double squared_step = step * step;
    int top = -1;
    for (int j = 0; j < count; ++j) {
      if (line[j] == kInfinity) continue;
      double takes_over = -std::numeric_limits<double>::infinity();
      while (top >= 0) {
        const int i = vertex[top];
        takes_over = 0.5 * (i + j) + (double{line[j]} - line[i]) / (2 * squared_step * (j - i));
        if (takes_over > border[top]) break;
        --top;
      }
      if (top < 0) takes_over = -std::numeric_limits<double>::infinity();
      vertex[++top] = j;
      border[top] = takes_over;
    }
    if (top < 0) {
      std::fill_n(out, count, kInfinity);
      return;
    }
    for (int i = 0, k = 0; i < count; ++i) {
      while (k < top && border[k + 1] < i) ++k;
      const double away = step * (i - vertex[k]);
      out[i] = static_cast<float>(line[vertex[k]] + away * away);
    }
  }
};

// All lines of `count` voxels, `stride` apart, that start at the `width` neighbouring voxels from `first`.
void distance_along(float* first, int width, std::int64_t stride, int count, double step, Envelope& envelope,
                    std::vector<float>& gathered, std::vector<float>& out) {
  for (int begin = 0; begin < width; begin += kLines) {
    const int lines = std::min(kLines, width - begin);
    bool any = false;
    for (int i = 0; i < count; ++i)
      for (int l = 0; l < lines; ++l) {
        const float value = first[begin + l + i * stride];
        gathered[std::int64_t{l} * count + i] = value;
        any |= value != 0 && value != kInfinity;
      }
    // All zero, or all infinite or zero with nothing between: only lines with both need the envelope.
    for (int l = 0; l < lines; ++l) {
      float* line = &gathered[std::int64_t{l} * count];
      const bool uniform = !any && std::all_of(line, line + count, [&](float v) { return v == line[0]; });
      if (uniform)
        std::copy_n(line, count, &out[std::int64_t{l} * count]);
      else
        envelope.lower(line, &out[std::int64_t{l} * count], count, step);
    }
    for (int i = 0; i < count; ++i)
      for (int l = 0; l < lines; ++l) first[begin + l + i * stride] = out[std::int64_t{l} * count + i];
  }
}
}  // namespace

VoxelBox tissue_box(const LabelVolume& volume, int margin) {
  const glm::ivec3 size = volume.grid.size;
  glm::ivec3 low = size, high(-1);
  for (int z = 0; z < size.z; ++z)
    for (int y = 0; y < size.y; ++y) {
      const Label* row = volume.voxels.data() + volume.grid.index({0, y, z});
      int first = 0, last = size.x - 1;
      while (first < size.x && !row[first]) ++first;
      if (first == size.x) continue;
      while (!row[last]) --last;
      low = glm::min(low, glm::ivec3(first, y, z));
      high = glm::max(high, glm::ivec3(last, y, z));
    }
  if (high.x < 0) return {};
  low = glm::max(low - margin, glm::ivec3(0));
  high = glm::min(high + margin, size - 1);
  return {low, high - low + 1};
}

std::vector<float> squared_distance(const VoxelBox& box, const std::vector<std::uint8_t>& seed,
                                    const glm::dvec3& spacing, Progress& progress) {
  const auto [nx, ny, nz] = std::array{box.size.x, box.size.y, box.size.z};
  const std::int64_t slice = std::int64_t{nx} * ny;
  std::vector<float> squared(box.voxel_count());
  if (squared.empty()) return squared;

  // Along x and y: slice by slice.
  parallel_for(nz, 1, [&](std::int64_t begin, std::int64_t end) {
    Envelope envelope(ny);
    std::vector<float> gathered(std::int64_t{kLines} * ny), out(gathered.size());
    for (std::int64_t z = begin; z < end && !progress.cancelled(); ++z) {
      for (int y = 0; y < ny; ++y)
        distance_along_x(&seed[z * slice + std::int64_t{y} * nx], &squared[z * slice + std::int64_t{y} * nx], nx, spacing.x);
      distance_along(&squared[z * slice], nx, nx, ny, spacing.y, envelope, gathered, out);
    }
  });
  progress.update("distances", 0.6);

  // Along z: row by row.
  parallel_for(ny, 1, [&](std::int64_t begin, std::int64_t end) {
    Envelope envelope(nz);
    std::vector<float> gathered(std::int64_t{kLines} * nz), out(gathered.size());
    for (std::int64_t y = begin; y < end && !progress.cancelled(); ++y)
      distance_along(&squared[y * nx], nx, slice, nz, spacing.z, envelope, gathered, out);
  });
  progress.update("distances", 1);
  return squared;
}

std::vector<float> signed_distance(const VoxelBox& box, const std::vector<std::uint8_t>& body,
                                   const glm::dvec3& spacing, Progress& progress) {
  std::vector<float> distance = squared_distance(box, body, spacing, progress);
  std::vector<std::uint8_t> outside(body.size());
  for (size_t i = 0; i < body.size(); ++i) outside[i] = !body[i];
  const std::vector<float> inward = squared_distance(box, outside, spacing, progress);
  for (size_t i = 0; i < distance.size(); ++i) distance[i] = body[i] ? -std::sqrt(inward[i]) : std::sqrt(distance[i]);
  return distance;
}

}  // namespace limber
